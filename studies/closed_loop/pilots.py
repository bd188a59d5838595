"""Pilots with the controller in hand: they take over, fly somewhere, and let go."""

from dataclasses import dataclass
from math import cos, radians, sin
from random import Random

from recon.model.vehicle import FlightMode
from recon.sim.flight.aircraft import Aircraft
from recon.sim.flight.flight_modes import ActiveMode, PositionHold
from recon.sim.flight.kinematics import AircraftMotion, VelocityDemand

LOWEST_M = 3.0


@dataclass(slots=True)
class PilotFlight:
    """Sticks held for some seconds, then let go; never into the ground."""

    velocity_north_mps: float
    velocity_east_mps: float
    velocity_up_mps: float
    seconds: float
    mode: FlightMode
    _elapsed_s: float = 0.0

    def demand(self, motion: AircraftMotion, seconds: float) -> VelocityDemand:
        """Return the sticks' velocity while they are held."""
        self._elapsed_s += seconds
        if self._elapsed_s > self.seconds:
            return VelocityDemand()
        up_mps = self.velocity_up_mps
        if motion.height_m < LOWEST_M and up_mps < 0.0:
            up_mps = 0.0
        return VelocityDemand(self.velocity_north_mps, self.velocity_east_mps, up_mps)

    def successor(self, motion: AircraftMotion) -> ActiveMode | None:
        """Stay until commanded otherwise."""
        return None


@dataclass(slots=True)
class Pilot:
    """The pilot of one vehicle."""

    rng: Random
    aircraft: Aircraft
    next_s: float
    is_flying: bool = False
    ends_s: float = 0.0
    has_just_taken: bool = False
    """Whether the last thing done was to take over."""

    def act(self, now_s: float) -> str | None:
        """Do what is due; return what, in words."""
        aircraft = self.aircraft
        if self.is_flying and now_s >= self.ends_s:
            self.is_flying = False
            self.next_s = now_s + self.rng.uniform(20.0, 150.0)
            if isinstance(aircraft.active_mode, PilotFlight):
                aircraft.active_mode = PositionHold(aircraft.active_mode.mode)
            aircraft.pilot_releases()
            return "pilot lets go"
        if self.is_flying and aircraft.is_on_ground:
            self.ends_s = now_s
        if now_s < self.next_s:
            return None
        self.next_s = now_s + self.rng.uniform(2.0, 8.0)
        if aircraft.is_on_ground or not aircraft.has_gnss:
            return None
        return self._fly(now_s)

    def _fly(self, now_s: float) -> str:
        aircraft, rng = self.aircraft, self.rng
        self.has_just_taken = not self.is_flying
        if not self.is_flying:
            self.is_flying, self.ends_s = True, now_s + rng.uniform(3.0, 40.0)
            # One in four flies in position mode: no switch shows it, only the motion.
            if rng.random() < 0.75:
                aircraft.pilot_takes()
        mode = FlightMode.GPS_SPORT if aircraft.has_pilot_control else FlightMode.GPS_ATTI
        heading, speed = radians(rng.uniform(0.0, 360.0)), rng.choice((0.0, 2.0, 5.0, 10.0))
        up_mps = rng.choice((0.0, 0.0, 1.5, -2.0))
        aircraft.active_mode = PilotFlight(
            speed * cos(heading), speed * sin(heading), up_mps, rng.uniform(1.0, 8.0), mode
        )
        return f"pilot flies {speed:.0f} m/s, {up_mps:+.1f} m/s up, {mode.name}"
