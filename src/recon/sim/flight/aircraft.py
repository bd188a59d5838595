"""One simulated aircraft: flight controller, battery, home point and gimbal.

Theory of operation
-------------------
The aircraft is always in one `ActiveMode` (`flight_modes`, `mission`). Every 50 ms the mode gives a
velocity demand, wind and limits are applied, kinematics move the aircraft, and the mode may name
its successor: TakeOff -> what follows it, MissionFlight -> PositionHold or Land, GoHome -> Land,
Land -> Grounded. Everything else changes the mode from outside:

- commands of the app (`hover`, `land`, `go_home`, `fly_mission`, `stick`), which are ignored on the
  ground, while the pilot has control, or without GNSS, as each method states;
- the pilot (`pilot_takes`), loss of GNSS (PositionHold in ATTI, drifting with the wind), a crash;
- the battery: below `FORCED_LANDING_FRACTION` the aircraft lands where it is, whatever it flies.

It flies by its own estimate of where it is: GNSS and a barometer that is zeroed at takeoff, with
slow errors of its own. So telemetry shows the height commanded, and the true one is off.
Taking off and landing it flies by the ground it sees.

Home is set at each takeoff. `MissionID` counts missions started, and is 0 while none is flown.
"""

from dataclasses import dataclass, field, replace
from math import hypot

from recon.model.units import NS_PER_S, seconds_to_ns
from recon.model.vehicle import FlightMode
from recon.sim.flight.air import Air
from recon.sim.flight.battery import FORCED_LANDING_FRACTION, GROUND_LOAD, Battery, flying_load
from recon.sim.flight.estimate import EstimateErrors
from recon.sim.flight.flight_modes import (
    ActiveMode,
    Crashed,
    GoHome,
    Grounded,
    Land,
    PositionHold,
    Stick,
    TakeOff,
)
from recon.sim.flight.kinematics import (
    AircraftMotion,
    Limits,
    VelocityDemand,
    hold_height_mps,
    step,
)
from recon.sim.flight.mission import Gimbal, MissionFlight, MissionPoint

TICK_NS = 50_000_000
"""Fixed integration step: the result must not depend on how often `advance` is called."""

FLYING_ABOVE_M = 0.02
AT_LIMIT_WITHIN_M = 0.5
STICK_DRIFT_SHARE = 0.08
"""Share of the wind: under sticks the controller holds a velocity, imperfectly, and no position."""


@dataclass(frozen=True, slots=True)
class AircraftSettings:
    """Settings of an aircraft, made before the flight."""

    limits: Limits = field(default_factory=Limits)
    go_home_height_m: float = 30.0
    endurance_s: float = 1500.0
    stick_drift_north_mps: float = 0.0
    stick_drift_east_mps: float = 0.0
    """Constant velocity error under virtual stick. In position mode and in missions the flight
    controller compensates it."""
    landing_confirmation_s: float = 1.0
    """Delay until the app confirms a landing, after the aircraft stopped at 0.3 m."""
    max_height_m: float = 500.0
    """Height limit above takeoff: the aircraft climbs no higher, and reports reaching it."""
    max_distance_m: float = 5_000.0
    """Distance limit from home: reported when reached; missions that lead farther are rejected."""
    battery_swap_s: float | None = None
    """Time from landing to a full battery; None: batteries are not changed."""
    battery_kept_share: float = 1.0
    """A battery that is this full at landing stays in."""


