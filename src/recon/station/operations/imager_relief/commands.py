"""Beginning a relief: guidance gets the imaging drone, and the gate chooses its layer."""

from collections.abc import Mapping
from dataclasses import replace
from math import degrees

from recon.geo.distance import horizontal_distance_m
from recon.guidance.imager_relief import RELIEF_SETTINGS, layers_m, relief_mission, transit_time_s
from recon.model.command import Command, FlyMission, Refusal
from recon.model.control import AuthorityHolder
from recon.model.event import AuthorityTaken, Event, ReliefOrdered
from recon.model.mission import DJI
from recon.model.vehicle import Mount, VehicleState
from recon.record.audit.audit import AuditEntry
from recon.safety.datum import takeoff_up_m
from recon.safety.energy import consumption, need_of
from recon.safety.rules.not_expired import given_refusal
from recon.station.control import handover
from recon.station.control.stop_latch import RULE as STOP_RULE
from recon.station.imaging.at_work import imagers_at_work, is_going_home, is_in_the_air
from recon.station.operations.fleet_return.planning import PLAN_LASTS_S, separation
from recon.station.operations.imager_motion.claim import is_at_rest
from recon.station.operations.imager_motion.execution import is_refused, put, tried
from recon.station.operations.imager_motion.notices import audit_of, refused_entry
from recon.station.operations.imager_relief import return_home
from recon.station.operations.settings import RETURN_SETTINGS
from recon.station.state.imager_motion import ImagerRelief, MotionStage
from recon.station.state.imager_relief import HoverPlace
from recon.station.state.station import Station
from recon.station.state.steps import Stepped

RULE = ImagerRelief.rule
THERE_M = 2.0
"""A drone this near to the place, at one of the heights, is there already."""


def order_relief(station: Station, event: ReliefOrdered, now_ns: int) -> Stepped:
    """Begin a relief, unless it is refused; then nothing changes."""
    begun = begin(station, event, now_ns)
    return (station, ()) if isinstance(begun, Refusal) else begun


def refusal(station: Station, event: ReliefOrdered, now_ns: int) -> Refusal | None:
    """Return why an imaging drone cannot be relieved so now, else None."""
    begun = begin(station, event, now_ns)
    return begun if isinstance(begun, Refusal) else None


def begin(station: Station, event: ReliefOrdered, now_ns: int) -> Stepped | Refusal:
    """Return the station with a relief begun, in the nearest layer that the gate accepts."""
    why = given_refusal(event.given_at_ns, now_ns, station.settings.safety)
    why = why or _unknown(station, event) or _busy(station, event, now_ns)
    if why is not None:
        return why
    at = _place(station, event.relieved)
    if isinstance(at, Refusal):
        return at
    if event.relieved == event.serial or not is_in_the_air(station, event.relieved):
        return _begun(station, event, at, (at.up_m,), now_ns)
    if event.relieved not in imagers_at_work(station):  # it leaves, or waits for its turn to
        return _begun(
            station, event, at, (at.up_m, *_layers_up_m(station, event, at, now_ns)), now_ns
        )
    why = _cannot_leave(station, event, now_ns)
    return why or _begun(station, event, at, _layers_up_m(station, event, at, now_ns), now_ns)


def _refused(station: Station, event: Event, now_ns: int) -> AuditEntry | None:
    why = refusal(station, event, now_ns) if isinstance(event, ReliefOrdered) else None
    if why is None or not isinstance(event, ReliefOrdered):
        return None
    return refused_entry(ImagerRelief, why, event.by, event.serial, relieved=event.relieved)


def _described(motion: ImagerRelief) -> tuple[str, Mapping[str, float]]:
    text = "return to its place" if motion.comes_back else f"relief of {motion.relieved_name}"
    return text, {"height_above_takeoff_m": round(motion.height_above_takeoff_m, 1)}


audit_entries = audit_of(ImagerRelief, _described, _refused)
"""Yields an entry for the command, and for each change of stage."""


