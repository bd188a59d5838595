"""Identity grace: links that have not yet reported a serial; usually a known vehicle reconnecting.

An app reports its serial (extended telemetry) about a second after its first core telemetry. Until
then its vehicle exists twice: as an unidentified link, and as the hazard area of a vehicle whose
telemetry is lost. After a restart that is so for every vehicle in the air. Without a grace period
the watchdogs would find each vehicle too near to itself. So a vehicle is excluded from their
picture:

- *unidentified link*: from its first flying telemetry without a serial, for `serial_wait_s`; then
  it counts as a vehicle of its own, with an alarm.
- *restored vehicle*: one that flew when the last run ended, until it is connected again, for
  `settle_s` after the restart at most; then its hazard area counts.
- *lost unidentified vehicle* (no link at all): likewise for `settle_s` after a restart.

The gate makes no such exception: for an order all of them are traffic. A link that ends without a
serial leaves a lost vehicle behind, unless an identified vehicle was at that very place and time.
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
"""Two aircraft this near would collide: it is one, reported on two connections of its phone."""


def is_identified_elsewhere(station: Station, unidentified: VehicleState) -> bool:
    """Return whether an identified vehicle was where an unidentified one was, at that time."""
    return any(_is_same(unidentified, vehicle) for vehicle in station.fleet.vehicles.values())


def _is_same(unidentified: VehicleState, vehicle: VehicleState) -> bool:
    """Whether both are one aircraft; in doubt they are not."""
    here, there = unidentified.position.value, vehicle.position.value
    high_m, other_m = (
        unidentified.height_above_takeoff_m.value,
        vehicle.height_above_takeoff_m.value,
    )
    received_ns, other_ns = unidentified.core_received_at_ns, vehicle.core_received_at_ns
    velocity = vehicle.velocity_ned.value
    if here is None or there is None or high_m is None or other_m is None or velocity is None:
        return False
    if received_ns is None or other_ns is None or vehicle.is_flying.value is not True:
        return False
    between_s = abs(received_ns - other_ns) / NS_PER_S
    flown_m = hypot(velocity.north_mps, velocity.east_mps) * between_s
    climbed_m = abs(velocity.down_mps) * between_s
    return (
        between_s <= SAME_TIME_S
        and horizontal_distance_m(here, there) <= SAME_PLACE_M + flown_m
        and abs(high_m - other_m) <= SAME_HEIGHT_M + climbed_m
    )


def is_settling(station: Station, now_ns: int) -> bool:
    """Return whether the station restarted so recently that apps are still reconnecting."""
    restored_at_ns = station.restored_at_ns
    settle_ns = seconds_to_ns(station.settings.restart.settle_s)
    return restored_at_ns is not None and now_ns - restored_at_ns < settle_ns


def awaited(station: Station, now_ns: int) -> tuple[VehicleState, ...]:
    """Return the vehicles that flew before a recent restart and have not reconnected yet."""
    if not is_settling(station, now_ns):
        return ()
    vehicles = station.fleet.vehicles
    return tuple(
        vehicles[serial]
        for serial, control in station.controls.items()
        if control.restored is not None and serial in vehicles
    )


def is_in_grace(station: Station, vehicle: VehicleState, now_ns: int) -> bool:
    """Return whether the watchdogs leave a vehicle out: it may soon turn out to be another."""
    if vehicle.serial is not None:
        is_restored = station.control(vehicle.serial).restored is not None
        return is_restored and is_settling(station, now_ns)
    if vehicle.link_id is None:
        return is_settling(station, now_ns)
    return may_yet_report_serial(station, vehicle, now_ns)


def with_unidentified(station: Station, now_ns: int) -> Station:
    """Note since when each link has flown without a serial."""
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


def may_yet_report_serial(station: Station, vehicle: VehicleState, now_ns: int) -> bool:
    """Return whether a vehicle has no serial and has not had the time to report it."""
    since_ns = station.watchdog_state.unidentified_since_ns.get(vehicle.link_id or -1)
    wait_ns = seconds_to_ns(station.settings.serial_wait_s)
    return vehicle.serial is None and since_ns is not None and now_ns - since_ns < wait_ns
