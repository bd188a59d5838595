"""The gate's thresholds, each with its reason."""

from dataclasses import dataclass, field

from recon.model.dji import DJI
from recon.model.vehicle import LATE_UNDER_S, LIVE_UNDER_S
from recon.safety.energy_settings import EnergySettings
from recon.safety.fence_settings import FenceSettings
from recon.safety.prediction.settings import PredictionSettings
from recon.safety.preflight_settings import PreflightSettings
from recon.safety.watchdog_settings import WatchdogSettings


@dataclass(frozen=True, slots=True)
class SafetySettings:
    """Limits of DJI's Mobile SDK 4 where no other reason is given."""

    fresh_telemetry_s: float = LATE_UNDER_S
    """Telemetry this old still tells whether a vehicle flies: running video causes dropouts of a
    second or two, and within three no aircraft lands and disarms unseen."""

    motion_telemetry_s: float = LIVE_UNDER_S
    """Motion is ordered on core telemetry this young at most: at 15 m/s a second is 15 m, as far as
    two vehicles are kept apart."""
    motion_extended_s: float = 3.0
    """Extended telemetry comes at 1 to 2 Hz: older, its mode, battery and GNSS may not hold."""

    min_satellites: int = 8
    """Six give a position; with two more one may go behind a tree and it still holds."""
    min_gnss_level: int = 3
    """Of DJI's levels 0 to 5 the first at which the aircraft holds its place by GNSS."""
    min_gnss_level_on_ground: int = 4
    """The first level at which DJI's aircraft record their home point: without, none comes back."""

    approval_holds_s: float = 1.5
    """An approved order to move is sent within this time or not at all: what made it safe (it
    flies, telemetry is fresh) may not hold any longer. Unsent emergency orders are judged anew
    every 0.7 s."""
    mission_approval_holds_s: float = 2.5
    """A mission may first wait 2 s for the answer to the one before it."""

    altitude_offset_max_age_s: float = 2.0
    altitude_offset_max_jump_m: float = 2.0
    """A wgs84 app is sent height + (Altitude - HAG): the offset must be young, and unchanged since
    takeoff, or the app subtracts something else than was added."""

    altitude_offset_max_m: float = 10_000.0
    """No aircraft is this far from its takeoff point's height: such a number is a broken one."""

    min_waypoints: int = DJI.min_waypoints
    min_leg_m: float = DJI.min_leg_m
    max_leg_m: float = DJI.max_leg_m
    max_path_m: float = DJI.max_path_m
    min_height_m: float = DJI.min_height_m
    max_height_m: float = DJI.max_height_m
    max_speed_mps: float = DJI.max_speed_mps
    max_loiter_s: float = DJI.max_loiter_s
    min_gimbal_pitch_deg: float = DJI.min_gimbal_pitch_deg
    max_gimbal_pitch_deg: float = DJI.max_gimbal_pitch_deg
    min_corner_radius_m: float = DJI.min_corner_radius_m
    max_corner_radius_m: float = DJI.max_corner_radius_m

    max_stick_speed_mps: float = DJI.max_speed_mps
    max_stick_height_m: float = DJI.max_height_m
    max_stick_timeout_s: float = 5.0
    """An app holds a stick's velocity this long by itself: at 15 m/s already 75 m."""

    min_steering_mps: float = 0.1
    """Slower than GNSS velocity noise is no speed to steer at."""
    max_nudge_m: float = 100.0
    """A nudge is judged by eye; farther is a goto, which names its place."""

    max_camera_fps_hz: float = 30.0
    """No DJI video feed is faster."""

    preflight: PreflightSettings = field(default_factory=PreflightSettings)
    """When a point of the checklist is not passed."""

    energy: EnergySettings = field(default_factory=EnergySettings)
    """How much of its battery a flight takes."""

    fences: FenceSettings = field(default_factory=FenceSettings)
    """What the rules about places and heights need besides the site's limits."""

    prediction: PredictionSettings = field(default_factory=PredictionSettings)
    """How far and how surely vehicles' paths are foreseen."""

    watch: WatchdogSettings = field(default_factory=WatchdogSettings)
    """When the watchdogs bark and when they act."""