def _unknown(station: Station, event: ReliefOrdered) -> Refusal | None:
    """Why a named vehicle is no imaging drone, or not connected."""
    imagers, vehicles = station.imaging.imagers, station.fleet.vehicles
    for serial in (event.relieved, event.serial):
        if serial not in imagers:
            known = ", ".join(imagers) or "none: the site has no imaging drone"
            return Refusal(RULE, f"{serial} is no imaging drone of the site: expected {known}")
    if event.serial not in vehicles:
        return Refusal(RULE, f"the imaging drone {event.serial} is not connected")
    return None


def _busy(station: Station, event: ReliefOrdered, now_ns: int) -> Refusal | None:
    """Why the imaging drone that is to fly cannot begin to."""
    serial, vehicle = event.serial, station.fleet.vehicles[event.serial]
    name, is_up = vehicle.display_name, vehicle.is_flying.value
    if station.is_stopped(serial):
        return Refusal(STOP_RULE, f"{name} is held by an all stop; release its stop first")
    other = station.imager_motions.under_way()
    if other is not None:
        return Refusal(RULE, f"{other.name} {other.doing} already")
    if is_in_the_air(station, serial) and is_going_home(station, serial):
        return Refusal(RULE, f"{name} is returning home; hold it first, or let it land")
    if is_up is not True and not event.takeoff:
        return Refusal(RULE, f"{name} is not in the air, and takeoff was not allowed")
    if is_up is True and not is_at_rest(station, vehicle):
        return Refusal(RULE, f"{name} is moving; hold it first")
    taken = AuthorityTaken(serial, AuthorityHolder.GUIDANCE, event.by, event.person)
    return handover.refusal(station, taken, now_ns)


def _place(station: Station, serial: str) -> HoverPlace | Refusal:
    """Where the relieved one hovers, or hovered last."""
    known = station.reliefs.places.get(serial)
    vehicle = station.fleet.vehicles.get(serial)
    if known is None:
        name = serial if vehicle is None else vehicle.display_name
        return Refusal(RULE, f"{name} has not hovered over the field yet: fly it to its place")
    return known


def _cannot_leave(station: Station, event: ReliefOrdered, now_ns: int) -> Refusal | None:
    """Why the relieved one, in the air, could not be recalled afterwards."""
    vehicle = station.fleet.vehicles[event.relieved]
    if not is_at_rest(station, vehicle):
        return Refusal(RULE, f"{vehicle.display_name} is moving; hold it first")
    return return_home.refusal(station, event.relieved, event.by, event.person, now_ns)


def _layers_up_m(
    station: Station, event: ReliefOrdered, at: HoverPlace, now_ns: int
) -> tuple[float, ...]:
    """Return heights above the site near the one that hovers there, the nearest first."""
    hovering = station.fleet.vehicles[event.relieved]
    base_m = takeoff_up_m(station.airspace, hovering)
    if base_m is None:
        return ()
    height_m = at.up_m - base_m
    goes_home_m = None if hovering.profile is None else hovering.profile.go_home_height_m
    limits = station.airspace.airspace.limits
    heights_m = layers_m(
        height_m,
        separation(station, RETURN_SETTINGS, now_ns, PLAN_LASTS_S).vertical_m,
        limits.max_height_above_ground_m - RELIEF_SETTINGS.below_ceiling_m,
        # Recalled by its aircraft it would climb through what hovers above it.
        may_be_above=goes_home_m is not None and goes_home_m <= height_m,
    )
    return tuple(base_m + each for each in heights_m)


