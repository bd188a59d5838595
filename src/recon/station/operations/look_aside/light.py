"""Since when light is mostly unknown below each imaging drone, from each new shade map."""

from dataclasses import replace

from recon.guidance.look_aside import LOOK_ASIDE_SETTINGS, is_mostly_unknown
from recon.model.shade import ShadeMap
from recon.station.state.station import Station


def on_shade(station: Station, _shade: ShadeMap) -> Station:
    """Return the station that knows since when light is mostly unknown below each."""
    asides = station.look_asides
    since_ns = {
        serial: asides.unknown_since_ns.get(serial, own.shade.captured_at_ns)
        for serial, own in station.shade.own.items()
        if is_mostly_unknown(own.shade.valid, own.seen, LOOK_ASIDE_SETTINGS)
    }
    if since_ns == asides.unknown_since_ns:
        return station
    return replace(station, look_asides=replace(asides, unknown_since_ns=since_ns))
