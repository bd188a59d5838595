"""The execution of a look aside: one goto aside, one back, then a hold.

    aside --arrived--> back, or waiting while the gate refuses the way back
    waiting --the gate approves--> back
    back --arrived--> done
    any of them --whatever ends a motion (`imager_motion/execution.py`)--> stopped

Each way ends by itself within a minute.
"""

from dataclasses import replace

from recon.guidance.look_aside import LOOK_ASIDE_SETTINGS, LookAsideSettings
from recon.model.command import GoTo
from recon.model.units import seconds_to_ns
from recon.station.operations.imager_motion.execution import (
    done,
    follow,
    held,
    is_refused,
    not_of_guidance,
    put,
    stopped,
    tried,
)
from recon.station.operations.look_aside.by_itself import begin_if_due
from recon.station.state.imager_motion import LookAside, MotionStage
from recon.station.state.station import Station
from recon.station.state.steps import Stepped

HOLD_ENDED = "the station could no longer hold it beside its place"


def advance(
    station: Station, now_ns: int, settings: LookAsideSettings = LOOK_ASIDE_SETTINGS
) -> Stepped:
    """Advance the look aside under way, or begin one by itself if it is due."""
    current = station.look_asides.newest
    if current is None or current.is_over:
        return begin_if_due(station, now_ns, settings)
    ended = not_of_guidance(station, current, now_ns)
    if ended is not None:
        return ended, ()
    if current.stage is MotionStage.WAITING:
        return _wait(station, current, settings, now_ns)
    return follow(station, current, settings.leg_within_s, _arrived, now_ns)


def _arrived(station: Station, current: LookAside, now_ns: int) -> Stepped:
    if current.stage is MotionStage.BACK:
        return done(station, current, now_ns)
    if _is_held_aside(station, current):
        return _fly_back(station, current, now_ns)
    return stopped(station, current, HOLD_ENDED, now_ns), ()


def _wait(
    station: Station, current: LookAside, settings: LookAsideSettings, now_ns: int
) -> Stepped:
    """Beside its place: have the gate judge the way back again, for a while."""
    if not _is_held_aside(station, current):
        return stopped(station, current, HOLD_ENDED, now_ns), ()
    if now_ns - current.since_ns > seconds_to_ns(settings.gate_waits_s):
        why = f"its way back was refused for {settings.gate_waits_s:g} s: {current.reason}"
        return held(station, current, why, now_ns)
    if now_ns - current.judged_at_ns < seconds_to_ns(settings.judged_again_s):
        return station, ()
    return _fly_back(station, current, now_ns)


def _is_held_aside(station: Station, current: LookAside) -> bool:
    """Whether the goto aside still holds it there: when that has ended, nothing resumes."""
    stream = station.control(current.serial).stream
    if stream is None or stream.command.id != current.command_id:
        return False
    return stream.closing is None


def _fly_back(station: Station, current: LookAside, now_ns: int) -> Stepped:
    """Order the way back; while it is refused, the first goto holds the vehicle beside its place.

    A refused try leaves no record: it is made again every second.
    """
    body = GoTo(current.place, current.height_above_takeoff_m, LOOK_ASIDE_SETTINGS.speed_mps)
    flying, outputs, record = tried(station, LookAside, current.by, current.serial, body, now_ns)
    if not is_refused(record):
        back = replace(current, command_id=record.command.id).at(MotionStage.BACK, now_ns)
        return put(flying, back), outputs
    if current.stage is MotionStage.ASIDE:
        current = current.at(MotionStage.WAITING, now_ns)
    return put(station, replace(current, judged_at_ns=now_ns, reason=record.note)), ()