def _begun(
    station: Station, event: ReliefOrdered, at: HoverPlace, ups_m: tuple[float, ...], now_ns: int
) -> Stepped | Refusal:
    """Try each height above the site; if the gate refuses all, return why it refused the first."""
    vehicle = station.fleet.vehicles[event.serial]
    base_m, height_m = takeoff_up_m(station.airspace, vehicle), vehicle.height_above_takeoff_m.value
    here, name = vehicle.position.value, vehicle.display_name
    if base_m is None or here is None or height_m is None:
        return Refusal(RULE, f"{name}: position, height or takeoff point unknown")
    taken = AuthorityTaken(event.serial, AuthorityHolder.GUIDANCE, event.by, event.person)
    claimed, withdrawn = handover.take(station, taken, now_ns)
    first: Refusal | None = None
    for to_m in (up_m - base_m for up_m in ups_m):
        takes_s = transit_time_s(here, to_m - height_m, at.place)
        motion = _motion(station, event, at, to_m, takes_s, now_ns)
        is_near = horizontal_distance_m(here, at.place) < THERE_M
        if is_near and abs(to_m - height_m) < THERE_M:
            return put(claimed, motion.at(MotionStage.MAPS, now_ns)), withdrawn
        mission = relief_mission(here, at.place, to_m, _gimbal_deg(station, vehicle))
        body, takeoff = FlyMission(mission), vehicle.is_flying.value is not True
        flying, sent, order = tried(claimed, motion, body, now_ns, takeoff=takeoff)
        why = order.refusal if is_refused(order) else _too_short(station, vehicle, order.command)
        if why is None:
            return put(flying, replace(motion, command_id=order.command.id)), (*withdrawn, *sent)
        first = first or why
    if first is None:
        first = Refusal(RULE, f"{name}: no height beside the other one is below the ceiling")
    others = "; every other height was refused as well" if len(ups_m) > 1 else ""
    return replace(first, reason=f"{first.reason}{others}")


def _motion(
    station: Station,
    event: ReliefOrdered,
    at: HoverPlace,
    height_m: float,
    takes_s: float,
    now_ns: int,
) -> ImagerRelief:
    vehicle = station.fleet.vehicles[event.serial]
    relieved = station.fleet.vehicles.get(event.relieved)
    return ImagerRelief(
        serial=event.serial,
        name=vehicle.display_name,
        by=event.by,
        begun_at_ns=now_ns,
        place=at.place,
        height_above_takeoff_m=height_m,
        stage=MotionStage.TO_PLACE,
        since_ns=now_ns,
        survey_id=event.survey_id,
        relieved=event.relieved,
        relieved_name=event.relieved if relieved is None else relieved.display_name,
        within_s=takes_s + RELIEF_SETTINGS.late_by_s,
        link_id=vehicle.link_id,
        person=event.person,
    )


def _gimbal_deg(station: Station, vehicle: VehicleState) -> float | None:
    """The pitch at which a gimbal's camera looks as the site states; None on a fixed mount."""
    outlook = station.imaging.imagers[vehicle.serial or ""].outlook
    if outlook is None or vehicle.profile is None or vehicle.profile.mount is not Mount.GIMBAL:
        return None
    pitch_deg = round(degrees(outlook.tilt_rad)) - 90.0
    return min(max(pitch_deg, DJI.min_gimbal_pitch_deg), DJI.max_gimbal_pitch_deg)


def _too_short(station: Station, vehicle: VehicleState, command: Command) -> Refusal | None:
    """Why its battery gives too little time at the place; the gate judged the path itself."""
    uses = consumption(vehicle, station.airspace, station.settings.safety.energy)
    has = vehicle.battery_fraction.value
    need = None if uses is None else need_of(uses, vehicle, command.body)
    assert uses is not None, "the gate refuses an unknown need"
    assert need is not None, "the gate refuses an unknown need"
    assert has is not None, "the gate refuses an unknown charge"
    reserve = station.airspace.airspace.limits.battery_reserve_fraction
    stays_s = (has - reserve - need.whole) / uses.fraction(1.0)
    if stays_s >= RELIEF_SETTINGS.stays_s:
        return None
    least_min = RELIEF_SETTINGS.stays_s / 60.0
    return Refusal(
        RULE,
        f"{vehicle.display_name}: its battery gives {stays_s / 60.0:.0f} min at the place; "
        f"expected {least_min:g} min or more: change it",
        parameters={"stays_s": stays_s, "min_s": RELIEF_SETTINGS.stays_s},
    )
