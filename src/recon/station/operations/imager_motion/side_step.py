"""The side-step: an imaging drone flies 25 m aside and back, so that a flat scene is decided.

    aside --arrived--> back, or waiting while the gate refuses the leg back
    waiting --the gate approves--> back
    back --arrived--> done
    any of them --whatever ends a motion (`execution`)--> stopped

Each leg ends within a minute. A running survey that allows it has one begin automatically while
light is mostly unknown (`unknown_light`): for the person who started the survey, and refused for
the same reasons. At most once in five minutes; a refused one is tried again after a minute.
"""

from collections.abc import Iterator, Mapping
from dataclasses import replace

from recon.geo.sun import sun_position
from recon.guidance.side_step import (
    SIDE_STEP_SETTINGS,
    SideStepSettings,
    bearings_deg,
    place_aside,
)
from recon.model.command import GoTo, Refusal
from recon.model.event import Event, SideStepOrdered
from recon.model.geo import LatLon
from recon.model.units import ns_to_seconds, seconds_to_ns
from recon.record.audit.audit import AuditEntry
from recon.safety.rules.not_expired import given_refusal
from recon.station.imaging.at_work import imagers_at_work
from recon.station.operations.imager_motion import notices
from recon.station.operations.imager_motion.claim import Claimed, claimed
from recon.station.operations.imager_motion.execution import (
    after_automatic_begin,
    begin_with,
    done,
    follow,
    go_on,
    held,
    is_refused,
    not_refused,
    put,
    stopped,
    tried,
)
from recon.station.operations.imager_motion.unknown_light import on_shade, unknown_for_long
from recon.station.operations.operation import Operation
from recon.station.state.alarm_book import Condition, Severity
from recon.station.state.imager_motion import MotionStage, SideStep
from recon.station.state.station import Station
from recon.station.state.steps import Stepped, on

HOLD_ENDED = "the station could no longer hold it beside its place"


def order(station: Station, event: SideStepOrdered, now_ns: int) -> Stepped:
    """Begin a side-step, unless it is refused; then nothing changes."""
    begun = begin(station, event, now_ns)
    return (station, ()) if isinstance(begun, Refusal) else begun


def refusal(station: Station, event: SideStepOrdered, now_ns: int) -> Refusal | None:
    """Return why the imaging drone cannot side-step now, else None."""
    begun = begin(station, event, now_ns)
    return begun if isinstance(begun, Refusal) else None


def begin(station: Station, event: SideStepOrdered, now_ns: int) -> Stepped | Refusal:
    """Return the station with a side-step begun, in the first direction that the gate accepts."""
    late = given_refusal(event.given_at_ns, now_ns, station.settings.safety)
    if late is not None:
        return late
    serial = event.serial or meant(station)
    drone = claimed(station, SideStep.rule, serial, event.by, event.person, now_ns)
    return drone if isinstance(drone, Refusal) else _begun(drone, event, now_ns)


def meant(station: Station) -> str | None:
    """Return the imaging drone to side-step when none is named: light is unknown below it.

    The first one that shows the field if light is known below all of them; None without any.
    """
    unknown, imagers = station.imager_motions.unknown_since_ns, station.imaging.imagers
    present = (*imagers_at_work(station), *imagers)
    return next((s for s in present if s in unknown), None) or next(iter(present), None)


def advance(
    station: Station, now_ns: int, settings: SideStepSettings = SIDE_STEP_SETTINGS
) -> Stepped:
    """Advance the side-step under way, or begin one automatically if it is due."""

    def advanced(station: Station, current: SideStep, now_ns: int) -> Stepped:
        if current.stage is MotionStage.WAITING:
            return _wait(station, current, settings, now_ns)
        return follow(station, current, settings.leg_within_s, _arrived, now_ns)

    went_on = go_on(station, SideStep, advanced, now_ns)
    return begin_if_due(station, now_ns, settings) if went_on is None else went_on


def begin_if_due(station: Station, now_ns: int, settings: SideStepSettings) -> Stepped:
    """Begin a side-step for a survey if its light has been unknown for long enough."""
    records = station.surveys.records.values()
    allowing = (each for each in records if each.is_running and each.survey.side_step_allowed)
    record, serial = next(allowing, None), unknown_for_long(station, now_ns, settings)
    if record is None or serial is None:
        return not_refused(station, SideStep), ()
    motions = station.imager_motions
    if now_ns < motions.start(SideStep).due_ns or motions.under_way() is not None:
        return station, ()
    event = SideStepOrdered(
        record.issuer, person=record.person, survey_id=record.survey.id, serial=serial
    )
    begun = begin(station, event, now_ns)
    every_s, again_s = settings.automatic_every_s, settings.refused_again_s
    return after_automatic_begin(station, SideStep, begun, every_s, again_s, now_ns)


