"""Who has only just come: most likely it is a vehicle that is known already.

An app says its serial a second after its first telemetry. Until then its vehicle is two things
here: a link without a serial, and the hazard area of a vehicle that is not heard. After a restart
every vehicle in the air is. Nothing would be found but that each is near itself.
"""

from dataclasses import replace
from math import hypot

from recon.geo.distance import horizontal_distance_m
from recon.model.units import NS_PER_S, seconds_to_ns
from recon.model.vehicle import VehicleState
from recon.station.state.station import Station

SAME_TIME_S = 1.0
SAME_PLACE_M = 5.0
SAME_HEIGHT_M = 2.0
"""Two aircraft this near would have met: it is one, told by two connections of its phone."""


def is_heard_by_serial(station: Station, unidentified: VehicleState) -> bool:
    """Return whether what a link without a serial told of is heard by its serial at that moment."""
    return any(_is_same(unidentified, vehicle) for vehicle in station.fleet.vehicles.values())


def _is_same(unidentified: VehicleState, vehicle: VehicleState) -> bool:
    """In doubt it is another one."""
    here, there = unidentified.position.value, vehicle.position.value
    high_m, other_m = (
        unidentified.height_above_takeoff_m.value,
        vehicle.height_above_takeoff_m.value,
    )
    heard_ns, other_ns = unidentified.core_received_at_ns, vehicle.core_received_at_ns
    velocity = vehicle.velocity_ned.value
    if here is None or there is None or high_m is None or other_m is None or velocity is None:
        return False
    if heard_ns is None or other_ns is None or vehicle.is_flying.value is not True:
        return False
    between_s = abs(heard_ns - other_ns) / NS_PER_S
    flown_m = hypot(velocity.north_mps, velocity.east_mps) * between_s
    climbed_m = abs(velocity.down_mps) * between_s
    return (
        between_s <= SAME_TIME_S
        and horizontal_distance_m(here, there) <= SAME_PLACE_M + flown_m
        and abs(high_m - other_m) <= SAME_HEIGHT_M + climbed_m
    )


def is_settling(station: Station, now_ns: int) -> bool:
    """Return whether the station was restarted so lately that apps are still coming back."""
    restored_at_ns = station.restored_at_ns
    settle_ns = seconds_to_ns(station.settings.restart.settle_s)
    return restored_at_ns is not None and now_ns - restored_at_ns < settle_ns


def awaited(station: Station, now_ns: int) -> tuple[VehicleState, ...]:
    """Return the vehicles that flew before a restart a moment ago, and are not heard yet."""
    if not is_settling(station, now_ns):
        return ()
    vehicles = station.fleet.vehicles
    return tuple(
        vehicles[serial]
        for serial, control in station.controls.items()
        if control.restored is not None and serial in vehicles
    )


def is_new(station: Station, vehicle: VehicleState, now_ns: int) -> bool:
    """Return whether it is too early to watch a vehicle: by what is heard next, it is another."""
    if vehicle.serial is not None:
        is_restored = station.control(vehicle.serial).restored is not None
        return is_restored and is_settling(station, now_ns)
    if vehicle.link_id is None:
        return is_settling(station, now_ns)
    return may_yet_say_its_serial(station, vehicle, now_ns)


def with_unidentified(station: Station, now_ns: int) -> Station:
    """Return the station that knows since when each link has flown without a serial."""
    before = station.watchdog_state.unidentified_since_ns
    since_ns = {
        link.id: before.get(link.id, now_ns)
        for link in station.fleet.unbound_links()
        if link.claimed_serial is None and link.own_state.is_flying.value is True
    }
    if since_ns == before:
        return station
    return replace(
        station, watchdog_state=replace(station.watchdog_state, unidentified_since_ns=since_ns)
    )


def may_yet_say_its_serial(station: Station, vehicle: VehicleState, now_ns: int) -> bool:
    """Return whether a vehicle has no serial and has not had the time to say it."""
    since_ns = station.watchdog_state.unidentified_since_ns.get(vehicle.link_id or -1)
    wait_ns = seconds_to_ns(station.settings.serial_wait_s)
    return vehicle.serial is None and since_ns is not None and now_ns - since_ns < wait_ns
