"""The thresholds of the gate, the prediction and the watchdogs, each with its reason."""

from dataclasses import dataclass, field

from recon.model.mission import DJI
from recon.model.vehicle import ENOUGH_SATELLITES, LATE_UNDER_S, LIVE_UNDER_S
from recon.safety.prediction_settings import PredictionSettings, StickBounds


@dataclass(frozen=True, slots=True)
class PreflightSettings:
    """Preflight limits besides the site's limits and the gate's rules."""

    early_battery_fraction: float = 0.5
    """A flight begun with less is a short one; the operator should know."""

    earliest_clock_s: float = 1_735_689_600.0
    """2025-01-01 UTC. A clock before this program was written was never set: a computer without a
    network starts in 1970, or where its battery ran out."""

    clock_set_s: float = 2.0
    """A clock that was set by more since the start: what is recorded no longer fits what other
    clocks say (photos, the sun)."""

    pad_ground_m: float = 5.0
    """A pad's altitude and the elevation model may differ by this: models are good to metres. A
    wrong pad puts every height of its vehicle wrong."""

    strong_wind_level: int = 2
    """The aircraft's own warning of strong wind."""

    least_go_home_m: float = 20.0
    most_go_home_m: float = 500.0
    """What DJI's aircraft can be set to: another number was never read off one."""


@dataclass(frozen=True, slots=True)
class EnergySettings:
    """Loads count in hovering: 1.0 empties a full battery in the profile's endurance.

    They are on the careful side: what multirotors are measured to use, and a little more.
    """

    level_load: float = 1.25
    """Level flight: at moderate speeds cheaper than hovering, at 15 m/s up to a quarter dearer."""

    climb_load: float = 1.6
    """Lifting a drone at 2 m/s takes a quarter to a half more than holding it up."""

    sink_load: float = 1.0
    """Sinking is a little cheaper than hovering; in a gust it is not."""

    climb_mps: float = 2.0
    sink_mps: float = 2.0
    """Descent rate, slower than aircraft can (2.6 m/s and more): a longer descent costs more."""

    landing_mps: float = 1.5
    """Go-home's landing on average: 3 m/s high up, under 1 m/s near the ground."""

    touchdown_s: float = 15.0
    """The stop at 0.3 m, until the app has confirmed the landing, and the last of the descent."""

    home_mps: float = 8.0
    """Go-home flies at about 10 m/s, against the wind slower over the ground."""

    brake_mps2: float = 2.5
    """What the separation watchdog counts with too; a stop at a waypoint costs speed over this."""

    slowest_mps: float = 0.1
    """No leg is flown slower than this: nothing is divided by zero."""

    gimbal_s: float = 3.0
    """A mission waits at a waypoint until the gimbal has turned: 90 degrees at 30 a second."""

    wind_loads: tuple[float, ...] = (1.0, 1.2, 1.5)
    """Load factors by the aircraft's wind warning (none, wind, strong wind and worse): it leans and
    flies farther through the air than over the ground."""

    unknown_wind_load: float = 1.2
    """An app that tells no wind is taken to be in some."""

    landing_fraction: float = 0.10
    """Charge left when a route home ends, reserve or not: at about this charge aircraft land
    automatically, wherever they are."""

    stick: StickBounds = StickBounds(reaction_s=0.0, braking_mps2=None)
    """A stick is counted for its timeout only: braking takes no energy that hovering does not."""

    nearer_m: float = 1.0
    """An order that ends this much farther from home at most does not lead away from it: a place
    being held, with its corrections."""

    def landing_s(self, height_m: float) -> float:
        """Return how long go-home's landing takes from a height above the pad."""
        return max(0.0, height_m) / self.landing_mps + self.touchdown_s


@dataclass(frozen=True, slots=True)
class BlindStopSettings:
    """Conditions for a hover although telemetry is stale."""

    fastest_descent_mps: float = 10.0
    """The fastest of DJI's aircraft that fly missions sinks at 9 m/s; one more for the air."""

    height_error_m: float = 5.0
    """A barometer's error, and obstacles and plants on the ground."""

    fastest_mps: float = DJI.fastest_mps
    """How far it may have come over higher ground."""


