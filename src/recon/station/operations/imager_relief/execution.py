"""The execution of a relief: one mission to the place, shade maps from there, the route home.

    to_place --its mission is flown to the end--> maps: its camera is switched on if it is quiet
    maps --three shade maps in a row that show the ground--> done: the relieved one is recalled
    either --pilot, another order, all stop, telemetry or connection lost, flight or maps late,
             what ends any motion (`imager_motion/execution.py`)--> stopped

The one that flies goes in a layer of its own, 10 m above the other's height or more. Both hover at
the place until the newer one's maps show seven tenths of the ground whose light the other knows; so
no moment is without light. A relief that stops holds its vehicle where it is, with an alarm: mostly
its camera or site file is at fault, best seen in place, and an order from there resumes at the
maps. The relieved one stays until its battery is at the return threshold, whatever becomes of the
relief.
"""

from dataclasses import replace

from recon.guidance.imager_relief import (
    FRAMES_HZ,
    RELIEF_SETTINGS,
    ImagerReliefSettings,
    least_share,
    shown_share,
)
from recon.model.command import Refusal, StartCamera
from recon.model.control import AuthorityHolder
from recon.model.event import OperatorOrder
from recon.model.shade import MaskMap, ShadeMap
from recon.model.units import seconds_to_ns
from recon.station.control import order_gateway
from recon.station.imaging.at_work import imagers_at_work
from recon.station.operations.imager_motion.execution import (
    done,
    follow,
    go_on,
    held,
    put,
)
from recon.station.operations.imager_relief.automatic import begin_if_due, recall_if_due
from recon.station.operations.imager_relief.outlook import checked
from recon.station.operations.imager_relief.return_home import recall
from recon.station.state.imager_motion import ImagerRelief, MotionStage
from recon.station.state.imaging import TOGETHER_WITHIN_S
from recon.station.state.station import Station, take_id
from recon.station.state.steps import Stepped


def advance(
    station: Station, now_ns: int, settings: ImagerReliefSettings = RELIEF_SETTINGS
) -> Stepped:
    """Advance the relief under way; once a second predict, begin one, recall what must return."""

    def advanced(station: Station, current: ImagerRelief, now_ns: int) -> Stepped:
        return _advanced(station, current, now_ns, settings)

    station, went_on = go_on(station, ImagerRelief, advanced, now_ns) or (station, ())
    station, is_due = checked(station, now_ns, settings)
    if not is_due:
        return station, went_on
    station, begun = begin_if_due(station, now_ns, settings)
    station, called = recall_if_due(station, now_ns, settings)
    return station, (*went_on, *begun, *called)


def on_shade(station: Station, _shade: ShadeMap) -> Station:
    """Count the maps in a row of the one that has reached the place."""
    current = station.imager_motions.of(ImagerRelief)
    own = None if current is None else station.shade.own.get(current.serial)
    if current is None or own is None or current.stage is not MotionStage.MAPS:
        return station
    at_ns, since_ns = own.shade.captured_at_ns, max(current.map_at_ns, current.since_ns)
    if at_ns <= since_ns:
        return station
    share = shown_share(own.shade.valid, _known_to_other(station, current, at_ns))
    own_m, others_m = (_height_m(station, each) for each in (current.serial, current.relieved))
    is_shown = share >= least_share(own_m, others_m)
    is_next = at_ns - current.map_at_ns <= seconds_to_ns(RELIEF_SETTINGS.map_gap_s)
    maps = (current.maps if is_next else 0) + 1 if is_shown else 0
    shows = f"its shade map shows {share:.0%} of what {current.relieved_name} shows"
    counted = replace(
        current,
        maps=maps,
        map_at_ns=at_ns,
        has_map=True,
        reason="" if is_shown else shows,
    )
    return put(station, counted)


def _height_m(station: Station, serial: str) -> float | None:
    vehicle = station.fleet.vehicles.get(serial)
    return None if vehicle is None else vehicle.height_above_takeoff_m.value


