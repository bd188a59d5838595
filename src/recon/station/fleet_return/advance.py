"""Carrying a fleet return on: who stands is planned, whose turn has come is sent its mission."""

from dataclasses import replace

from recon.guidance.fleet_return import (
    Flight,
    Place,
    Returning,
    UnderWay,
    hindrance,
    mission_of,
    plan_return,
)
from recon.model.command import FlyMission, Refusal
from recon.model.event import OperatorOrder
from recon.model.units import seconds_to_ns
from recon.safety import judge
from recon.station import commanding
from recon.station.commanding import Stepped
from recon.station.fleet_return import places
from recon.station.fleet_return.record import UNDER_WAY, FleetReturn, Member, Stage
from recon.station.fleet_return.settings import ReturnSettings
from recon.station.fleet_return.watch import seen
from recon.station.own_ids import take_id
from recon.station.state import Station

SETTINGS = ReturnSettings()

WAITING_RULES = ("separation", "link_age")
"""Refusals of the gate that time may end; any other stands."""


def advance(station: Station, now_ns: int, settings: ReturnSettings = SETTINGS) -> Stepped:
    """Return the station after a fleet return has gone on as far as it can now."""
    running = station.fleet_return
    if running is None or running.is_over or now_ns < running.look_at_ns:
        return station, ()
    running = replace(running, look_at_ns=now_ns + seconds_to_ns(settings.look_every_s))
    for member in running.members.values():
        running = running.put(seen(station, member, settings, now_ns))
    if running.at(Stage.STOPPING):
        return replace(station, fleet_return=running), ()
    if any(member.flight is None for member in running.at(Stage.WAITING)):
        running = _planned(station, running, settings, now_ns)
    return _begin_one(station, running, settings, now_ns)


def _planned(
    station: Station, running: FleetReturn, settings: ReturnSettings, now_ns: int
) -> FleetReturn:
    """Plan for all that wait; those that cannot be planned for are left out."""
    vehicles: list[Returning] = []
    for member in running.at(Stage.WAITING):
        found = places.returning(station, member.serial, running.frame)
        if isinstance(found, str):
            running = running.put(member.at(Stage.LEFT_OUT, now_ns, found))
        else:
            vehicles.append(found)
    if not vehicles:
        return running
    called = {vehicle.serial for vehicle in vehicles}
    moving = {member.serial for member in running.at(*UNDER_WAY)}
    plan = plan_return(
        vehicles,
        places.air(station, vehicles, settings),
        places.separation(station, settings),
        settings.plan,
        places.hovering(station, running.frame, called | moving),
        1 + max((_wave(member) for member in running.members.values()), default=0),
    )
    for flight in plan.flights:
        member = running.members[flight.serial]
        running = running.put(replace(member, flight=flight))
    for left in plan.left_out:
        member = running.members[left.serial]
        running = running.put(member.at(Stage.LEFT_OUT, now_ns, left.reason))
    turns = tuple(flight.serial for flight in plan.flights)
    return replace(running, turns=turns, layers_up_m=plan.layers_up_m)


def _wave(member: Member) -> int:
    """Whose wave has begun keeps it; those that wait are planned anew."""
    has_begun = member.flight is not None and member.stage is not Stage.WAITING
    return member.flight.wave if has_begun and member.flight is not None else 0


def _begin_one(
    station: Station, running: FleetReturn, settings: ReturnSettings, now_ns: int
) -> Stepped:
    """Begin the first flight in turn that may; one at a time, for each changes what others may."""
    waiting = [m for serial in running.turns if (m := running.members[serial]).flight is not None]
    waiting = [member for member in waiting if member.stage is Stage.WAITING]
    for index, member in enumerate(waiting):
        place_m = places.place_of(station, member.serial, running.frame)
        if place_m is None or member.flight is None:
            continue
        if _far_m(place_m, member.flight.start_m) > settings.moved_m:
            words = "it was moved from where it waited: its pilot has it, or it drifts"
            running = running.put(member.at(Stage.LEFT_OUT, now_ns, words))
            continue
        before = [other.flight for other in waiting[:index] if other.flight is not None]
        now = _from_here(member.flight, place_m)
        member = _hindered(station, running, member, now, before, settings, now_ns)
        running = running.put(member)
        if member.reason == "":
            return _judged(station, running, member, now, settings, now_ns)
    return replace(station, fleet_return=_anew_if_stuck(running, settings, now_ns)), ()


