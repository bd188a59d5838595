"""What the simulator shows of each vehicle at every step: its place, and its marks."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from math import hypot

from tests.oracles.flown_air import NEAR_HOME_M, Breach, TruePlace
from tests.oracles.flown_orders import StopClock, TakeoffPermits

from recon.model.units import NS_PER_S
from recon.sim.app.app import SimulatedApp
from recon.sim.app.faults import FaultKind
from recon.sim.flight.battery import FORCED_LANDING_FRACTION
from recon.sim.flight.flight_modes import GoHome, Land, TakeOff
from studies.closed_loop.links import LinkedApps
from studies.closed_loop.marks import Mark, VehicleMarks
from studies.closed_loop.pilots import PilotFlight
from studies.closed_loop.scene import Scene
from studies.closed_loop.violations import ViolationLog

STEP_S = 0.1
"""Everything is looked at so often."""
NO_COMMANDS_FAULTS = (
    FaultKind.ACK_THEN_NOTHING,
    FaultKind.NEGATIVE_ACK,
    FaultKind.IGNORED_MISSIONS,
    FaultKind.SLOW_READER,
    FaultKind.FALLS_SILENT,
)
HEIGHT_FAULTS = (FaultKind.TAKEOFF_ALTITUDE_LOST, FaultKind.TAKEOFF_ALTITUDE_STALE)
GUST_MPS = 1.0
LANDS_BELOW_M = 1.0


@dataclass(slots=True)
class TrueFleet:
    """The vehicles of a run as they truly are."""

    scene: Scene
    apps: Mapping[str, SimulatedApp]
    links: LinkedApps
    log: ViolationLog
    stops: StopClock
    permits: TakeoffPermits
    core_s: dict[str, float] = field(default_factory=dict)
    """When core telemetry of each vehicle last reached the station."""
    _home_m: dict[str, tuple[float, float]] = field(default_factory=dict)
    """Where each took off last: an aircraft's home moves with that."""
    _was_flying: dict[str, bool] = field(default_factory=dict)
    _was_grounded: dict[str, bool] = field(default_factory=dict)

    def __post_init__(self) -> None:
        self._was_flying = {serial: app.aircraft.is_flying for serial, app in self.apps.items()}
        self._was_grounded = {s: app.aircraft.is_on_ground for s, app in self.apps.items()}

    def place(self, serial: str) -> tuple[float, float, float]:
        """Return where a vehicle truly is: east, north and up of the site's origin."""
        home, motion = self.scene.homes_m[serial], self.apps[serial].aircraft.motion
        return home[0] + motion.east_m, home[1] + motion.north_m, home[2] + motion.height_m

    def is_flying(self, serial: str) -> bool:
        """Whether a vehicle is in the air."""
        return self.apps[serial].aircraft.is_flying

    def mark_all(self, now_s: float) -> None:
        """Bring the marks of all vehicles up to date; find takeoffs and empty batteries."""
        for serial, app in self.apps.items():
            self._mark(serial, app, self.log.marks[serial], now_s)

    def _mark(self, serial: str, app: SimulatedApp, marks: VehicleMarks, now_s: float) -> None:
        aircraft = app.aircraft
        if self._was_flying[serial] and not aircraft.is_flying:
            self.log.result.landings += 1
            marks.landed_s, marks.left_by_pilot = now_s, False
            self.log.note(serial, f"landed with {aircraft.battery.fraction:.0%}")
        if self._was_grounded[serial] and not aircraft.is_on_ground:
            self.log.note(serial, "takes off")
            self._home_m[serial] = self.place(serial)[:2]
            found = self.permits.took_off(serial, now_s)
            if found is not None:
                self.log.found(found)
        self._was_flying[serial] = aircraft.is_flying
        self._was_grounded[serial] = aircraft.is_on_ground
        if not aircraft.is_flying:
            return
        self.log.result.flight_s += STEP_S
        mode = aircraft.active_mode
        if (
            isinstance(mode, PilotFlight)
            and aircraft.motion.ground_speed_mps + abs(aircraft.motion.velocity_up_mps) > 0.1
        ):
            marks.mark(Mark.PILOT_FLIES, now_s)
            marks.left_by_pilot = True
        if now_s - self.core_s.get(serial, 0.0) > 1.0:
            marks.mark(Mark.NO_TELEMETRY, now_s)
        marks.has_wrong_plane |= self._is_off_its_plane(serial)
        if marks.has_wrong_plane:
            marks.mark(Mark.WRONG_HEIGHT, now_s, "landed on a slope")
        self._mark_faults(serial, app, marks, now_s)

    def _mark_faults(
        self, serial: str, app: SimulatedApp, marks: VehicleMarks, now_s: float
    ) -> None:
        aircraft = app.aircraft
        if not self.links.has_downlink(serial):
            marks.mark(Mark.NO_COMMANDS, now_s, "no downlink")
            self.stops.excuse(serial)
        if not aircraft.has_gnss:
            marks.mark(Mark.NO_COMMANDS, now_s, "no GNSS")
        for fault in app.settings.faults:
            if not fault.is_active(round(now_s * NS_PER_S)):
                continue
            if fault.kind in NO_COMMANDS_FAULTS:
                marks.mark(Mark.NO_COMMANDS, now_s, fault.kind.value)
            if fault.kind in HEIGHT_FAULTS and serial in self.scene.wgs84:
                marks.mark(Mark.WRONG_HEIGHT, now_s, fault.kind.value)
            if fault.kind is FaultKind.SLOW_READER:
                self.stops.excuse(serial)
        if aircraft.battery.fraction < FORCED_LANDING_FRACTION:
            self._forced_landing(serial, app, now_s)
            marks.mark(Mark.FORCED_LANDING, now_s, "empty battery")
        if max(abs(v) for v in aircraft.air.push) > GUST_MPS:
            marks.mark(Mark.GUST, now_s)

    def _is_off_its_plane(self, serial: str) -> bool:
        """Whether it comes down away from home on a slope: the simulator's ground is the plane of
        the first takeoff, so from there on its heights are not those of a real aircraft."""
        ground = self.scene.truth.ground
        if ground.is_flat:
            return False
        home, here = self.scene.homes_m[serial], self.place(serial)
        if hypot(here[0] - home[0], here[1] - home[1]) <= NEAR_HOME_M:
            return False
        height_m = min(here[2] - home[2], here[2] - ground.height_m(here[0], here[1]))
        return height_m < LANDS_BELOW_M

    def _forced_landing(self, serial: str, app: SimulatedApp, now_s: float) -> None:
        low = [f for f in app.settings.faults if f.kind is FaultKind.LOW_BATTERY]
        if any(now_s >= fault.start_s for fault in low):
            self.log.marks[serial].mark(Mark.FORCED_LANDING, now_s, "a cell failed")
        self.log.found(Breach("forced landing", (serial,), "", 0.0, "its battery is empty"))

    def true_place(self, serial: str) -> TruePlace:
        """Return where a vehicle truly is, and whether it may be low there."""
        mode, marks = self.apps[serial].aircraft.active_mode, self.log.marks[serial]
        here = self.place(serial)
        is_low = isinstance(mode, Land | TakeOff | GoHome) or marks.is_coming_down
        is_low = is_low or marks.brakes_descent(self.log.now_s())
        home = self._home_m.get(serial, self.scene.homes_m[serial][:2])
        # Low over its home or any pad is allowed; what hovers at the rim of it drifts out and in.
        pads = (home, *(pad[:2] for pad in self.scene.homes_m.values()))
        is_low = is_low or any(
            hypot(here[0] - pad[0], here[1] - pad[1]) <= NEAR_HOME_M for pad in pads
        )
        is_low = self._stays_low(marks, here, is_low)
        return TruePlace(*here, home, is_low)

    def _stays_low(
        self, marks: VehicleMarks, here: tuple[float, float, float], is_low: bool
    ) -> bool:
        """Whether it may be low now: what is low already may climb, above where it came down."""
        truth = self.scene.truth
        if here[2] - truth.ground.height_m(here[0], here[1]) >= truth.least_height_m:
            marks.low_at_m = None
            return is_low
        if is_low:
            marks.low_at_m = here[:2]
            return True
        low = marks.low_at_m
        return low is not None and hypot(here[0] - low[0], here[1] - low[1]) <= NEAR_HOME_M
