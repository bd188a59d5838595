"""How long light has been mostly unknown below each imaging drone, from each new shade map."""

from dataclasses import replace

from recon.guidance.side_step import SIDE_STEP_SETTINGS, SideStepSettings, is_mostly_unknown
from recon.model.shade import ShadeMap
from recon.model.units import seconds_to_ns
from recon.station.state.station import Station


def on_shade(station: Station, _shade: ShadeMap) -> Station:
    """Return the station that knows since when light is mostly unknown below each."""
    motions = station.imager_motions
    since_ns = {
        serial: motions.unknown_since_ns.get(serial, own.shade.captured_at_ns)
        for serial, own in station.shade.own.items()
        if is_mostly_unknown(own.shade.valid, own.seen, SIDE_STEP_SETTINGS)
    }
    if since_ns == motions.unknown_since_ns:
        return station
    return replace(station, imager_motions=replace(motions, unknown_since_ns=since_ns))


def unknown_for_long(station: Station, now_ns: int, settings: SideStepSettings) -> str | None:
    """Return an imaging drone with a recent shade map, and light mostly unknown for long."""
    for serial, since_ns in station.imager_motions.unknown_since_ns.items():
        own = station.shade.own.get(serial)
        if own is None:
            continue  # a keyframe of a record holds no maps
        captured_at_ns = own.shade.captured_at_ns
        is_recent = now_ns - captured_at_ns <= seconds_to_ns(settings.map_within_s)
        if is_recent and captured_at_ns - since_ns >= seconds_to_ns(settings.unknown_for_s):
            return serial
    return None
