"""Every finding of the checklist, whole: `findings.txt` has state, text and what to do about it."""

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

from tests.safety.cases import AIRSPACE, FACTS, TAKEOFF, S, situation, vehicle
from tests.safety.checks.test_go_home import other, zone
from tests.safety.checks.test_place import hilly, pad_at

from recon.model.airspace import FlightLimits
from recon.model.vehicle import (
    BatteryWarning,
    Failsafe,
    FlightMode,
    VehicleProfile,
    VehicleState,
)
from recon.safety import OPEN_AIRSPACE, PreparedAirspace
from recon.safety.check import Check
from recon.safety.checks import aircraft, place, site_facts
from recon.safety.situation import NO_FACTS, ClockReading, Situation

EXPECTED = Path(__file__).with_name("findings.txt")
READY = vehicle()
UNSET = vehicle(VehicleProfile("A"))
STRICT = PreparedAirspace(
    replace(AIRSPACE.airspace, limits=FlightLimits(battery_reserve_fraction=0.4))
)
LOW_CEILING = PreparedAirspace(replace(AIRSPACE.airspace, limits=FlightLimits(50.0)))

TWO_WOODS = PreparedAirspace(
    replace(zone(80.0).airspace, zones=(*zone(80.0).airspace.zones, *zone(70.0).airspace.zones))
)


Case = tuple[Callable[[VehicleState, Situation], Check], VehicleState, dict[str, object]]


def case(
    point: Callable[[VehicleState, Situation], Check], state: VehicleState = READY, **now: object
) -> Case:
    return point, state, now


CASES = [
    case(aircraft.link),
    case(aircraft.link, replace(READY, rival_link_ids=(2,))),
    case(aircraft.link, replace(READY, core_received_at_ns=None)),
    case(aircraft.link, vehicle(age_s=4.0)),
    case(aircraft.battery),
    case(aircraft.battery, vehicle(battery_warning=BatteryWarning.LOW)),
    case(aircraft.battery, vehicle(battery_fraction=None)),
    case(aircraft.battery, vehicle(battery_fraction=0.4), airspace=STRICT),
    case(aircraft.battery, vehicle(battery_fraction=0.45), airspace=STRICT),
    case(aircraft.gnss),
    case(aircraft.gnss, vehicle(flight_mode=FlightMode.ATTI)),
    case(aircraft.wind, vehicle(wind_level=None)),
    case(aircraft.wind, vehicle(wind_level=1)),
    case(aircraft.wind, vehicle(wind_level=2)),
    case(aircraft.app),
    case(aircraft.app, READY, facts=replace(FACTS, app_warnings=("compass error", "storage full"))),
    case(place.fence),
    case(place.fence, READY, airspace=OPEN_AIRSPACE),
    case(place.ground, READY, airspace=hilly()),
    case(place.ground),
    case(place.home_place),
    case(place.home_place, vehicle(takeoff_point=None)),
    case(place.home_place, vehicle(pad_at(), takeoff_point=None)),
    case(place.home_place, vehicle(pad_at(50.0))),
    case(place.pad_altitude),
    case(place.pad_altitude, vehicle(pad_at())),
    case(place.pad_altitude, vehicle(pad_at(80.0, -80.0)), airspace=hilly()),
    case(place.pad_altitude, vehicle(pad_at(altitude_m=250.0)), airspace=hilly()),
    case(place.pad_altitude, vehicle(pad_at(altitude_m=273.0)), airspace=hilly()),
    case(place.clock),
    case(place.clock, READY, facts=NO_FACTS),
    case(place.clock, READY, facts=replace(FACTS, clock=ClockReading(119 * S))),
    case(place.clock, READY, facts=replace(FACTS, clock=ClockReading(1780000000 * S, -3 * S))),
    case(site_facts.altitude_reference),
    case(site_facts.altitude_reference, UNSET),
    case(site_facts.endurance),
    case(site_facts.endurance, vehicle(replace(TAKEOFF, endurance_s=3600.0))),
    case(site_facts.endurance, UNSET),
    case(site_facts.failsafe, vehicle(replace(TAKEOFF, failsafe=Failsafe.HOVER))),
    case(site_facts.failsafe, UNSET),
    case(site_facts.camera_interval),
    case(site_facts.camera_interval, UNSET),
    case(site_facts.go_home_height),
    case(site_facts.go_home_height, UNSET),
    case(site_facts.go_home_height, vehicle(replace(TAKEOFF, go_home_height_m=10.5))),
    case(site_facts.go_home_height, READY, airspace=LOW_CEILING),
    case(site_facts.go_home_height, READY, facts=replace(FACTS, others=(other(62.0, serial="C"),))),
    case(site_facts.go_home_height, READY, airspace=TWO_WOODS),
]


def test_each_is_stated_whole() -> None:
    rows = []
    for point, state, now in CASES:
        found = point(state, replace(situation(state), **now))  # type: ignore[arg-type]
        told = (found.key, found.name, found.state.value, found.text, found.to_do)
        rows.append(" | ".join(told).rstrip())
    assert rows == EXPECTED.read_text(encoding="utf-8").splitlines()
