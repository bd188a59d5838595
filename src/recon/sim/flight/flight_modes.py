"""The modes of the flight controller: each turns the aircraft's motion into a velocity demand.

Theory of operation
-------------------
A mode object lives while the mode is flown, and may keep timers. Each tick the aircraft calls
`demand`, moves, and then calls `successor`: None keeps the mode, anything else replaces it.

    Grounded --(command)--> TakeOff --(1.1 m reached)--> PositionHold | MissionFlight | GoHome
    PositionHold, Stick, BackAndForth: stay until commanded otherwise
    GoHome --(above home and at rest, 2 s at least)--> Land
    MissionFlight --(last waypoint)--> PositionHold | Land
    Land --(0.3 m, confirmed, touchdown)--> Grounded

Land reports AUTO_LANDING, and CONFIRM_LANDING while it waits at 0.3 m: DJI's firmware stops there
until the app confirms. A virtual stick outlives its timeout: its velocity becomes zero, and the
mode stays JOYSTICK, as with DJI's SDK. Arrival is judged by position and speed together, so that a
mode does not end while the aircraft shoots past its target.
"""

from dataclasses import dataclass, field
from math import atan2, cos, degrees, hypot, radians, sin
from typing import Protocol

from recon.model.vehicle import FlightMode
from recon.sim.flight.kinematics import (
    BRAKING_MPS2,
    AircraftMotion,
    Limits,
    VelocityDemand,
    braking_speed_mps,
    hold_height_mps,
)

TAKEOFF_HEIGHT_M = 1.2
SPIN_UP_S = 1.5
CONFIRM_HEIGHT_M = 0.3
"""DJI's firmware stops here until the app confirms that the ground is fit to land on."""

AT_REST_BELOW_MPS = 0.05
HEIGHT_GAIN_PER_S = 0.5
HOLD_MPS = 1.0
"""Fastest climb or descent back to the height that is held."""

SHORTEST_GO_HOME_S = 2.0
"""The mode lasts this long even above home, so that telemetry at 2 Hz reports it."""

LANDING_FAST_MPS = 3.0
LANDING_SLOW_MPS = 0.8
LANDING_SLOW_BELOW_M = 6.0


class ActiveMode(Protocol):
    """A flight mode being flown."""

    @property
    def mode(self) -> FlightMode:
        """The flight mode that telemetry reports."""
        ...

    def demand(self, motion: AircraftMotion, seconds: float) -> VelocityDemand:
        """Return the velocity demand for the next `seconds`."""
        ...

    def successor(self, motion: AircraftMotion) -> "ActiveMode | None":
        """Return the next mode when this one is complete, else None."""
        ...


@dataclass(slots=True)
class Grounded:
    """Mode on the ground with the motors off."""

    mode: FlightMode = FlightMode.GPS_ATTI

    def demand(self, motion: AircraftMotion, seconds: float) -> VelocityDemand:
        """Return zero velocity."""
        return VelocityDemand()

    def successor(self, motion: AircraftMotion) -> ActiveMode | None:
        """Stay until commanded otherwise."""
        return None


class Crashed(Grounded):
    """Fallen: on the ground, and nothing it is sent makes it take off again."""


@dataclass(slots=True)
class PositionHold:
    """Brake, then hover at the height reached (DJI's position mode)."""

    mode: FlightMode = FlightMode.GPS_ATTI
    _height_m: float | None = None

    def demand(self, motion: AircraftMotion, seconds: float) -> VelocityDemand:
        """Return zero velocity, but for what keeps the height."""
        if self._height_m is None:
            if abs(motion.velocity_up_mps) < AT_REST_BELOW_MPS:
                self._height_m = motion.height_m
            return VelocityDemand()
        up_mps = HEIGHT_GAIN_PER_S * (self._height_m - motion.height_m)
        return VelocityDemand(velocity_up_mps=max(-HOLD_MPS, min(up_mps, HOLD_MPS)))

    def successor(self, motion: AircraftMotion) -> ActiveMode | None:
        """Stay until commanded otherwise."""
        return None


@dataclass(slots=True)
class TakeOff:
    """Start the motors, climb to takeoff height, continue with `then`."""

    limits: Limits
    then: ActiveMode = field(default_factory=PositionHold)
    mode: FlightMode = FlightMode.AUTO_TAKEOFF
    _elapsed_s: float = 0.0

    def demand(self, motion: AircraftMotion, seconds: float) -> VelocityDemand:
        """Climb once the motors have spun up."""
        self._elapsed_s += seconds
        if self._elapsed_s < SPIN_UP_S:
            return VelocityDemand()
        return VelocityDemand(
            velocity_up_mps=hold_height_mps(motion.height_m, TAKEOFF_HEIGHT_M, self.limits)
        )

    def successor(self, motion: AircraftMotion) -> ActiveMode | None:
        """Continue once the height is reached."""
        return self.then if motion.height_m > TAKEOFF_HEIGHT_M - 0.1 else None


@dataclass(slots=True)
class Land:
    """Descend, wait at 0.3 m for the app's confirmation, touch down."""

    confirmation_s: float = 1.0
    _waited_s: float = 0.0

    @property
    def mode(self) -> FlightMode:
        """AUTO_LANDING on the way, CONFIRM_LANDING while waiting."""
        waiting = 0.0 < self._waited_s < self.confirmation_s
        return FlightMode.CONFIRM_LANDING if waiting else FlightMode.AUTO_LANDING

    def demand(self, motion: AircraftMotion, seconds: float) -> VelocityDemand:
        """Stop horizontally, then descend straight down."""
        # Descend only at rest, so that it lands where the command found it.
        if motion.ground_speed_mps > 0.5:
            return VelocityDemand()
        if self._waited_s >= self.confirmation_s:
            return VelocityDemand(velocity_up_mps=-LANDING_SLOW_MPS)
        if motion.height_m <= CONFIRM_HEIGHT_M + 0.05:
            self._waited_s += seconds
            return VelocityDemand()
        # Slow down over the last half metre, so that braking ends at 0.3 m and not below.
        above_m = motion.height_m - CONFIRM_HEIGHT_M
        fast = LANDING_SLOW_MPS if motion.height_m < LANDING_SLOW_BELOW_M else LANDING_FAST_MPS
        return VelocityDemand(velocity_up_mps=-min(fast, 0.1 + braking_speed_mps(above_m, 0.8)))

    def successor(self, motion: AircraftMotion) -> ActiveMode | None:
        """Stop the motors on the ground."""
        return Grounded() if motion.height_m <= 0.0 else None