def _known_to_other(station: Station, current: ImagerRelief, at_ns: int) -> MaskMap | None:
    """The cells whose light the relieved one knows at a moment; None without a recent map."""
    other = station.shade.own.get(current.relieved)
    if other is None or current.comes_back:
        return None
    is_recent = at_ns - other.shade.captured_at_ns <= seconds_to_ns(TOGETHER_WITHIN_S)
    return other.shade.valid if is_recent else None


def _advanced(
    station: Station, current: ImagerRelief, now_ns: int, settings: ImagerReliefSettings
) -> Stepped:
    broken = _broken(station, current, now_ns, settings)
    if broken is not None:
        return held(station, current, broken, now_ns)
    if current.stage is MotionStage.MAPS:
        return _await_maps(station, current, now_ns, settings)
    return follow(station, current, current.within_s, _arrived, now_ns)


def _broken(
    station: Station, current: ImagerRelief, now_ns: int, settings: ImagerReliefSettings
) -> str | None:
    """Why nothing is known of its flight, or it does not fly at the place."""
    vehicle = station.fleet.vehicles.get(current.serial)
    if vehicle is None or vehicle.link_id != current.link_id:
        return "its connection was interrupted"
    received_ns = vehicle.core_received_at_ns
    if received_ns is None or now_ns - received_ns > seconds_to_ns(settings.telemetry_within_s):
        return f"no telemetry for {settings.telemetry_within_s:g} s"
    if current.stage is MotionStage.MAPS and vehicle.is_flying.value is False:
        return "it is on the ground"
    return None


def _arrived(station: Station, current: ImagerRelief, now_ns: int) -> Stepped:
    return put(station, current.at(MotionStage.MAPS, now_ns)), ()


def _await_maps(
    station: Station, current: ImagerRelief, now_ns: int, settings: ImagerReliefSettings
) -> Stepped:
    if current.maps >= settings.maps_in_a_row:
        return _relieved(station, current, now_ns)
    within_s = settings.maps_within_s if current.has_map else settings.first_map_within_s
    if now_ns - current.since_ns <= seconds_to_ns(within_s):
        return _with_camera(station, current, now_ns, settings)
    rejected = station.shade.rejected.get(current.serial)
    seen = current.reason or ("no frames" if rejected is None else rejected.reason)
    what = f"{settings.maps_in_a_row} shade maps in a row" if current.has_map else "shade map"
    why = f"no {what} within {within_s:g} s of its arrival: {seen}"
    return held(station, current, why, now_ns)


def _with_camera(
    station: Station, current: ImagerRelief, now_ns: int, settings: ImagerReliefSettings
) -> Stepped:
    """Switch its camera on, once, if no frame came for some seconds."""
    vehicle = station.fleet.vehicles[current.serial]
    newest_ns = max(vehicle.image_received_at_ns or 0, current.since_ns)
    is_quiet = now_ns - newest_ns > seconds_to_ns(settings.camera_quiet_s)
    if current.is_camera_ordered or not is_quiet:
        return station, ()
    station = put(station, replace(current, is_camera_ordered=True))
    station, number = take_id(station)
    order = OperatorOrder(
        number,
        StartCamera(FRAMES_HZ),
        f"{current.by}: {current.words}",
        serial=current.serial,
        role=AuthorityHolder.GUIDANCE,
    )
    return order_gateway.submit(station, order, now_ns)


def _relieved(station: Station, current: ImagerRelief, now_ns: int) -> Stepped:
    """End the relief at the place; recall the other one, if it is still there."""
    station, held_there = done(station, replace(current, reason=""), now_ns)
    if current.comes_back or current.relieved not in imagers_at_work(station):
        return station, held_there
    called = recall(station, current.relieved, current.by, current.person, now_ns)
    if not isinstance(called, Refusal):
        return called[0], (*held_there, *called[1])
    ended = station.imager_motions.of(ImagerRelief)
    assert ended is not None, "it has just been put there"
    return put(station, replace(ended, home_refused=called.reason)), held_there
