"""What an operator must know of a motion: alarms while it lasts and where it stopped, the audit."""

from collections.abc import Iterator, Mapping

from recon.geo.distance import horizontal_distance_m
from recon.model.control import AuthorityHolder
from recon.record.audit.audit import AuditEntry
from recon.station.operations.fleet_return.progress import newest_motion
from recon.station.state.alarm_book import Condition, Severity
from recon.station.state.imager_motion import ImagerMotion, MotionStage
from recon.station.state.station import Station

OFF_PLACE_M = 5.0
"""Nearer to its place a vehicle needs not be sent there: frames are positioned by telemetry."""


def about(
    station: Station, motion: ImagerMotion, severity: Severity, key: str, text: str
) -> Condition:
    """Return a condition of a motion's vehicle."""
    vehicle = station.fleet.vehicles.get(motion.serial)
    link_id = None if vehicle is None else vehicle.link_id
    name, rule = motion.name, motion.rule
    key, text = f"{rule}:{key}", f"{name}: {text}"
    return Condition(key, severity, rule, name, text, motion.serial, link_id)


def by_itself(station: Station, motion: ImagerMotion | None, text: str) -> Iterator[Condition]:
    """A motion without an order of now: under way for a survey."""
    if motion is not None and not motion.is_over and motion.survey_id is not None:
        yield about(station, motion, Severity.INFO, "motion", text)


def cannot_begin(rule: str, refused: str | None, serial: str, what: str) -> Iterator[Condition]:
    """A motion that would begin by itself, and is refused."""
    if refused is not None:
        text = f"{what}: {refused}"
        yield Condition(f"{rule}:refused", Severity.WARNING, rule, serial, text, serial)


def off_its_place(
    station: Station, motion: ImagerMotion | None, what_to_do: str
) -> Iterator[Condition]:
    """A vehicle that stopped away from its place, until it is commanded elsewhere."""
    if motion is None or not is_left(station, motion):
        return
    place = station.fleet.vehicles[motion.serial].position.value
    if place is None:
        return
    off_m = horizontal_distance_m(place, motion.place)
    if off_m >= OFF_PLACE_M:
        text = f"its {motion.words} stopped {off_m:.0f} m from its place: {motion.reason}. "
        yield about(station, motion, Severity.WARNING, "stopped", text + what_to_do)


def is_left(station: Station, motion: ImagerMotion) -> bool:
    """Return whether a motion's vehicle still hovers where it stopped, commanded nowhere since."""
    vehicle = station.fleet.vehicles.get(motion.serial)
    if motion.stage is not MotionStage.STOPPED or vehicle is None:
        return False
    if vehicle.is_flying.value is False:
        return False
    if station.control(motion.serial).authority.holder is AuthorityHolder.PILOT:
        return False
    newest = newest_motion(station, motion.serial)
    return newest is None or not newest.command.moves or newest.command.id == motion.command_id


def stage_entries(
    before: ImagerMotion | None, after: ImagerMotion | None, text: str, details: Mapping[str, float]
) -> Iterator[AuditEntry]:
    """Yield the entry of the audit for a change of stage; `text` states which motion it is."""
    if after is None or (
        before is not None and (before.stage, before.since_ns) == (after.stage, after.since_ns)
    ):
        return
    stage, reason = after.stage.value, f": {after.reason}" if after.reason else ""
    yield AuditEntry(
        f"{after.rule}.{stage}",
        f"{text}: {stage}{reason}",
        after.by,
        after.serial,
        after.name,
        details={"stage": stage, **details, "order": after.command_id},
    )
