"""The alarms of a look aside: under way, stopped beside its place, or not possible by itself."""

from collections.abc import Iterator

from recon.guidance.look_aside import LOOK_ASIDE_SETTINGS
from recon.station.operations.imager_motion.notices import (
    about,
    by_itself,
    cannot_begin,
    off_its_place,
)
from recon.station.operations.look_aside.commands import meant
from recon.station.state.alarm_book import Condition, Severity
from recon.station.state.imager_motion import LookAside, MotionStage
from recon.station.state.station import Station


def conditions(station: Station) -> Iterator[Condition]:
    """Yield what an operator must know: a motion without an order of now, and where it ended."""
    asides = station.look_asides
    newest, distance_m = asides.newest, LOOK_ASIDE_SETTINGS.distance_m
    text = f"looks aside for its survey: {distance_m:g} m and back, light is unknown"
    yield from by_itself(station, newest, text)
    if newest is not None and newest.stage is MotionStage.WAITING:
        text = f"waits beside its place, its way back is refused: {newest.reason}"
        yield about(station, newest, Severity.WARNING, "waits", text)
    yield from off_its_place(station, newest, "Send it back to where it shows the field")
    text = "light is unknown, and the imaging drone cannot look aside"
    yield from cannot_begin(LookAside.rule, asides.refused, meant(station) or "", text)
