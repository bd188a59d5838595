"""The alarms of a look aside: under way, stopped beside its place, or not possible by itself."""

from collections.abc import Iterator

from recon.geo.distance import horizontal_distance_m
from recon.guidance.look_aside import LOOK_ASIDE_SETTINGS
from recon.model.control import AuthorityHolder
from recon.station.operations.fleet_return.progress import newest_motion
from recon.station.operations.look_aside.commands import meant
from recon.station.state.alarm_book import Condition, Severity
from recon.station.state.look_aside_record import LookAside, LookAsideStage
from recon.station.state.station import Station

RULE = "look_aside"
OFF_PLACE_M = 5.0
"""Nearer to its place a vehicle needs not be sent back: frames are positioned by telemetry."""


def conditions(station: Station) -> Iterator[Condition]:
    """Yield what an operator must know: a motion without an order of now, and where it ended."""
    asides = station.look_asides
    newest = asides.newest
    if newest is not None and not newest.is_over and newest.survey_id is not None:
        distance_m = LOOK_ASIDE_SETTINGS.distance_m
        text = f"looks aside for its survey: {distance_m:g} m and back, light is unknown"
        yield _about(station, newest, Severity.INFO, f"{RULE}:motion", text)
    if newest is not None and newest.stage is LookAsideStage.WAITING:
        text = f"waits beside its place, its way back is refused: {newest.reason}"
        yield _about(station, newest, Severity.WARNING, f"{RULE}:waits", text)
    if newest is not None and newest.stage is LookAsideStage.STOPPED:
        yield from _off_its_place(station, newest)
    if asides.refused is not None:
        serial = meant(station) or ""
        text = f"light is unknown, and the imaging drone cannot look aside: {asides.refused}"
        yield Condition(f"{RULE}:refused", Severity.WARNING, RULE, serial, text, serial)


def _off_its_place(station: Station, stopped: LookAside) -> Iterator[Condition]:
    """A vehicle that stopped away from its place, until it is commanded elsewhere."""
    vehicle = station.fleet.vehicles.get(stopped.serial)
    if vehicle is None or vehicle.is_flying.value is False or vehicle.position.value is None:
        return
    if station.control(stopped.serial).authority.holder is AuthorityHolder.PILOT:
        return
    newest = newest_motion(station, stopped.serial)
    if newest is not None and newest.command.moves and newest.command.id != stopped.command_id:
        return
    off_m = horizontal_distance_m(vehicle.position.value, stopped.place)
    if off_m >= OFF_PLACE_M:
        text = (
            f"its look aside stopped {off_m:.0f} m from its place: {stopped.reason}. Send it back "
            "to where it shows the field"
        )
        yield _about(station, stopped, Severity.WARNING, f"{RULE}:stopped", text)


def _about(
    station: Station, newest: LookAside, severity: Severity, key: str, text: str
) -> Condition:
    vehicle = station.fleet.vehicles.get(newest.serial)
    link_id = None if vehicle is None else vehicle.link_id
    name = newest.name
    return Condition(key, severity, RULE, name, f"{name}: {text}", newest.serial, link_id)
