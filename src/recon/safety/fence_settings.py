"""The thresholds of the rules about places and heights, each with its reason."""

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class FenceSettings:
    """Beside what the site's own limits say."""

    braking_mps2: float = 2.5
    """What a loaded aircraft brakes with: how far a stick's velocity still carries it."""

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
    """Kept above and below a keep-out zone: barometers drift by metres within an hour."""

    not_worse_m: float = 0.01
    """A vehicle that already breaks a rule may be moved if that makes it no worse; this is for
    what rounding adds."""

    stop_slack_m: float = 2.0
    """A stick without velocity is refused for its height only beyond this: its height was judged a
    moment ago where the vehicle was then, and to stop is better than not to stop."""

    same_height_m: float = 1.0
    """A stick without velocity only stops while it asks for the present height within this, which
    is how well a barometer tells one and a hovering aircraft keeps it: any more is a climb."""

    speed_rounding_mps: float = 1e-5
    """What the wire's 32-bit floats may add to a speed of 15 m/s, and to the norm of two."""
