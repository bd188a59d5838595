"""The execution of a fleet return: vehicles at rest are planned, and fly home in turn.

Each vehicle goes through stages (`Stage`); five times a second they are read anew:

- *Stopping*: it was commanded to hold. At rest within 12 s it waits; else it is excluded.
- *Waiting*: it hovers. When none is stopping, the worker plans all that wait: a layer, a wave and a
  landing mission each. Then the first vehicle in turn begins whose layer, pad and path are free,
  and only one at a time, for each changes what others may do. A refusal of the gate that time may
  end (`WAITING_RULES`) is tried again every second, at most 30 s while no other flies. When all
  that wait are blocked by something that does not end without a command, or temporary zones have
  changed, they are planned again.
- *Ordered*, then *flying*: its mission was approved; telemetry shows it.
- Ends: *landed*; *released*, when its pilot or a newer order controls it; *excluded*, when anything
  else went wrong, with an alarm and its reason. Nothing that went wrong is resumed automatically.

A vehicle whose mission was ignored is held when it is excluded: begun late, the mission would cross
the paths of others. At the end, what guidance had recalled goes back to the operator.
"""

from dataclasses import replace
from math import dist

from recon.guidance.fleet_return import (
    Claim,
    Place,
    ReturnFlight,
    claim_left,
    hindrance,
    layer_is_taken_by,
    least_time_s,
    mission_of,
    whole_claim,
)
from recon.model.command import FollowPath, Hover, LandNow, Phase, Refusal, issued_by_station
from recon.model.control import AuthorityHolder
from recon.model.event import OperatorOrder
from recon.model.units import seconds_to_ns
from recon.safety import judge
from recon.station.control import authority, order_gateway
from recon.station.control.missions import body_for
from recon.station.control.situation_builder import command_of, situation
from recon.station.operations.fleet_return import planning
from recon.station.operations.fleet_return.planning import is_same_pad
from recon.station.operations.fleet_return.progress import updated
from recon.station.operations.settings import RETURN_SETTINGS, ReturnSettings
from recon.station.state.fleet_return_record import (
    ENDED,
    UNDER_WAY,
    FleetReturn,
    ReturningVehicle,
    Stage,
)
from recon.station.state.station import Station, take_id
from recon.station.state.steps import Output, Stepped

WAITING_RULES = ("separation", "link_age")
"""Rules of the gate whose refusals may end with time; any other refusal is final."""

MOVED = "it moved while it waited: its pilot flies it, or it drifts"


def advance(station: Station, now_ns: int, settings: ReturnSettings = RETURN_SETTINGS) -> Stepped:
    """Advance the fleet return as far as it can go now."""
    station = _hand_back_ended(station, now_ns)
    running = station.fleet_return
    if running is None or running.is_over or now_ns < running.step_due_ns:
        return station, ()
    running = replace(running, step_due_ns=now_ns + seconds_to_ns(settings.step_every_s))
    running = _with_zones_of_now(station, running)
    for member in running.members.values():
        running = running.put(updated(station, member, settings, now_ns))
    station, running, landings = _land_steered(station, running, now_ns)
    station, stops = _hold_late_starters(station, running, now_ns)
    stops = (*landings, *stops)
    if running.at(Stage.STOPPING):
        return replace(station, fleet_return=running), stops
    if any(member.flight is None for member in running.at(Stage.WAITING)):
        running, work = planning.ask(station, running, settings, now_ns)
        return replace(station, fleet_return=running), (*stops, *work)
    station, begun = _begin_one(station, running, settings, now_ns)
    return station, (*stops, *begun)


def _with_zones_of_now(station: Station, running: FleetReturn) -> FleetReturn:
    """Have all that wait planned again after temporary zones have changed."""
    changes = station.temporary_zones.changes
    if running.zone_changes == changes:
        return running
    for member in running.at(Stage.WAITING):
        running = running.put(replace(member, flight=None))
    return replace(running, planning_since_ns=None, zone_changes=changes)


def _hand_back_ended(station: Station, now_ns: int) -> Station:
    """Give vehicles that guidance recalled back to the operator at their end.

    Those given to guidance again since then stay with it.
    """
    running = station.fleet_return
    for member in () if running is None else running.at(*ENDED):
        controlled_since_ns = station.control(member.serial).authority.since_ns
        if member.role is AuthorityHolder.GUIDANCE and controlled_since_ns <= member.since_ns:
            why = f"fleet return: {member.reason or 'landed'}"
            station = authority.hand_back(station, member.serial, member.by, why, now_ns)
    return station


