"""Flying simulated aircraft and apps by hand."""

from collections.abc import Callable, Iterator
from random import Random

import pytest

from recon import wire
from recon.model.geo import GeoPoint
from recon.model.units import NS_PER_S, seconds_to_ns
from recon.model.vehicle import AltitudeReference
from recon.sim.app.app import AppSettings, SimulatedApp
from recon.sim.app.commands import AppBehaviour, HoverOnGround
from recon.sim.app.faults import InjectedFault
from recon.sim.app.telemetry import position_deg
from recon.sim.flight.aircraft import TICK_NS, Aircraft
from recon.sim.flight.estimate import DriftSettings, EstimateErrors
from recon.sim.flight.flight_modes import Grounded, PositionHold
from recon.sim.flight.kinematics import AircraftMotion

HOME = GeoPoint(41.9, -93.6, 275.0)


class Flights:
    """What several tests do with aircraft."""

    home = HOME

    @staticmethod
    def hovering(height_m: float = 30.0, yaw_deg: float = 0.0, now_ns: int = 0) -> Aircraft:
        """Return an aircraft in hover above its home."""
        motion = AircraftMotion(height_m=height_m, yaw_deg=yaw_deg)
        return Aircraft(now_ns, motion=motion, active_mode=PositionHold())

    @staticmethod
    def fly(aircraft: Aircraft, seconds: float) -> Iterator[AircraftMotion]:
        """Advance tick by tick for a time and yield every motion."""
        end_ns = aircraft.now_ns + seconds_to_ns(seconds)
        while aircraft.now_ns + TICK_NS <= end_ns:
            aircraft.advance(aircraft.now_ns + TICK_NS)
            yield aircraft.motion

    @classmethod
    def fly_on(cls, aircraft: Aircraft, seconds: float) -> AircraftMotion:
        """Advance for a time and return the last motion."""
        return list(cls.fly(aircraft, seconds))[-1]

    @staticmethod
    def fly_until(
        aircraft: Aircraft, done: Callable[[Aircraft], bool], within_s: float = 600.0
    ) -> float:
        """Advance until something is true and return how long it took, in seconds."""
        start_ns = aircraft.now_ns
        while not done(aircraft):
            elapsed_s = (aircraft.now_ns - start_ns) / NS_PER_S
            assert elapsed_s < within_s, f"not done after {elapsed_s} s: {aircraft}"
            aircraft.advance(aircraft.now_ns + TICK_NS)
        return (aircraft.now_ns - start_ns) / NS_PER_S


class AppBench:
    """One app on one link in virtual time: sends commands, keeps every packet that came."""

    def __init__(self, app: SimulatedApp, now_ns: int = 0) -> None:
        self.app = app
        self.now_ns = now_ns
        self.received: list[wire.Packet] = []
        self._deframer = wire.Deframer()
        app.connected(now_ns)

    def run(self, seconds: float, step_s: float = 0.05) -> list[wire.Packet]:
        """Let time pass and return the packets that came meanwhile."""
        before = len(self.received)
        end_ns = self.now_ns + seconds_to_ns(seconds)
        while self.now_ns < end_ns:
            self.now_ns = min(end_ns, self.now_ns + seconds_to_ns(step_s))
            self._take()
        return self.received[before:]

    def send(self, packet: wire.Packet) -> list[wire.Packet]:
        """Pass a command to the app and return the packets it sends at once."""
        before = len(self.received)
        self.app.receive(wire.encode(packet), self.now_ns)
        self._take()
        return self.received[before:]

    def last(self, kind: type) -> wire.Packet:
        """Return the newest packet of a kind."""
        return next(p for p in reversed(self.received) if isinstance(p, kind))

    @property
    def mode(self) -> int:
        """The flight mode reported last."""
        return self.last(wire.ExtendedTelemetry).flight_mode

    def _take(self) -> None:
        for data in self.app.advance(self.now_ns):
            self.received += self._deframer.feed(data, self.now_ns)


@pytest.fixture(scope="session")
def flights() -> type[Flights]:
    """Return what several tests do with aircraft."""
    return Flights


@pytest.fixture(scope="session")
def app_bench() -> Callable[..., AppBench]:
    """Return a maker of a connected app without a camera."""

    def make(
        height_m: float = 30.0,
        reference: AltitudeReference = AltitudeReference.TAKEOFF,
        hover_on_ground: HoverOnGround = HoverOnGround.NOTHING,
        faults: tuple[InjectedFault, ...] = (),
        bias_m: float = -23.0,
        drift: DriftSettings | None = None,
    ) -> AppBench:
        active_mode = Grounded() if height_m == 0.0 else PositionHold()
        motion = AircraftMotion(height_m=height_m)
        errors = EstimateErrors(random=Random(4), settings=drift or DriftSettings())
        aircraft = Aircraft(0, motion=motion, active_mode=active_mode, errors=errors)
        behaviour = AppBehaviour(reference, hover_on_ground, bias_m)
        settings = AppSettings(
            "SIM-7",
            HOME,
            seed=4,
            behaviour=behaviour,
            faults=faults,
        )
        return AppBench(SimulatedApp(settings, aircraft))

    return make


@pytest.fixture(scope="session")
def mission_packet() -> Callable[..., wire.ExecuteWaypointMission]:
    """Return a maker of mission packets from north, east, altitude triples around home."""

    def make(
        points: list[tuple[float, float, float]],
        speed_mps: float = 8.0,
        land_at_end: bool = False,
        loiter_s: float = float("nan"),
        gimbal_deg: float = float("nan"),
        curved: bool = False,
        inner_radius_m: float = 0.2,
    ) -> wire.ExecuteWaypointMission:
        waypoints = []
        for index, (north_m, east_m, altitude_m) in enumerate(points):
            latitude, longitude = position_deg(HOME, north_m, east_m)
            is_end = index in (0, len(points) - 1)
            waypoints.append(
                wire.Waypoint(
                    latitude_deg=latitude,
                    longitude_deg=longitude,
                    altitude_m=altitude_m,
                    corner_radius_m=0.2 if is_end else inner_radius_m,
                    speed_mps=speed_mps,
                    loiter_time_s=loiter_s,
                    gimbal_pitch_deg=gimbal_deg,
                )
            )
        return wire.ExecuteWaypointMission(
            land_at_end=int(land_at_end), curved_flight=int(curved), waypoints=waypoints
        )

    return make
