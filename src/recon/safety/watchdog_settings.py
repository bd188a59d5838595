"""When the watchdogs bark and when they act, each number with its reason."""

from dataclasses import dataclass


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
    """At 30 m/s of closing speed the nearest sample is at most 4 m along from the nearest point:
    at 15 m of distance that hides half a metre, which the margin below holds."""

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
    """... or widens the least distance by this share of what must be kept."""

    near_s: float = 5.0
    """A conflict this near is critical."""

    fence_factor: float = 1.25
    """Of the stopping distance: what is looked at ahead for fences and zones."""

    link_late_s: float = 1.0
    """A vehicle in the air that says nothing for this long, ten times its usual pause."""

    height_drift_m: float = 10.0
    """Between the reported altitude and the height above takeoff since takeoff: barometers drift
    by metres in an hour of changing weather; more than that, and one of the two is wrong."""

    height_off_m: float = 4.0
    """From the heights of the leg being flown: half of what layers are apart."""

    jump_m: float = 10.0
    """Beyond what its speed explains: GNSS wanders by metres, a jump is a new fix or a lie."""

    jump_per_s: float = 5.0
    """More for each second between two positions: vehicles turn and gusts push."""

    burst_s: float = 1.0
    """Packets come in bursts: the time between two may be wrong by this."""

    stick_quiet_s: float = 0.5
    """A stream with no stick sent for this long: below 5 Hz aircraft may hover, and at 1 s the
    app's own timeout ends it."""