@dataclass(slots=True)
class Aircraft:
    """An aircraft in home metres; `now_ns` is how far it has been advanced."""

    now_ns: int
    settings: AircraftSettings = field(default_factory=AircraftSettings)
    motion: AircraftMotion = field(default_factory=AircraftMotion)
    active_mode: ActiveMode = field(default_factory=Grounded)
    gimbal: Gimbal = field(default_factory=Gimbal)
    battery: Battery = field(default_factory=lambda: Battery(1.0, 1500.0))
    has_pilot_control: bool = False
    """Whether the pilot has control by the mode switch: missions and sticks are ignored."""
    air: Air = field(default_factory=Air)
    has_gnss: bool = True
    errors: EstimateErrors = field(default_factory=EstimateErrors)
    home_north_m: float = 0.0
    home_east_m: float = 0.0
    _zeroed_at_m: float = 0.0
    """The barometer's error at takeoff."""
    _mission_count: int = 0
    _landed_at_ns: int | None = None
    """Time of the last landing, until its battery is changed."""

    @property
    def estimate(self) -> AircraftMotion:
        """Where it takes itself to be."""
        north_m, east_m, up_m = self.errors.north_east_up_m
        motion = self.motion
        return motion._replace(
            north_m=motion.north_m + north_m,
            east_m=motion.east_m + east_m,
            height_m=motion.height_m + up_m - self._zeroed_at_m,
        )

    @property
    def is_on_ground(self) -> bool:
        """Whether the motors are off."""
        return isinstance(self.active_mode, Grounded)

    @property
    def is_flying(self) -> bool:
        """The flight controller's in-air flag: lifted off, and motors not stopped since."""
        mode = self.active_mode
        if isinstance(mode, TakeOff):
            return self.motion.height_m > FLYING_ABOVE_M
        return not isinstance(mode, Grounded)

    @property
    def has_crashed(self) -> bool:
        """Whether it has fallen: it stays where it lies, whatever its app is sent."""
        return isinstance(self.active_mode, Crashed)

    @property
    def flight_mode(self) -> FlightMode:
        """The flight mode that telemetry reports."""
        return self.active_mode.mode

    @property
    def mission_id(self) -> int:
        """The number of the mission being flown, else 0."""
        return self._mission_count if isinstance(self.active_mode, MissionFlight) else 0

    @property
    def is_at_max_height(self) -> bool:
        """Whether it has reached the height limit of its settings."""
        return self.estimate.height_m >= self.settings.max_height_m - AT_LIMIT_WITHIN_M

    @property
    def is_at_max_distance(self) -> bool:
        """Whether it has reached the distance limit of its settings."""
        here = self.estimate
        away_m = hypot(here.north_m - self.home_north_m, here.east_m - self.home_east_m)
        return away_m >= self.settings.max_distance_m - AT_LIMIT_WITHIN_M

    @property
    def accepts_app_control(self) -> bool:
        """Whether missions and sticks are accepted: GNSS available, pilot not in control."""
        return self.has_gnss and not self.has_pilot_control

    @property
    def next_tick_ns(self) -> int:
        """Return when it moves next; before that `advance` changes nothing."""
        return self.now_ns + TICK_NS

    def advance(self, now_ns: int) -> None:
        """Advance in whole ticks, up to `now_ns`."""
        while self.now_ns + TICK_NS <= now_ns:
            self._tick(TICK_NS / NS_PER_S)
            self.now_ns += TICK_NS

    def hover(self) -> None:
        """Stop and hold; ignored on the ground."""
        if not self.is_on_ground:
            self.active_mode = PositionHold()

    def take_off(self, then: ActiveMode | None = None) -> None:
        """Take off from the ground, which becomes home, and continue with `then`."""
        if self.has_crashed:
            return
        if self.is_on_ground:
            self._set_home()
            self.active_mode = TakeOff(self.settings.limits, then or PositionHold())
        elif then is not None:
            self.active_mode = then

    def land(self) -> None:
        """Land here."""
        if not self.is_on_ground and not isinstance(self.active_mode, Land):
            self.active_mode = Land(self.settings.landing_confirmation_s)

    def go_home(self) -> None:
        """Return and land; ignored on the ground or without GNSS."""
        if not self.is_on_ground and self.has_gnss:
            self.active_mode = self._go_home_mode()

    def take_off_and_go_home(self) -> None:
        """Take off first when on the ground, as some apps do on a return command."""
        if not self.has_gnss:
            return
        if self.is_on_ground:
            self._set_home()
        self.take_off(self._go_home_mode())

    def fly_mission(
        self, points: tuple[MissionPoint, ...], is_curved: bool, lands_at_end: bool
    ) -> None:
        """Fly a mission in place of the current mode; from the ground take off first.

        Ignored while the pilot has control or without GNSS.
        """
        if not self.accepts_app_control:
            return
        # 16 bits on the wire; 0 means no mission, so 65535 is followed by 1.
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
        """Restart mission numbers, as a restarted app does."""
        self._mission_count = 0

    def stick(self, stick: Stick) -> None:
        """Fly a stick command; ignored on the ground, under pilot control or without GNSS."""
        if not self.is_on_ground and self.accepts_app_control:
            self.active_mode = stick

    def pilot_takes(self, mode: FlightMode = FlightMode.GPS_SPORT) -> None:
        """The pilot takes control by the mode switch, and holds."""
        self.has_pilot_control = True
        if not self.is_on_ground:
            self.active_mode = PositionHold(mode)

    def pilot_releases(self) -> None:
        """The pilot switches back; the aircraft holds until commanded."""
        self.has_pilot_control = False
        if isinstance(self.active_mode, PositionHold):
            self.active_mode = PositionHold()

    def lose_gnss(self) -> None:
        """Lose the position: the current mode ends and the aircraft drifts with the wind."""
        self.has_gnss = False
        # Takeoff and landing are vertical and continue on the barometer.
        if not self.is_on_ground and not isinstance(self.active_mode, Land | TakeOff):
            self.active_mode = PositionHold(FlightMode.ATTI)

    def find_gnss(self) -> None:
        """Regain the position, and hold there."""
        self.has_gnss = True
        if self.flight_mode is FlightMode.ATTI:
            self.active_mode = PositionHold()

    def set_go_home_height(self, height_m: float) -> None:
        """Set another go-home height, as a person may in the aircraft's app."""
        self.settings = replace(self.settings, go_home_height_m=height_m)

    def move_home_east(self, distance_m: float) -> None:
        """Record home elsewhere, as a person may in the aircraft's app."""
        self.home_east_m += distance_m

    def crash(self) -> None:
        """Fall to the ground at once, and stay there."""
        self.active_mode = Crashed()
        self._come_to_rest()
        self._landed_at_ns = None

    def _set_home(self) -> None:
        self._zeroed_at_m = self.errors.north_east_up_m[2]
        here = self.estimate
        self.home_north_m, self.home_east_m = here.north_m, here.east_m

    def _go_home_mode(self) -> GoHome:
        return GoHome(
            self.home_north_m,
            self.home_east_m,
            self.settings.go_home_height_m,
            self.settings.limits,
            confirmation_s=self.settings.landing_confirmation_s,
        )

    def _tick(self, seconds: float) -> None:
        self.errors.step(seconds)
        # Wind first: demand, drag and load of this tick all use the same wind.
        self.air.step(self.motion, self.now_ns, seconds)
        if not self.is_on_ground:
            demand = self._disturbed(self.active_mode.demand(self._flown_by, seconds))
            wind = self.air.horizontal
            self.motion = _kept_above_ground(
                step(self.motion, demand, seconds, self.settings.limits, wind)
            )
            self._switch_mode()
        else:
            self._change_battery()
        self.gimbal.step(seconds)
        # The load is that of the motion just flown; on the ground only electronics draw power.
        load = flying_load(self.motion, self.air.horizontal) if self.is_flying else GROUND_LOAD
        self.battery.drain(seconds, load)
        # Checked every tick, so that no command can override it for longer than one tick.
        if self.battery.fraction < FORCED_LANDING_FRACTION:
            self.land()

    @property
    def _flown_by(self) -> AircraftMotion:
        """What the mode is flown by: close to the ground what it sees of it."""
        return self.motion if isinstance(self.active_mode, TakeOff | Land) else self.estimate

    def _disturbed(self, demand: VelocityDemand) -> VelocityDemand:
        """Return a demand with the wind's drift added and the height limit applied."""
        north, east, up = self._drift() if self.is_flying else (0.0, 0.0, 0.0)
        limits = self.settings.limits
        # The height limit is a speed limit towards it, so that the aircraft slows down before it.
        highest = hold_height_mps(self.estimate.height_m, self.settings.max_height_m, limits)
        return VelocityDemand(
            demand.velocity_north_mps + north,
            demand.velocity_east_mps + east,
            min(demand.velocity_up_mps + up, highest),
            demand.yaw_deg,
        )

    def _drift(self) -> tuple[float, float, float]:
        """Return the velocity (north, east, up) that the air adds to the demand."""
        north, east, up = self.air.push
        if not self.has_gnss:
            return *self.air.horizontal, up
        if isinstance(self.active_mode, Stick):
            wind_north, wind_east = self.air.horizontal
            return north + STICK_DRIFT_SHARE * wind_north, east + STICK_DRIFT_SHARE * wind_east, up
        return north, east, up

    def _switch_mode(self) -> None:
        following = self.active_mode.successor(self._flown_by)
        if following is None:
            return
        self.active_mode = following
        # Touchdown: without this a residual velocity would move the aircraft along the ground.
        if isinstance(following, Grounded):
            self._come_to_rest()
            is_kept = self.battery.fraction >= self.settings.battery_kept_share
            self._landed_at_ns = None if is_kept else self.now_ns

    def _change_battery(self) -> None:
        swap_s, landed_at_ns = self.settings.battery_swap_s, self._landed_at_ns
        if swap_s is None or landed_at_ns is None:
            return
        if self.now_ns - landed_at_ns >= seconds_to_ns(swap_s):
            self.battery = Battery(1.0, self.settings.endurance_s)
            self._landed_at_ns = None

    def _come_to_rest(self) -> None:
        motion = self.motion
        self.motion = AircraftMotion(
            north_m=motion.north_m, east_m=motion.east_m, yaw_deg=motion.yaw_deg
        )


def _kept_above_ground(motion: AircraftMotion) -> AircraftMotion:
    if motion.height_m >= 0.0:
        return motion
    return motion._replace(
        height_m=0.0,
        velocity_north_mps=0.0,
        velocity_east_mps=0.0,
        velocity_up_mps=0.0,
    )