@dataclass(frozen=True, slots=True)
class FenceSettings:
    """Fence limits besides the site's own."""

    stick: StickBounds = StickBounds(reaction_s=0.0, braking_mps2=2.5)
    """The app itself ends a stick at its timeout, so no reaction time passes; a loaded aircraft
    then brakes with this."""

    steering_overshoot_m: float = 3.0
    """A steered order may pass its target by this: the sticks that brake it reach up to 1.9 m
    beyond, and its position is no better than a metre."""

    height_noise_m: float = 1.0
    """A barometer and a hovering aircraft hold a height no better: the height that a vehicle sets
    out from counts as this much nearer to the one it goes to."""

    column_radius_m: float = 5.0
    """Round a place of takeoff or landing it may be low: what GNSS may be off when it comes down,
    and when it goes up."""

    zone_vertical_margin_m: float = 5.0
    """Margin above and below a keep-out zone: barometers drift by metres within an hour."""

    not_worse_m: float = 0.01
    """A vehicle that already breaks a rule may be moved if that makes it no worse; this is for
    what rounding adds."""

    stop_slack_m: float = 2.0
    """A stick without velocity is refused for its height only beyond this: its height was judged a
    moment ago where the vehicle was then, and to stop is better than not to stop."""

    same_height_m: float = 1.0
    """A stick without velocity only stops while it asks for the present height within this, which
    is the accuracy of a barometer and of a hovering aircraft: a larger difference is a climb."""

    speed_rounding_mps: float = 1e-5
    """What the wire's 32-bit floats may add to a speed of 15 m/s, and to the norm of two."""


@dataclass(frozen=True, slots=True)
class GoHomeSettings:
    """Limits beyond which the aircraft's own go-home is not what the site asks for."""

    near_home_m: float = 20.0
    """Begun nearer to home, or come nearer, an aircraft may land without climbing. An assumption on
    the careful side: DJI's manuals give 5 m to 20 m, by model and firmware."""

    height_off_m: float = 3.0
    """Largest error from the requested height: barometer drift, and half a metre in a hover."""

    climb_mps: float = 1.0
    """Climbing slower than this, it no longer climbs."""
    off_height_s: float = 1.5
    """Time that it is off its height before an alarm: go-home climbs at 2 m/s and more, and levels
    within half a second."""

    off_track_m: float = 10.0
    """Largest distance from the straight route home: half the width kept clear (`corridor_m`)."""
    off_track_deg: float = 40.0
    """Largest angle between its velocity and the direction of home: a crosswind of 6 m/s at 10 m/s
    of airspeed causes 31 degrees without correction."""
    off_track_s: float = 2.0

    no_progress_s: float = 10.0
    """Longest time neither nearer nor higher. It turns and brakes from 15 m/s in 8 s."""

    lands_within_m: float = 10.0
    """Largest distance of a landing from home or pad: GNSS (2.5 m each) and go-home precision."""


