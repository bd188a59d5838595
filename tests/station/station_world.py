"""A station and simulated apps joined by fake links, in virtual time."""

from collections.abc import Callable
from dataclasses import dataclass, replace

from tests.ready import ready_profile, ready_site

from recon.model.command import Body, Phase
from recon.model.event import OperatorOrder
from recon.model.geo import GeoPoint
from recon.model.mission import Mission, Waypoint
from recon.model.units import NS_PER_S
from recon.model.vehicle import AltitudeReference, VehicleState
from recon.sim.app.app import SimulatedApp
from recon.sim.app.faults import parse_fault
from recon.sim.connected_apps import ConnectedApps
from recon.sim.fake_link import FakeLink
from recon.sim.fleet import Airborne, SimulationConfig, build_fleet
from recon.station.kernel.build import first_state
from recon.station.kernel.virtual import VirtualDriver
from recon.station.state.orders import OrderRecord

HOME = GeoPoint(41.9, -93.6, 275.0)
STEP_S = 0.01


@dataclass(slots=True)
class World(ConnectedApps):
    """A station with its simulated apps; tests command vehicles and read orders by number."""

    _next_order: int = 1

    def vehicle(self, serial: str) -> VehicleState:
        return self.driver.station.fleet.vehicles[serial]

    def app(self, serial: str) -> SimulatedApp:
        return self.connected[serial].app

    def order(self, serial: str, body: Body, *, takeoff: bool = False) -> int:
        order_id = self._next_order
        self._next_order += 1
        self.driver.handle(OperatorOrder(order_id, body, "test", serial=serial, takeoff=takeoff))
        return order_id

    def fails(self, text: str) -> None:
        """A fault of one vehicle begins, its start counted from now."""
        fault = parse_fault(text)
        start_s = self.driver.now_ns / NS_PER_S + fault.start_s
        self.app(fault.vehicle).inject(replace(fault, start_s=start_s))

    def record(self, order_id: int) -> OrderRecord:
        return self.driver.station.orders.records[order_id]

    def phases(self, order_id: int) -> list[Phase]:
        return [change.phase for change in self.record(order_id).history]

    def run_for(self, seconds: float) -> None:
        """Let time pass; what a fault does to a link is late by up to a tenth of a second."""
        whole, rest_s = divmod(round(seconds / STEP_S), 10)
        for _ in range(whole):
            self.advance(10 * STEP_S)
        self.advance(rest_s * STEP_S)

    def run_until(self, is_reached: Callable[[], bool], at_most_s: float) -> bool:
        for _ in range(round(at_most_s * 100)):
            if is_reached():
                return True
            self.advance(STEP_S)
        return is_reached()


def world(
    vehicles: int = 1,
    *,
    faults: tuple[str, ...] = (),
    reference: AltitudeReference = AltitudeReference.TAKEOFF,
    profile_reference: AltitudeReference | None = None,
    airborne: Airborne = Airborne.ALL,
    wanders: bool = False,
    seed: int = 0,
    make_link: Callable[[], FakeLink] = FakeLink,
    keeps_log: bool = True,
    max_waypoints: int = 99,
) -> World:
    """Return a station with connected simulated vehicles SIM-1, SIM-2, ...

    `reference` is what the apps take altitudes for; the site states the same, unless
    `profile_reference` differs.
    """
    believed = profile_reference or reference
    config = SimulationConfig(
        home=HOME,
        vehicle_count=vehicles,
        altitude_reference=reference,
        airborne=airborne,
        wanders=wanders,
        seed=seed,
        faults=tuple(parse_fault(text) for text in faults),
    )
    apps = build_fleet(config, 0)
    profiles = (
        ready_profile(
            app.settings.serial,
            app.settings.home,
            waypoint_altitude=believed,
            go_home_height_m=app.aircraft.settings.go_home_height_m,
            max_waypoints=max_waypoints,
        )
        for app in apps
    )
    site = ready_site(HOME, profiles)
    made = World(VirtualDriver(first_state(site), keeps_log=keeps_log), make_link)
    made.connect_all(apps)
    return made


def from_the_ground(vehicle: VehicleState, flown: Mission) -> Mission:
    """Return the mission with a waypoint right above the vehicle before it: it climbs first."""
    here, first = vehicle.position.value, flown.waypoints[0]
    assert here is not None
    above = replace(first, latitude_deg=here.latitude_deg, longitude_deg=here.longitude_deg)
    return replace(flown, waypoints=(above, *flown.waypoints))


def square_mission(height_m: float = 45.0, side_m: float = 30.0) -> Mission:
    """Return a small square north-east of home."""
    north_deg, east_deg = side_m / 111_000.0, side_m / 82_600.0
    corners = ((0.0, 0.0), (north_deg, 0.0), (north_deg, east_deg), (0.0, east_deg))
    return Mission(
        tuple(
            Waypoint(HOME.latitude_deg + north, HOME.longitude_deg + east, height_m, 5.0)
            for north, east in corners
        )
    )
