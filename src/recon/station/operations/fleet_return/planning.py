"""The worker plans the fleet return: for a large fleet that takes longer than a step may."""

from dataclasses import dataclass, replace

from recon.guidance.fleet_return import (
    CalledVehicle,
    Hovering,
    ReturnPlan,
    Separation,
    plan_return,
    way_home,
)
from recon.model.airspace import Airspace
from recon.model.units import seconds_to_ns
from recon.station.operations.fleet_return import positions
from recon.station.operations.settings import ReturnSettings
from recon.station.state.fleet_return_record import UNDER_WAY, FleetReturn, ReturningVehicle, Stage
from recon.station.state.station import Station
from recon.station.state.steps import Job, JobKind, Output, Stepped


@dataclass(frozen=True, slots=True, eq=False)
class ReturnPlanRequest:
    """All that a plan needs. `ground_up_m`: the lowest and the highest ground on the paths."""

    vehicles: tuple[CalledVehicle, ...]
    others: tuple[Hovering, ...]
    airspace: Airspace
    ground_up_m: tuple[float, float]
    separation: Separation
    settings: ReturnSettings
    first_wave: int


def make_plan(work: ReturnPlanRequest) -> ReturnPlan:
    """Return the plan: the worker's part."""
    spots = [v.place_m[:2] for v in work.vehicles]
    spots += [v.pad.east_north_m for v in work.vehicles]
    settings = work.settings.plan
    home = way_home(work.airspace, work.ground_up_m, spots, settings)
    return plan_return(
        work.vehicles,
        home,
        work.separation,
        settings,
        work.others,
        work.first_wave,
    )


def ask(
    station: Station, running: FleetReturn, settings: ReturnSettings, now_ns: int
) -> tuple[FleetReturn, tuple[Output, ...]]:
    """Request a plan for all that wait, unless one is being made; give up one that never comes."""
    if running.planning_since_ns is not None:
        within_s = settings.planned_within_s
        if now_ns - running.planning_since_ns < seconds_to_ns(within_s):
            return running, ()
        return _left_out(running, f"it was not planned within {within_s:g} s", now_ns), ()
    vehicles: list[CalledVehicle] = []
    for member in running.at(Stage.WAITING):
        found = positions.returning(station, member.serial, running.frame)
        if isinstance(found, str):
            running = running.put(member.at(Stage.LEFT_OUT, now_ns, found))
        else:
            vehicles.append(found)
    if not vehicles:
        return running, ()
    work = _work(station, running, vehicles, settings)
    planning = replace(running, planning_since_ns=now_ns)
    return planning, (Job(now_ns, PLAN_RETURN, work),)


def _planned(station: Station, job_id: int, plan: ReturnPlan, now_ns: int) -> Stepped:
    """Give the plan's flights to the vehicles that still wait for it."""
    running = station.fleet_return
    if running is None or running.planning_since_ns != job_id:
        return station, ()
    running = replace(running, planning_since_ns=None, layers_up_m=plan.layers_up_m)
    for flight in plan.flights:
        member = running.members[flight.serial]
        if member.stage is Stage.WAITING:
            running = running.put(replace(member, flight=flight))
    for left in plan.left_out:
        member = running.members[left.serial]
        if member.stage is Stage.WAITING:
            running = running.put(member.at(Stage.LEFT_OUT, now_ns, left.reason))
    turns = tuple(flight.serial for flight in plan.flights)
    return replace(station, fleet_return=replace(running, turns=turns)), ()


def _not_planned(station: Station, job_id: int, error: str, now_ns: int) -> Stepped:
    running = station.fleet_return
    if running is None or running.planning_since_ns != job_id:
        return station, ()
    reason = f"its flight home could not be planned: {error}"
    return replace(station, fleet_return=_left_out(running, reason, now_ns)), ()


def _dropped(station: Station, job_id: int, _now_ns: int) -> Stepped:
    """Request the plan again with the next tick."""
    running = station.fleet_return
    if running is None or running.planning_since_ns != job_id:
        return station, ()
    return replace(station, fleet_return=replace(running, planning_since_ns=None)), ()


PLAN_RETURN: JobKind[ReturnPlanRequest, ReturnPlan] = JobKind(
    "plan_fleet_return", lambda _site: make_plan, _planned, _not_planned, _dropped
)
"""Plans layers, waves and landing missions for all vehicles that wait."""


def _work(
    station: Station, running: FleetReturn, vehicles: list[CalledVehicle], settings: ReturnSettings
) -> ReturnPlanRequest:
    theirs = {member.serial for member in running.at(Stage.WAITING, *UNDER_WAY)}
    flying = positions.in_the_air(station, running.frame)
    return ReturnPlanRequest(
        tuple(vehicles),
        tuple(other for key, other in flying.items() if key not in theirs),
        station.airspace.airspace,
        positions.ground_up_m(station, vehicles),
        positions.separation(station, settings),
        settings,
        1 + max((_wave(member) for member in running.members.values()), default=0),
    )


def _wave(member: ReturningVehicle) -> int:
    """Vehicles whose wave has begun keep it; those that wait are planned again."""
    is_waiting = member.stage is Stage.WAITING
    return 0 if member.flight is None or is_waiting else member.flight.wave


def _left_out(running: FleetReturn, reason: str, now_ns: int) -> FleetReturn:
    for member in running.at(Stage.WAITING):
        if member.flight is None:
            running = running.put(member.at(Stage.LEFT_OUT, now_ns, reason))
    return replace(running, planning_since_ns=None)