@dataclass(frozen=True, slots=True)
class WatchdogSettings:
    """Times in seconds, lengths in metres."""

    period_s: float = 0.1
    """Ten times a second, as often as telemetry comes."""

    lingers_s: float = 3.0
    """A finding stays this long after it was last made, so that alarms do not flicker."""

    horizon_s: float = 10.0
    """How far ahead vehicles are kept apart: two at 15 m/s need 7 s each to stand still."""

    sample_s: float = 0.25
    """Sampling interval: at 30 m/s of closing speed the nearest sample is at most 4 m from the
    nearest point; at 15 m of distance that hides half a metre, which the margin below covers."""

    margin_horizontal_m: float = 2.0
    margin_vertical_m: float = 1.0
    """What is watched for is this much more than what must be kept: noise and sampling."""

    confirm_s: float = 0.2
    """An alarm that lasts this long becomes a hold: never for one odd packet, never unannounced."""

    hold_margin_s: float = 2.0
    """A vehicle is held when what is left is the time that it and then the other need to stop, and
    this: for a lost packet, and for the watch itself."""

    effect_s: float = 2.0
    """A hold shows within this, or not at all: reaction, braking begun, and telemetry of it."""

    hold_again_s: float = 5.0
    """A vehicle that was held and is in conflict again is held again, not more often than this."""

    hold_retry_s: float = 1.0
    """A hold that could not be given is tried again after this, and the other one is held
    meanwhile: a link comes back within seconds, and each try is on record."""

    helps_s: float = 0.25
    """A hold helps if it puts the conflict off by this, or away..."""
    helps_share: float = 0.05
    """... or widens the least distance by this share of what must be kept..."""
    helps_height_m: float = 1.0
    """... or, equally near, keeps the one this much less deep in the heights that the other may
    come to: a landing vehicle's are all below it."""

    near_s: float = 5.0
    """A conflict this near is critical."""

    fence_factor: float = 1.25
    """Factor on the stopping distance: how far ahead fences and zones are checked."""

    link_late_s: float = 1.0
    """A vehicle in the air without telemetry for this long, ten times the usual interval."""

    height_drift_m: float = 10.0
    """Largest change of reported altitude less height above takeoff since takeoff: barometers drift
    by metres in an hour of changing weather; beyond this, one of the two is wrong."""

    height_off_m: float = 4.0
    """Largest error from the heights of the present leg: half of the distance between layers."""

    stick_quiet_s: float = 0.5
    """A stream with no stick sent for this long: below 5 Hz aircraft may hover, and at 1 s the
    app's own timeout ends it."""


@dataclass(frozen=True, slots=True)
class SafetySettings:
    """Limits of DJI's Mobile SDK 4 where no other reason is given."""

    blind_stop: BlindStopSettings = field(default_factory=BlindStopSettings)

    given_at_most_s: float = 5.0
    """Largest age of an order to move: a later one no longer fits what its person saw."""

    clock_ahead_s: float = 2.0
    """A client counts in the station's clock, or in one set by NTP: within a second or two."""

    fresh_telemetry_s: float = LATE_UNDER_S
    """Telemetry this old still tells whether a vehicle flies: running video causes dropouts of a
    second or two, and within three no aircraft lands and disarms lost."""

    motion_telemetry_s: float = LIVE_UNDER_S
    """Motion is ordered on core telemetry this young at most: at 15 m/s a second is 15 m, as far as
    two vehicles are kept apart."""
    motion_extended_s: float = 3.0
    """Largest age of extended telemetry (1 to 2 Hz): older, mode, battery and GNSS may not hold."""

    min_satellites: int = ENOUGH_SATELLITES
    """Six give a position; with two more one may go behind a tree and it still holds."""
    min_gnss_level: int = 3
    """First of DJI's levels 0 to 5 at which the aircraft holds its position by GNSS."""
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
    """An app holds a stick's velocity this long on its own: at 15 m/s already 75 m."""

    min_steering_mps: float = 0.1
    """Least speed to steer at: lower ones are within GNSS velocity noise."""
    max_nudge_m: float = 100.0
    """A nudge is judged by eye; farther is a goto, which names its place."""

    max_followed_waypoints: int = 1_000
    """Of a path that the station steers: no packet has to hold it."""

    max_camera_fps_hz: float = 30.0
    """No DJI video feed is faster."""

    preflight: PreflightSettings = field(default_factory=PreflightSettings)
    """Limits of the preflight checklist."""

    energy: EnergySettings = field(default_factory=EnergySettings)
    """How much of its battery a flight takes."""

    fences: FenceSettings = field(default_factory=FenceSettings)
    """What the rules about places and heights need besides the site's limits."""

    prediction: PredictionSettings = field(default_factory=PredictionSettings)
    """How far and how surely vehicles' paths are predicted."""

    go_home: GoHomeSettings = field(default_factory=GoHomeSettings)
    """Limits of the aircraft's own go-home."""

    watchdogs: WatchdogSettings = field(default_factory=WatchdogSettings)
    """Watchdog alarm and intervention thresholds."""