def conditions(station: Station) -> Iterator[Condition]:
    """Yield what an operator must know: a motion without an order of now, and where it ended."""
    newest, distance_m = station.imager_motions.of(SideStep), SIDE_STEP_SETTINGS.distance_m
    text = f"side-steps for its survey: {distance_m:g} m and back, light is unknown"
    yield from notices.automatic_motion(station, newest, text)
    if newest is not None and newest.stage is MotionStage.WAITING:
        text = f"waits beside its place, its path back is refused: {newest.reason}"
        yield notices.about(station, newest, Severity.WARNING, "waits", text)
    yield from notices.off_its_place(station, newest, "Send it back to where it shows the field")
    if station.imager_motions.start(SideStep).refused is not None:
        text = "light is unknown, and the imaging drone cannot side-step"
        yield from notices.cannot_begin(station, SideStep, meant(station) or "", text)


def _refused(station: Station, event: Event, now_ns: int) -> AuditEntry | None:
    why = refusal(station, event, now_ns) if isinstance(event, SideStepOrdered) else None
    if why is None or not isinstance(event, SideStepOrdered):
        return None
    return notices.refused_entry(SideStep, why, event.by, event.serial or meant(station))


def _described(motion: SideStep) -> tuple[str, Mapping[str, float]]:
    text = f"side-step to bearing {motion.bearing_deg:.0f} deg"
    return text, {"bearing_deg": motion.bearing_deg}


def _begun(drone: Claimed, event: SideStepOrdered, now_ns: int) -> Stepped | Refusal:
    """Try each direction; if the gate refuses all, return why it refused the best one."""
    place, height_m, first = drone.place, drone.height_above_takeoff_m, None
    station = not_refused(drone.station, SideStep)
    for bearing_deg in bearings_deg(_sun_azimuth_deg(station, place, now_ns)):
        aside = place_aside(place, bearing_deg, SIDE_STEP_SETTINGS.distance_m)
        motion = SideStep(
            serial=drone.vehicle.serial or "",
            name=drone.vehicle.display_name,
            by=event.by,
            begun_at_ns=now_ns,
            place=place,
            height_above_takeoff_m=height_m,
            bearing_deg=bearing_deg,
            stage=MotionStage.ASIDE,
            since_ns=now_ns,
            survey_id=event.survey_id,
        )
        body = GoTo(aside, height_m, SIDE_STEP_SETTINGS.speed_mps)
        begun = begin_with(replace(drone, station=station), motion, body, now_ns)
        if not isinstance(begun, Refusal):
            return begun
        first = first or begun
    assert first is not None, "at least one direction is tried"
    return replace(
        first, reason=f"{first.reason}; every other direction of 25 m was refused as well"
    )


def _sun_azimuth_deg(station: Station, place: LatLon, now_ns: int) -> float | None:
    """The sun's azimuth by the computer's clock; None before it was read."""
    clock = station.clock
    if clock is None or not place.is_valid():
        return None
    return sun_position(place, ns_to_seconds(now_ns + clock.ahead_ns)).azimuth_deg


def _arrived(station: Station, current: SideStep, now_ns: int) -> Stepped:
    if current.stage is MotionStage.BACK:
        return done(station, current, now_ns)
    if _is_held_aside(station, current):
        return _fly_back(station, current, now_ns)
    return stopped(station, current, HOLD_ENDED, now_ns), ()


def _wait(station: Station, current: SideStep, settings: SideStepSettings, now_ns: int) -> Stepped:
    """Wait beside its place: have the gate judge the leg back again, for a while."""
    if not _is_held_aside(station, current):
        return stopped(station, current, HOLD_ENDED, now_ns), ()
    if now_ns - current.since_ns > seconds_to_ns(settings.gate_waits_s):
        why = f"its path back was refused for {settings.gate_waits_s:g} s: {current.reason}"
        return held(station, current, why, now_ns)
    if now_ns - current.judged_at_ns < seconds_to_ns(settings.judged_again_s):
        return station, ()
    return _fly_back(station, current, now_ns)


def _is_held_aside(station: Station, current: SideStep) -> bool:
    """Whether the goto aside still holds it there: when that has ended, nothing resumes."""
    stream = station.control(current.serial).stream
    if stream is None or stream.command.id != current.command_id:
        return False
    return stream.closing is None


def _fly_back(station: Station, current: SideStep, now_ns: int) -> Stepped:
    """Order the leg back; while it is refused, the first goto holds the vehicle beside its place.

    A refused try leaves no record: it is made again every second.
    """
    body = GoTo(current.place, current.height_above_takeoff_m, SIDE_STEP_SETTINGS.speed_mps)
    flying, outputs, record = tried(station, current, body, now_ns)
    if not is_refused(record):
        back = replace(current, command_id=record.command.id).at(MotionStage.BACK, now_ns)
        return put(flying, back), outputs
    if current.stage is MotionStage.ASIDE:
        current = current.at(MotionStage.WAITING, now_ns)
    return put(station, replace(current, judged_at_ns=now_ns, reason=record.note)), ()


SIDE_STEP = Operation(
    name="side-step",
    tick=advance,
    conditions=conditions,
    commands=(on(SideStepOrdered, order),),
    audit=notices.audit_of(SideStep, _described, _refused),
    on_shade=on_shade,
)
