"""The fleet's thresholds, each with its reason."""

from dataclasses import dataclass, field


@dataclass(frozen=True, slots=True)
class AirborneSettings:
    """Limits for believing a vehicle in the air or on the ground (`fleet.airborne`)."""

    slow_mps: float = 0.5
    """Speed that velocity noise on the ground stays below."""
    slow_s: float = 1.0
    """Ten packets: a wrong flag in one or two of them lands nothing."""
    landing_s: float = 1.5
    """Modes come at 1 to 2 Hz: the last report in flight may be this much after a landing mode."""
    takeoff_radius_m: float = 15.0
    """GNSS drifts by some metres in a flight; on a slope of 1 in 5 the ground is 3 m lower here."""
    takeoff_height_m: float = 2.0
    """The barometer's usual drift in a flight."""
    landing_gap_s: float = 5.0
    """Shortest gap in which a vehicle may descend and stop its motors."""
    battery_change_gap_s: float = 15.0
    battery_gain_fraction: float = 0.05
    """A battery in flight only discharges; its gauge errs by a percent or two."""
    rest_s: float = 120.0
    rest_fraction: float = 0.02
    """Motors that last an hour, longer than any of these, empty it by 3.3 % in that time."""
    rest_m: float = 2.0
    """A change of height beyond this is motion, not the barometer."""
    moving_mps: float = 1.0
    battery_fresh_s: float = 5.0
    height_window_s: float = 30.0
    """The greatest height is kept for one to two of these: a landing from 60 m takes 30 s."""
    doubt_s: float = 2.0
    """A landing is believed a second after it: what takes longer is a contradiction."""
    sign_mps: float = 2.0
    """Speed faster than a vehicle on the ground is carried."""
    sign_m: float = 5.0
    signs_s: float = 1.0
    pressure_drift_mps: float = 0.05
    """Height rate slower than any climb, faster than the air pressure."""
    takeoff_seen_s: float = 1.0
    stands_still_s: float = 60.0
    """Longest gap of telemetry: in a longer one it may have been carried elsewhere to take off."""


@dataclass(frozen=True, slots=True)
class TrustSettings:
    """Limits for believing telemetry (`fleet.trust`)."""

    jump_m: float = 10.0
    """Distance beyond the fastest flight: GNSS wanders by metres; a jump is a new fix or error."""
    jump_vertical_m: float = 5.0
    together_s: float = 0.05
    burst_s: float = 1.5
    """Packets nearer in time than half their period were held back together, for as long as this;
    some of them may be lost."""
    accepted_s: float = 2.0
    """A run of packets that is consistent with itself for this long is the new truth."""
    accepted_count: int = 5
    frozen_moving_s: float = 1.0
    frozen_mps: float = 0.3
    """A vehicle that moves cannot send the same position for a second."""
    frozen_s: float = 5.0
    """Longest time without a change in a hover: attitude and GNSS jitter in their last digits."""
    reckoned_m: float = 20.0
    """A position that stands still while the velocity adds up to this is stuck."""
    stands_m: float = 3.0
    reckoned_mps: float = 0.5
    """Speed below which velocities are noise that adds up to nothing."""
    reckoned_gap_s: float = 1.0
    """Longest gap over which the velocity is known."""
    lingers_s: float = 3.0
    """A doubt ends this long after the last packet that showed it: alarms must not flicker."""
    jump_lingers_s: float = 60.0
    """An accepted jump may still be wrong: its alarm stays until the operator has looked."""
    battery_rise_fraction: float = 0.10
    battery_fall_fraction: float = 0.20
    battery_s: float = 10.0
    """A fall within this time; a cell that fails stays down, and counts at once."""
    battery_gap_s: float = 15.0
    """Longest gap in which the battery cannot have been changed."""
    backlog_s: float = 1.0
    """What arrives in the first second after a suspension was sent before it."""


@dataclass(frozen=True, slots=True)
class FleetSettings:
    """Times in seconds."""

    takeover_silence_s: float = 1.0
    """A rival link becomes the vehicle when the old link stays silent this long after the rival's
    serial arrived (an app that reconnects while its old socket still looks alive)."""

    conflict_silence_s: float = 3.0
    """Silence after which the old link loses command in a declared conflict: longer than the
    dropouts of a second or two that running video causes."""

    track_interval_s: float = 1.0
    """The track keeps one point a second: enough to see a path, little to keep."""

    track_points: int = 600
    """Ten minutes of track."""

    vehicles_kept: int = 64
    """An app that names a new serial again and again must not fill the memory: beyond this, the
    vehicles on the ground that have no link and were silent longest are forgotten; while this many
    without a link may fly, no new serial is accepted."""

    closed_links_kept: int = 32
    """Closed links kept for display with the reason they closed."""

    waiting_links_kept: int = 64
    """A quarter of the link server's places: apps that are not admitted must not fill them."""

    refusal_s: float = 300.0
    """An app reconnects every few seconds; a refusal must outlast the person's look at it."""

    refusals_kept: int = 64
    refused_serial_wait_s: float = 2.0
    """Extended telemetry, with the serial, comes at 1 to 2 Hz: until then a link from a refused
    host may be another aircraft behind the same address."""

    trust: TrustSettings = field(default_factory=TrustSettings)
    airborne: AirborneSettings = field(default_factory=AirborneSettings)
