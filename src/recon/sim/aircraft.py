"""One simulated aircraft: its flight controller's modes, battery, home and gimbal."""

from dataclasses import dataclass, field, replace

from recon.model.units import NS_PER_S
from recon.model.vehicle import FlightMode
from recon.sim.battery import FORCED_LANDING_FRACTION, Battery
from recon.sim.kinematics import Limits, Motion, step
from recon.sim.manoeuvres import GoHome, Grounded, Hold, Land, Manoeuvre, Stick, TakeOff
from recon.sim.mission import Gimbal, MissionFlight, MissionPoint

TICK_NS = 50_000_000
"""Motion advances in steps of 50 ms, so that it does not depend on how often it is asked."""

FLYING_ABOVE_M = 0.02


@dataclass(frozen=True, slots=True)
class AircraftSettings:
    """What is set in an aircraft before the flight."""

    limits: Limits = field(default_factory=Limits)
    go_home_height_m: float = 30.0
    endurance_s: float = 1500.0
    stick_drift_north_mps: float = 0.0
    stick_drift_east_mps: float = 0.0
    """What wind pushes the aircraft past the velocity that a virtual stick asks for. In position
    mode and in missions the flight controller holds against it."""
    landing_confirmation_s: float = 1.0
    """The app confirms a landing this long after the aircraft stopped at 0.3 m."""


@dataclass(slots=True)
class Aircraft:
    """An aircraft in home metres; `now_ns` is how far it has been advanced."""

    now_ns: int
    settings: AircraftSettings = field(default_factory=AircraftSettings)
    motion: Motion = field(default_factory=Motion)
    manoeuvre: Manoeuvre = field(default_factory=Grounded)
    gimbal: Gimbal = field(default_factory=Gimbal)
    battery: Battery = field(default_factory=lambda: Battery(1.0, 1500.0))
    is_pilots: bool = False
    """Whether the pilot's mode switch keeps the app's missions and sticks out."""
    home_north_m: float = 0.0
    home_east_m: float = 0.0
    _mission_count: int = 0

    @property
    def is_on_ground(self) -> bool:
        """Whether the motors are off."""
        return isinstance(self.manoeuvre, Grounded)

    @property
    def is_flying(self) -> bool:
        """What the flight controller says: lifted off, and the motors not stopped since."""
        if isinstance(self.manoeuvre, TakeOff):
            return self.motion.height_m > FLYING_ABOVE_M
        return not self.is_on_ground

    @property
    def flight_mode(self) -> FlightMode:
        """The flight mode."""
        return self.manoeuvre.mode

    @property
    def mission_id(self) -> int:
        """The number of the mission being flown, else 0."""
        return self._mission_count if isinstance(self.manoeuvre, MissionFlight) else 0

    def advance(self, now_ns: int) -> None:
        """Move on in whole ticks, up to `now_ns`."""
        while self.now_ns + TICK_NS <= now_ns:
            self._tick(TICK_NS / NS_PER_S)
            self.now_ns += TICK_NS

    def hover(self) -> None:
        """Stop and hold; on the ground nothing."""
        if not self.is_on_ground:
            self.manoeuvre = Hold()

    def take_off(self, then: Manoeuvre | None = None) -> None:
        """Start from the ground, which is from now on home, and go on with `then`."""
        if self.is_on_ground:
            self._set_home()
            self.manoeuvre = TakeOff(self.settings.limits, then or Hold())
        elif then is not None:
            self.manoeuvre = then

    def land(self) -> None:
        """Land here."""
        if not self.is_on_ground and not isinstance(self.manoeuvre, Land):
            self.manoeuvre = Land(self.settings.landing_confirmation_s)

    def go_home(self) -> None:
        """Return and land; on the ground nothing."""
        if not self.is_on_ground:
            self.manoeuvre = self._way_home()

    def take_off_and_go_home(self) -> None:
        """What some apps make of a return order on the ground."""
        if self.is_on_ground:
            self._set_home()
        self.take_off(self._way_home())

    def fly_mission(
        self, points: tuple[MissionPoint, ...], is_curved: bool, lands_at_end: bool
    ) -> None:
        """Fly a mission in place of whatever is flown now; from the ground take off first.

        While the pilot has it, nothing.
        """
        if self.is_pilots:
            return
        self._mission_count = self._mission_count % 0xFFFF + 1
        settings = self.settings
        flight = MissionFlight(
            points,
            is_curved,
            lands_at_end,
            self.gimbal,
            settings.limits,
            settings.landing_confirmation_s,
        )
        self.take_off(flight)

    def forget_mission_numbers(self) -> None:
        """Count missions from the start again, as an app does that was restarted."""
        self._mission_count = 0

    def stick(self, stick: Stick) -> None:
        """Fly a stick command; on the ground, or while the pilot has it, nothing."""
        if not self.is_on_ground and not self.is_pilots:
            self.manoeuvre = stick

    def pilot_takes(self, mode: FlightMode = FlightMode.GPS_SPORT) -> None:
        """The pilot flips the mode switch, and for now holds."""
        self.is_pilots = True
        if not self.is_on_ground:
            self.manoeuvre = Hold(mode)

    def pilot_gives_back(self) -> None:
        """The pilot flips the mode switch back; the aircraft holds until it is told something."""
        self.is_pilots = False
        if isinstance(self.manoeuvre, Hold):
            self.manoeuvre = Hold()

    def _set_home(self) -> None:
        self.home_north_m, self.home_east_m = self.motion.north_m, self.motion.east_m

    def _way_home(self) -> GoHome:
        return GoHome(
            self.home_north_m,
            self.home_east_m,
            self.settings.go_home_height_m,
            self.settings.limits,
            confirmation_s=self.settings.landing_confirmation_s,
        )

    def _tick(self, seconds: float) -> None:
        if not self.is_on_ground:
            demand = self.manoeuvre.demand(self.motion, seconds)
            self.motion = _kept_above_ground(
                step(self.motion, demand, seconds, self.settings.limits)
            )
            self._go_on()
        self.gimbal.step(seconds)
        self.battery.drain(seconds, self.is_flying, self.motion.ground_speed_mps)
        if self.battery.fraction < FORCED_LANDING_FRACTION:
            self.land()

    def _go_on(self) -> None:
        following = self.manoeuvre.successor(self.motion)
        if following is None:
            return
        self.manoeuvre = following
        if isinstance(following, Grounded):
            self.motion = replace(
                Motion(yaw_deg=self.motion.yaw_deg),
                north_m=self.motion.north_m,
                east_m=self.motion.east_m,
            )


def _kept_above_ground(motion: Motion) -> Motion:
    if motion.height_m >= 0.0:
        return motion
    return replace(
        motion,
        height_m=0.0,
        velocity_north_mps=0.0,
        velocity_east_mps=0.0,
        velocity_up_mps=0.0,
    )