def _land_steered(
    station: Station, running: FleetReturn, now_ns: int
) -> tuple[Station, FleetReturn, tuple[Output, ...]]:
    """Land vehicles that were steered to above their pads: a mission ends with its own landing."""
    outputs: tuple[Output, ...] = ()
    for member in running.at(Stage.FLYING):
        record = station.orders.records.get(member.mission_id or 0)
        if record is None or record.phase is not Phase.DONE:
            continue
        if isinstance(record.command.body, FollowPath):
            station, number = take_id(station)
            running = running.put(replace(member, mission_id=number))
            given = record.command
            land = OperatorOrder(
                number,
                LandNow(),
                given.issued_by,
                serial=member.serial,
                role=given.role,
                person=given.person,
            )
            station, sent = order_gateway.submit(station, land, now_ns)
            outputs += sent
    return station, running, outputs


def _hold_late_starters(station: Station, running: FleetReturn, now_ns: int) -> Stepped:
    """Hold vehicles whose mission was ignored: begun now, it would cross the paths of others."""
    outputs: list[Output] = []
    for member in running.at(Stage.EXCLUDED):
        record = station.orders.records.get(member.mission_id or 0)
        if member.since_ns != now_ns or record is None or record.phase is not Phase.TIMED_OUT:
            continue
        station, number = take_id(station)
        why = f"fleet return: the mission of order {record.command.id} was ignored"
        hold = OperatorOrder(number, Hover(), issued_by_station(why), serial=member.serial)
        station, sent = order_gateway.submit(station, hold, now_ns)
        outputs += sent
    return station, tuple(outputs)


def _begin_one(
    station: Station, running: FleetReturn, settings: ReturnSettings, now_ns: int
) -> Stepped:
    """Begin the first flight in turn that may begin."""
    running, ready = _with_free_layers(running, settings, now_ns)
    if ready:
        traffic = _Traffic(station, running, settings, now_ns)
        for member in ready:
            flight = traffic.from_here(member)
            if flight is None:
                running = running.put(member.at(Stage.EXCLUDED, now_ns, MOVED))
                continue
            hindered = traffic.hindrance(flight, running)
            running = running.put(member.waits_for(hindered or ""))
            if hindered is None:
                return _order_mission(station, running, member, flight, settings, now_ns)
    return replace(station, fleet_return=_replanned_if_stuck(running, settings, now_ns)), ()


def _with_free_layers(
    running: FleetReturn, settings: ReturnSettings, now_ns: int
) -> tuple[FleetReturn, list[ReturningVehicle]]:
    """Return the vehicles whose layer and pad are free, in turn; give the others their reason."""
    before: list[ReturnFlight] = []
    ready: list[ReturningVehicle] = []
    flying = [m.flight for m in running.at(*UNDER_WAY) if m.flight is not None]
    for member in _waiting_in_turn(running):
        flight = member.flight
        assert flight is not None
        clears = _vehicle_on_pad(running, flight, settings, now_ns)
        reason = layer_is_taken_by(flight, before, flying)
        if clears is not None:
            reason = f"its pad is being cleared of {clears}"
        before.append(flight)
        member = replace(member, clears=clears)
        if reason is not None:
            running = running.put(member.waits_for(reason))
        elif now_ns >= member.judge_at_ns:
            running = running.put(member)
            ready.append(member)
    return running, ready


def _waiting_in_turn(running: FleetReturn) -> list[ReturningVehicle]:
    members = (running.members[serial] for serial in running.turns)
    return [m for m in members if m.stage is Stage.WAITING and m.flight is not None]


