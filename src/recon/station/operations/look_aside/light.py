"""Since when the light is mostly unknown, from each new shade map."""

from dataclasses import replace

from recon.guidance.look_aside import LOOK_ASIDE_SETTINGS, is_mostly_unknown
from recon.model.shade import ShadeMap
from recon.station.state.station import Station


def on_shade(station: Station, shade: ShadeMap) -> Station:
    """Return the station that knows since when its shade maps are mostly unknown."""
    asides, seen = station.look_asides, station.shade.seen
    since_ns: int | None = None
    if seen is not None and is_mostly_unknown(shade.valid, seen, LOOK_ASIDE_SETTINGS):
        before_ns = asides.unknown_since_ns
        since_ns = shade.captured_at_ns if before_ns is None else before_ns
    if since_ns == asides.unknown_since_ns:
        return station
    return replace(station, look_asides=replace(asides, unknown_since_ns=since_ns))
