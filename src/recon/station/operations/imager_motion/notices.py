"""What an operator must know of a motion: alarms while it lasts and where it stopped, the audit."""

from collections.abc import Callable, Iterator, Mapping

from recon.geo.distance import horizontal_distance_m
from recon.model.command import Refusal
from recon.model.control import AuthorityHolder
from recon.model.event import Event
from recon.record.audit.audit import AuditEntry
from recon.station.operations.motion_orders import newest_motion
from recon.station.state.alarm_book import Condition, Severity
from recon.station.state.imager_motion import AnyMotion, MotionStage, MotionT
from recon.station.state.station import Station

OFF_PLACE_M = 5.0
"""Distance from its place below which a vehicle need not move: telemetry positions frames."""


def about(
    station: Station, motion: AnyMotion, severity: Severity, key: str, text: str
) -> Condition:
    """Return a condition of a motion's vehicle."""
    vehicle = station.fleet.vehicles.get(motion.serial)
    link_id = None if vehicle is None else vehicle.link_id
    name, rule = motion.name, motion.rule
    key, text = f"{rule}:{key}", f"{name}: {text}"
    return Condition(key, severity, rule, name, text, motion.serial, link_id)


def automatic_motion(station: Station, motion: AnyMotion | None, text: str) -> Iterator[Condition]:
    """A motion without an order of now: under way for a survey."""
    if motion is not None and not motion.is_over and motion.survey_id is not None:
        yield about(station, motion, Severity.INFO, "motion", text)


def cannot_begin(
    station: Station, kind: type[AnyMotion], serial: str, what: str
) -> Iterator[Condition]:
    """A motion that would begin automatically, and is refused."""
    refused = station.imager_motions.start(kind).refused
    if refused is not None:
        rule, text = kind.rule, f"{what}: {refused}"
        yield Condition(f"{rule}:refused", Severity.WARNING, rule, serial, text, serial)


def off_its_place(
    station: Station, motion: AnyMotion | None, what_to_do: str
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


def is_left(station: Station, motion: AnyMotion) -> bool:
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


def audit_of(
    kind: type[MotionT],
    described: Callable[[MotionT], tuple[str, Mapping[str, float]]],
    refused: Callable[[Station, Event, int], AuditEntry | None] = lambda *_step: None,
) -> Callable[[Station, Event, Station, int], Iterator[AuditEntry]]:
    """Return the audit of a kind: an entry for a refused command, and for each change of stage.

    `described` states which motion it is, in words and in figures.
    """

    def entries(before: Station, event: Event, after: Station, now_ns: int) -> Iterator[AuditEntry]:
        entry = refused(before, event, now_ns)
        if entry is not None:
            yield entry
        old, new = before.imager_motions.of(kind), after.imager_motions.of(kind)
        if new is not None and (
            old is None or (old.stage, old.since_ns) != (new.stage, new.since_ns)
        ):
            yield _stage_entry(new, *described(new))

    return entries


def refused_entry(
    kind: type[AnyMotion], why: Refusal, by: str, serial: str | None, **details: str
) -> AuditEntry:
    """Return the entry for a refused command."""
    told = {"rule": why.rule, "reason": why.reason, **details}
    text = f"{kind.words} refused: {why.reason}"
    return AuditEntry(f"{kind.rule}.refused", text, by, serial, details=told)


def _stage_entry(motion: AnyMotion, text: str, details: Mapping[str, float]) -> AuditEntry:
    stage, reason = motion.stage.value, f": {motion.reason}" if motion.reason else ""
    return AuditEntry(
        f"{motion.rule}.{stage}",
        f"{text}: {stage}{reason}",
        motion.by,
        motion.serial,
        motion.name,
        details={"stage": stage, **details, "order": motion.command_id},
    )