class _Traffic:
    """What is in the air now, collected once for all vehicles that might begin."""

    def __init__(
        self, station: Station, running: FleetReturn, settings: ReturnSettings, now_ns: int
    ) -> None:
        self._settings = settings
        self._separation = planning.separation(station, settings, now_ns)
        self._flying = planning.in_the_air(station, running.frame)
        self._moving = {member.serial for member in running.at(*UNDER_WAY)}
        self._under_way = [
            claim_left(member.flight, self._place_m(member), settings.plan)
            for member in running.at(*UNDER_WAY)
            if member.flight is not None
        ]

    def from_here(self, member: ReturningVehicle) -> ReturnFlight | None:
        """The flight from where the vehicle has drifted to since its plan; None if too far."""
        assert member.flight is not None
        start_m, place_m = member.flight.start_m, self._place_m(member)
        if dist(start_m, place_m) > self._settings.moved_m:
            return None
        return replace(
            member.flight, start_m=place_m, path_m=(place_m[:2], *member.flight.path_m[1:])
        )

    def hindrance(self, flight: ReturnFlight, running: FleetReturn) -> str | None:
        """Why a flight whose layer is free must wait; None if it need not."""
        before: list[Claim] = []
        for member in _waiting_in_turn(running):
            if member.serial == flight.serial:
                break
            if member.flight is not None:
                before.append(whole_claim(member.flight))
        not_hovering = self._moving | {flight.serial}
        hovering = [other for key, other in self._flying.items() if key not in not_hovering]
        return hindrance(flight, before, self._under_way, hovering, self._separation)

    def _place_m(self, member: ReturningVehicle) -> Place:
        """Its last known position; without one it may be anywhere on its path, and counts as at
        its start."""
        assert member.flight is not None
        known = self._flying.get(member.serial)
        return member.flight.start_m if known is None else known.place_m


def _replanned_if_stuck(running: FleetReturn, settings: ReturnSettings, now_ns: int) -> FleetReturn:
    """Have all that wait planned again if nothing that they wait for will end without a command.

    That is so when a vehicle hovers where none did when the plan was made.
    """
    waiting = running.at(Stage.WAITING)
    is_patient = any(member.clears or now_ns < member.judge_at_ns for member in waiting)
    if not waiting or is_patient or running.at(*UNDER_WAY):
        return running
    for member in waiting:
        running = running.put(replace(member, flight=None))
    return replace(running, step_due_ns=now_ns + seconds_to_ns(settings.planned_again_s))


def _vehicle_on_pad(
    running: FleetReturn, flight: ReturnFlight, settings: ReturnSettings, now_ns: int
) -> str | None:
    """The vehicle that landed on this pad and might still be there when this one arrives."""
    arrives_ns = now_ns + seconds_to_ns(least_time_s(flight, settings.plan))
    clearing_ns = seconds_to_ns(settings.pad_clearing_s)
    for other in running.at(Stage.LANDED):
        if other.flight is None or arrives_ns - other.since_ns >= clearing_ns:
            continue
        if is_same_pad(other.flight.pad, flight.pad, settings):
            return other.name
    return None


def _order_mission(
    station: Station,
    running: FleetReturn,
    member: ReturningVehicle,
    flight: ReturnFlight,
    settings: ReturnSettings,
    now_ns: int,
) -> Stepped:
    """Order the mission if the gate approves it; wait while its refusal may end with time."""
    speed_mps = station.airspace.airspace.limits.max_speed_mps
    mission = mission_of(flight, running.frame, flight.start_m, settings.plan, speed_mps)
    vehicle = station.fleet.vehicles[member.serial]
    order = OperatorOrder(
        0,
        body_for(vehicle, mission),
        f"{member.by}: fleet return",
        serial=member.serial,
        role=member.role,
        person=member.person,
    )
    command = command_of(station, order, now_ns)
    refusal = judge(command, situation(station, command, now_ns))
    if refusal is not None and _may_end(running, member, refusal, settings, now_ns):
        since_ns = now_ns if member.refused_since_ns is None else member.refused_since_ns
        waits = replace(
            member.waits_for(f"refused for now: {refusal.reason}"),
            judge_at_ns=now_ns + seconds_to_ns(settings.judged_again_s),
            refused_since_ns=since_ns,
        )
        return replace(station, fleet_return=running.put(waits)), ()
    station, number = take_id(station)
    given = replace(member.at(Stage.ORDERED, now_ns), flight=flight, mission_id=number)
    station = replace(station, fleet_return=running.put(given))
    return order_gateway.submit(station, replace(order, command_id=number), now_ns)


def _may_end(
    running: FleetReturn,
    member: ReturningVehicle,
    refusal: Refusal,
    settings: ReturnSettings,
    now_ns: int,
) -> bool:
    if refusal.rule not in WAITING_RULES:
        return False
    if running.at(*UNDER_WAY) or member.refused_since_ns is None:
        return True
    if member.role is AuthorityHolder.GUIDANCE:
        return True  # other vehicles may fly rows for minutes; the battery rule ends its waiting
    return now_ns - member.refused_since_ns < seconds_to_ns(settings.gate_waits_s)
