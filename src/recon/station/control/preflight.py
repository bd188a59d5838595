"""Facts for the preflight checklist, and overrides of it.

The only writer of `VehicleControl.preflight_override`.
"""

from dataclasses import replace
from math import ceil

from recon.model.command import Refusal
from recon.model.event import ClockRead, PreflightOverridden
from recon.model.survey import CellState
from recon.model.vehicle import VehicleState
from recon.safety import Override
from recon.safety.situation import ClockReading, PlannedFlights, StationFacts
from recon.station.state.station import Clock, Station

RULE = "preflight_override"
LONGEST_REASON = 500


def read_clock(station: Station, event: ClockRead, now_ns: int) -> Station:
    """Return the station after the computer's clock was read."""
    ahead_ns = event.wall_ns - now_ns
    at_start_ns = ahead_ns if station.clock is None else station.clock.ahead_at_start_ns
    return replace(station, clock=Clock(event.wall_ns, ahead_ns, at_start_ns))


def facts(station: Station, vehicle: VehicleState | None) -> StationFacts:
    """Return what a vehicle's checklist needs besides its own state."""
    clock = station.clock
    return StationFacts(
        clock=None if clock is None else ClockReading(clock.wall_ns, clock.set_by_ns),
        others=tuple(
            other
            for other in station.fleet.vehicles.values()
            if vehicle is None or other.serial != vehicle.serial
            if other.link_id is not None or other.is_flying.value is not False
        ),
        app_warnings=() if vehicle is None else _app_warnings(station, vehicle),
        planned=PlannedFlights() if vehicle is None else _planned(station, vehicle),
    )


def _planned(station: Station, vehicle: VehicleState) -> PlannedFlights:
    """Return what a vehicle's running survey takes yet, for apps that report what they have."""
    record = station.surveys.running_with(vehicle.serial or "")
    if record is None or record.state is None or not vehicle.app_facts.is_known():
        return PlannedFlights()
    state, plan = record.state, record.state.plan
    is_open = plan.cells.is_reached & (state.progress.state == CellState.NOT_YET)
    each_m2 = plan.lattice.spacing_m * plan.swath.photo_m
    photos = ceil(plan.cells.area_m2(is_open) / each_m2 / max(1, len(record.members)))
    return PlannedFlights(None if plan.terrain is not None else plan.survey.height_m, photos)


def refusal(station: Station, event: PreflightOverridden) -> Refusal | None:
    """Return why a checklist cannot be overridden like this, else None."""
    if event.serial not in station.fleet.vehicles:
        return Refusal(RULE, f"{event.serial} is unknown: no app has reported this serial")
    if not event.reason.strip():
        return Refusal(RULE, "an override needs a reason: it is logged")
    if len(event.reason) > LONGEST_REASON:
        return Refusal(
            RULE,
            f"the reason must have at most {LONGEST_REASON} characters; got {len(event.reason)}",
        )
    return None


def override(station: Station, event: PreflightOverridden, now_ns: int) -> Station:
    """Return the station with a vehicle's checklist overridden, unless that is refused."""
    if refusal(station, event) is not None:
        return station
    given = Override(event.by, event.reason.strip(), now_ns)
    return station.with_control(event.serial, preflight_override=given)


def after_packet(before: Station, after: Station, link_id: int) -> Station:
    """Return the station after a packet: a landing ends the vehicle's override."""
    vehicle = after.fleet.vehicle_of_link(link_id)
    if vehicle is None or vehicle.serial is None:
        return after
    if after.control(vehicle.serial).preflight_override is None:
        return after
    was = before.fleet.vehicles.get(vehicle.serial)
    was_up = was is None or was.is_flying.value is not False
    if not was_up or vehicle.is_flying.value is not False:
        return after
    return after.with_control(vehicle.serial, preflight_override=None)


def _app_warnings(station: Station, vehicle: VehicleState) -> tuple[str, ...]:
    """Warnings and errors of its app that are not acknowledged."""
    return tuple(
        alarm.condition.text
        for alarm in station.alarms.alarms.values()
        if alarm.condition.rule == "app_message"
        and alarm.condition.serial == vehicle.serial
        and alarm.acknowledged_by is None
    )
