"""Which vehicles of a survey can fly for it now, for how long, and where none can."""

from collections.abc import Iterator
from dataclasses import replace

from recon.fleet.state import staleness
from recon.guidance.survey import ClosedArea, Surveyor
from recon.guidance.survey.settings import DEFAULT as SURVEY_DEFAULT
from recon.model.command import Phase
from recon.model.control import AuthorityHolder
from recon.model.vehicle import Staleness, VehicleState
from recon.safety.airspace import PreparedAirspace
from recon.safety.datum import frame_for, home_enu_m, takeoff_up_m, vehicle_enu_m
from recon.safety.energy import consumption, fraction_to_get_home
from recon.safety.separation_minima import gate_minima
from recon.safety.settings import EnergySettings
from recon.station.operations.motion_orders import mission_end_text
from recon.station.state.orders import OrderRecord
from recon.station.state.station import Station
from recon.station.state.survey_record import SurveyMember, SurveyRecord
from recon.station.traffic.known_traffic import hazard

CLOSED_SLACK_M = 5.0
"""The gate's trajectories are wider than a row: GNSS, and drift since the last position."""

NO_TAKEOFF_HEIGHT = (
    "the height of its takeoff point is unknown: its takeoff was not observed, or was outside the "
    "site's elevation model; let it take off from a pad of the site"
)


def available_vehicles(station: Station, record: SurveyRecord, now_ns: int) -> Iterator[Surveyor]:
    """Yield the survey's vehicles with a known position, as its planner needs them."""
    for member in record.members.values():
        vehicle = station.fleet.vehicles.get(member.serial)
        if vehicle is None:
            continue
        place_m = vehicle_enu_m(station.airspace, vehicle)
        if place_m is None:
            continue
        home_m = home_enu_m(station.airspace, vehicle)
        energy = station.settings.safety.energy
        has = vehicle.battery_fraction.value
        takes = fraction_to_get_home(vehicle, station.airspace, energy)
        yield Surveyor(
            serial=member.serial,
            place_m=(float(place_m[0]), float(place_m[1])),
            is_available=hindrance(station, member, now_ns) is None,
            ended_mission=member.number - is_flown(station, member),
            time_left_s=time_left_s(vehicle, station.airspace, energy),
            keeps_battery=None if has is None or takes is None else may_stay(station, has - takes),
            home_m=None if home_m is None else (float(home_m[0]), float(home_m[1])),
            is_flying=vehicle.is_flying.value is True,
            height_above_takeoff_m=vehicle.height_above_takeoff_m.value,
            takeoff_up_m=takeoff_up_m(station.airspace, vehicle),
            extra_corner_s=0.0 if vehicle.flies_missions else SURVEY_DEFAULT.steered_corner_s,
        )


def may_stay(station: Station, fraction: float) -> bool:
    """Return whether a battery that is this full after a landing need not be changed."""
    reserve = station.airspace.airspace.limits.battery_reserve_fraction
    least = reserve + SURVEY_DEFAULT.battery_kept_above_reserve
    return fraction >= max(SURVEY_DEFAULT.battery_kept_fraction, least)


def closed_areas(station: Station, now_ns: int) -> Iterator[ClosedArea]:
    """Yield where vehicles without telemetry may be, as large as the gate will take it to be."""
    limits, settings = station.airspace.airspace.limits, station.settings.safety
    room_m = gate_minima(limits, settings).horizontal_m + CLOSED_SLACK_M
    for vehicle in (*station.fleet.vehicles.values(), *station.watchdog_state.lost.values()):
        found = hazard(station, vehicle, now_ns)
        if found is not None:
            yield ClosedArea(
                name=found.name,
                serial=vehicle.serial,
                place_m=(found.east_m, found.north_m),
                radius_m=found.largest_m + room_m,
                home_m=found.home_m,
                corridor_half_m=found.corridor_half_m + room_m,
                lost_s=found.age_s,
            )


def hindrance(station: Station, member: SurveyMember, now_ns: int) -> str | None:
    """Return why a vehicle cannot fly for its survey now; None if it can or does."""
    if member.stop_reason is not None:
        return member.stop_reason
    if member.return_reason is not None:
        verb = "has returned home" if is_on_ground(station, member) else "was recalled"
        return f"it {verb}: {member.return_reason}"
    authority = station.control(member.serial).authority
    if authority.holder is not AuthorityHolder.GUIDANCE:
        return f"it is controlled by the {authority.holder.value} ({authority.reason})"
    vehicle = station.fleet.vehicles.get(member.serial)
    if vehicle is None or frame_for(station.airspace, vehicle) is None:
        return "its position is unknown"
    if is_flown(station, member):
        return None
    if staleness(vehicle, now_ns) is not Staleness.LIVE:
        return "no telemetry now"
    if takeoff_up_m(station.airspace, vehicle) is None:
        return NO_TAKEOFF_HEIGHT
    if vehicle.is_flying.value is not True and not member.may_take_off:
        return "it is on the ground; takeoff was not allowed"
    return None


def is_on_ground(station: Station, member: SurveyMember) -> bool:
    """Return whether telemetry shows a vehicle on the ground."""
    vehicle = station.fleet.vehicles.get(member.serial)
    return vehicle is not None and vehicle.is_flying.value is False


def takes_off_automatically(station: Station, record: SurveyRecord, member: SurveyMember) -> bool:
    """Return whether a vehicle on the ground takes off as soon as there are rows for it."""
    is_guided = station.control(member.serial).authority.holder is AuthorityHolder.GUIDANCE
    is_ready = member.may_take_off and member.stop_reason is None and member.return_reason is None
    return record.is_running and is_ready and is_guided and is_on_ground(station, member)


def is_flown(station: Station, member: SurveyMember) -> bool:
    """Return whether the vehicle's newest mission of its survey has not ended."""
    order = _order(station, member)
    return order is not None and not order.phase.is_final


def after_mission(
    station: Station, member: SurveyMember
) -> tuple[SurveyMember, OrderRecord | None]:
    """Return the vehicle, stopped if its mission ended unfinished, and that mission's order.

    Such a mission is not flown again automatically: an operator must check and start it again.
    """
    order, unsent_since_ns = _order(station, member), member.unsent_since_ns
    sent_at_ns = None if order is None else order.left_at_ns
    if unsent_since_ns is not None and sent_at_ns is not None and sent_at_ns >= unsent_since_ns:
        member = replace(member, unsent_since_ns=None)
    if order is None or member.stop_reason is not None or not order.phase.is_final:
        return member, None
    if order.phase is Phase.DONE:
        return member, None
    return replace(member, stop_reason=mission_end_text(station, order)), order


def time_left_s(
    vehicle: VehicleState, airspace: PreparedAirspace, energy: EnergySettings
) -> float | None:
    """Return how long a vehicle can fly level and still land with the reserve; None: unknown.

    The planner adds the flights there and home; the gate judges all of it, more strictly.
    """
    uses = consumption(vehicle, airspace, energy)
    has, height_m = vehicle.battery_fraction.value, vehicle.height_above_takeoff_m.value
    if uses is None or has is None or height_m is None:
        return None
    reserve = airspace.airspace.limits.battery_reserve_fraction
    return uses.level_flight_s(has, height_m, reserve)


def _order(station: Station, member: SurveyMember) -> OrderRecord | None:
    if member.command_id is None:
        return None
    return station.orders.records.get(member.command_id)