def _anew_if_stuck(running: FleetReturn, settings: ReturnSettings, now_ns: int) -> FleetReturn:
    """Let those that wait be planned for anew when nothing they wait for will end by itself.

    So it is when somebody hovers where nobody did when the plan was made.
    """
    waiting = running.at(Stage.WAITING)
    is_patient = any(member.clears or now_ns < member.judge_at_ns for member in waiting)
    if not waiting or is_patient or running.at(*UNDER_WAY):
        return running
    for member in waiting:
        running = running.put(replace(member, flight=None))
    return replace(running, look_at_ns=now_ns + seconds_to_ns(settings.planned_again_s))


def _from_here(flight: Flight, place_m: Place) -> Flight:
    """The flight from where the vehicle has drifted to since it was planned."""
    return replace(flight, start_m=place_m, way_m=(place_m[:2], *flight.way_m[1:]))


def _far_m(one: Place, other: Place) -> float:
    return float(sum((a - b) ** 2 for a, b in zip(one, other, strict=True)) ** 0.5)


def _hindered(
    station: Station,
    running: FleetReturn,
    member: Member,
    flight: Flight,
    before: list[Flight],
    settings: ReturnSettings,
    now_ns: int,
) -> Member:
    """Return the member with the reason why it must wait, "" when its turn has come."""
    if now_ns < member.judge_at_ns:
        return member
    clears = _to_be_cleared(running, flight, settings, now_ns)
    member = replace(member, clears=clears)
    if clears is not None:
        return member.waits_for(f"its pad is being cleared of {clears}")
    moving = running.at(*UNDER_WAY)
    under_way = [
        UnderWay(other.flight, place_m)
        for other in moving
        if other.flight is not None
        and (place_m := places.place_of(station, other.serial, running.frame)) is not None
    ]
    without = {flight.serial, *(other.serial for other in moving)}
    hovering = places.hovering(station, running.frame, without)
    separation = places.separation(station, settings)
    fault = hindrance(flight, before, under_way, hovering, separation, settings.plan)
    return member.waits_for(fault or "")


def _to_be_cleared(
    running: FleetReturn, flight: Flight, settings: ReturnSettings, now_ns: int
) -> str | None:
    """The vehicle that landed on this pad a moment ago and is still to be carried away."""
    for other in running.at(Stage.LANDED):
        if other.flight is None or now_ns - other.since_ns >= seconds_to_ns(
            settings.pad_clearing_s
        ):
            continue
        pad = other.flight.pad
        apart_m = _far_m(
            (pad.east_m, pad.north_m, 0.0), (flight.pad.east_m, flight.pad.north_m, 0.0)
        )
        if apart_m < settings.same_pad_m:
            return other.name
    return None


def _judged(
    station: Station,
    running: FleetReturn,
    member: Member,
    flight: Flight,
    settings: ReturnSettings,
    now_ns: int,
) -> Stepped:
    """Ask the gate, and give the mission; while time may end a refusal, wait for that."""
    speed_mps = station.airspace.airspace.limits.max_speed_mps
    mission = mission_of(flight, running.frame, flight.start_m, settings.plan, speed_mps)
    order = OperatorOrder(
        0, FlyMission(mission), f"{running.by}: fleet return", serial=member.serial
    )
    command = commanding.command_of(station, order, now_ns)
    refusal = judge(command, commanding.situation(station, command, now_ns))
    if refusal is not None and _may_end(running, member, refusal, settings, now_ns):
        since_ns = now_ns if member.refused_since_ns is None else member.refused_since_ns
        waits = replace(
            member.waits_for(f"the gate says not yet: {refusal.reason}"),
            judge_at_ns=now_ns + seconds_to_ns(settings.judged_again_s),
            refused_since_ns=since_ns,
        )
        return replace(station, fleet_return=running.put(waits)), ()
    station, number = take_id(station)
    given = replace(member.at(Stage.ORDERED, now_ns), flight=flight, mission_id=number)
    station = replace(station, fleet_return=running.put(given))
    return commanding.place(station, replace(order, command_id=number), now_ns)


def _may_end(
    running: FleetReturn, member: Member, refusal: Refusal, settings: ReturnSettings, now_ns: int
) -> bool:
    if refusal.rule not in WAITING_RULES:
        return False
    if running.at(*UNDER_WAY) or member.refused_since_ns is None:
        return True
    return now_ns - member.refused_since_ns < seconds_to_ns(settings.gate_waits_s)
