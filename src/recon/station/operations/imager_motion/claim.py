"""Guidance gets an imaging drone for a motion: from a hover, by the rules of control authority."""

from dataclasses import dataclass

from recon.model.command import Refusal
from recon.model.control import AuthorityHolder
from recon.model.event import AuthorityTaken
from recon.model.failsafe_matrix import Activity
from recon.model.geo import LatLon
from recon.model.vehicle import VehicleState
from recon.station.control import handover
from recon.station.control.stop_latch import RULE as STOP_RULE
from recon.station.failsafe.activity import activity_of
from recon.station.state.station import Station
from recon.station.state.steps import Output
from recon.station.steering.kinematic_state import kinematic_state

NO_IMAGER = "the site has no imaging drone"
RESTING_MPS = 1.0
"""A vehicle slower than this has a place to leave: hovering in gusts it stays below."""


@dataclass(frozen=True, slots=True)
class Claimed:
    """The station with an imaging drone under guidance, and where that hovers."""

    station: Station
    outputs: tuple[Output, ...]
    vehicle: VehicleState
    place: LatLon
    height_above_takeoff_m: float


def claimed(
    station: Station, rule: str, serial: str | None, by: str, person: str, now_ns: int
) -> Claimed | Refusal:
    """Return the station with an imaging drone claimed for a motion, or why it cannot be."""
    if serial is None:
        return Refusal(rule, NO_IMAGER)
    if serial not in station.imaging.imagers:
        known = ", ".join(station.imaging.imagers)
        return Refusal(rule, f"{serial} is no imaging drone of the site: expected {known}")
    vehicle = station.fleet.vehicles.get(serial)
    if vehicle is None:
        return Refusal(rule, f"the imaging drone {serial} is not connected")
    taken = AuthorityTaken(serial, AuthorityHolder.GUIDANCE, by, person)
    why = _hindrance(station, rule, vehicle, now_ns) or handover.refusal(station, taken, now_ns)
    if why is not None:
        return why
    place, height_m = vehicle.position.value, vehicle.height_above_takeoff_m.value
    assert place is not None, "its kinematic state is known"
    assert height_m is not None, "its kinematic state is known"
    station, withdrawn = handover.take(station, taken, now_ns)
    return Claimed(station, withdrawn, vehicle, place, height_m)


def _hindrance(station: Station, rule: str, vehicle: VehicleState, now_ns: int) -> Refusal | None:
    """Why the imaging drone has no place to leave."""
    serial, name = vehicle.serial or "", vehicle.display_name
    if station.is_stopped(serial):
        return Refusal(STOP_RULE, f"{name} is held by an all stop; release its stop first")
    other = station.imager_motions.under_way()
    if other is not None:
        return Refusal(rule, f"{other.name} {other.doing} already")
    if vehicle.is_flying.value is not True:
        return Refusal(rule, f"{name} is not in the air")
    seen = kinematic_state(vehicle, now_ns)
    if seen is None:
        return Refusal(rule, f"{name}: position, velocity, height or heading unknown")
    if seen.speed_mps > RESTING_MPS:
        return Refusal(
            rule,
            f"{name} moves at {seen.speed_mps:.1f} m/s; hold it first: it must be slower than "
            f"{RESTING_MPS:g} m/s",
            parameters={"speed_mps": seen.speed_mps, "max_mps": RESTING_MPS},
        )
    return (
        None if is_at_rest(station, vehicle) else Refusal(rule, f"{name} is moving; hold it first")
    )


def is_at_rest(station: Station, vehicle: VehicleState) -> bool:
    """Whether it holds its position, without an order or by a steered order that has arrived."""
    activity = activity_of(station, vehicle)
    stream = station.control(vehicle.serial).stream
    has_arrived = stream is not None and stream.arrived_at_ns is not None
    return activity is Activity.HOLDING or (activity is Activity.STEERED and has_arrived)