@dataclass(slots=True)
class GoHome:
    """Climb to the go-home height unless already higher, fly home, land."""

    home_north_m: float
    home_east_m: float
    go_home_height_m: float
    limits: Limits
    speed_mps: float = 10.0
    confirmation_s: float = 1.0
    mode: FlightMode = FlightMode.GO_HOME
    _height_m: float | None = None
    _elapsed_s: float = 0.0

    def demand(self, motion: AircraftMotion, seconds: float) -> VelocityDemand:
        """Climb first, then fly home."""
        self._elapsed_s += seconds
        if self._height_m is None:
            # Decided once: a descent later must not restart the climb.
            self._height_m = max(self.go_home_height_m, motion.height_m)
        up = hold_height_mps(motion.height_m, self._height_m, self.limits)
        if motion.height_m < self._height_m - 1.0:
            return VelocityDemand(velocity_up_mps=up)
        return _towards(motion, self.home_north_m, self.home_east_m, self.speed_mps, up)

    def successor(self, motion: AircraftMotion) -> ActiveMode | None:
        """Land once above home."""
        if self._height_m is None or motion.height_m < self._height_m - 1.0:
            return None
        distance_m = hypot(self.home_north_m - motion.north_m, self.home_east_m - motion.east_m)
        arrived = distance_m < 0.5 and motion.ground_speed_mps < 0.5
        arrived = arrived and self._elapsed_s >= SHORTEST_GO_HOME_S
        return Land(self.confirmation_s) if arrived else None


@dataclass(slots=True)
class Stick:
    """Virtual stick: velocities for at most `timeout_s`, heading and height held (ICD 3.2.4)."""

    is_body_frame: bool
    yaw_deg: float
    velocity_x_mps: float
    velocity_y_mps: float
    height_m: float
    timeout_s: float
    limits: Limits
    drift_north_mps: float = 0.0
    drift_east_mps: float = 0.0
    mode: FlightMode = FlightMode.JOYSTICK
    _elapsed_s: float = 0.0

    def demand(self, motion: AircraftMotion, seconds: float) -> VelocityDemand:
        """Return the stick's velocity; after the timeout zero, heading and height still held."""
        self._elapsed_s += seconds
        x, y = self.velocity_x_mps, self.velocity_y_mps
        if self._elapsed_s > self.timeout_s:
            x = y = 0.0
        north, east = (x, y) if not self.is_body_frame else _from_body(x, y, motion.yaw_deg)
        up = hold_height_mps(motion.height_m, self.height_m, self.limits)
        north, east = north + self.drift_north_mps, east + self.drift_east_mps
        return VelocityDemand(north, east, up, self.yaw_deg)

    def successor(self, motion: AircraftMotion) -> ActiveMode | None:
        """Stay in this mode until commanded otherwise."""
        return None


@dataclass(slots=True)
class BackAndForth:
    """Fly a back-and-forth pattern endlessly, in position mode, as a pilot would."""

    corners_m: tuple[tuple[float, float], ...]
    height_m: float
    speed_mps: float
    limits: Limits
    mode: FlightMode = FlightMode.GPS_ATTI
    _next: int = 0

    def demand(self, motion: AircraftMotion, seconds: float) -> VelocityDemand:
        """Fly to the next corner, once half the height is reached."""
        up = hold_height_mps(motion.height_m, self.height_m, self.limits)
        if motion.height_m < 0.5 * self.height_m:
            return VelocityDemand(velocity_up_mps=up)
        north_m, east_m = self.corners_m[self._next]
        if hypot(north_m - motion.north_m, east_m - motion.east_m) < 2.0:
            self._next = (self._next + 1) % len(self.corners_m)
        return _towards(motion, north_m, east_m, self.speed_mps, up)

    def successor(self, motion: AircraftMotion) -> ActiveMode | None:
        """Stay until commanded otherwise."""
        return None


def heading_deg(north_m: float, east_m: float) -> float:
    """Return the compass heading, in degrees, of a horizontal vector."""
    return degrees(atan2(east_m, north_m))


def _from_body(forward: float, right: float, yaw_deg: float) -> tuple[float, float]:
    heading = radians(yaw_deg)
    return (
        forward * cos(heading) - right * sin(heading),
        forward * sin(heading) + right * cos(heading),
    )


def _towards(
    motion: AircraftMotion, north_m: float, east_m: float, speed_mps: float, up_mps: float
) -> VelocityDemand:
    """Return the demand that flies level to a point, nose forward, and stops there."""
    north, east = north_m - motion.north_m, east_m - motion.east_m
    distance = hypot(north, east)
    if distance < 1e-6:
        return VelocityDemand(velocity_up_mps=up_mps)
    share = min(speed_mps, braking_speed_mps(distance, BRAKING_MPS2)) / distance
    # Near the target the bearing is noise: keep the heading.
    yaw = heading_deg(north, east) if distance > 3.0 else None
    return VelocityDemand(north * share, east * share, up_mps, yaw)
