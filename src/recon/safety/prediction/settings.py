"""What foreseeing paths takes for granted, each number with its reason."""

from dataclasses import dataclass

from recon.model.dji import DJI
from recon.model.vehicle import LATE_UNDER_S


@dataclass(frozen=True, slots=True)
class PredictionSettings:
    """How vehicles are thought to fly, and how wrong that may be."""

    braking_mps2: float = 2.5
    """What a loaded aircraft brakes and gains speed with."""

    reaction_s: float = 1.0
    """From an order at the station to the aircraft's first deceleration: link, app and pacing."""

    time_uncertainty: float = 0.1
    """Of the time gone by: an aircraft holds its ground speed within a few percent, and takes a
    little longer or shorter at each of its corners and stops."""

    slack_s: float = 3.0
    """Beyond that: gaining speed and stopping are counted in whole legs."""

    start_delay_s: float = 8.0
    """A mission under judgement, or another's that has not begun, starts at once or as late as
    this; later it counts as ignored."""

    piece_s: float = 3.0
    """Paths are compared in pieces of this time, or of their own uncertainty when that is more."""

    stick_horizon_s: float = 5.0
    """A stick without a known target is foreseen this far: no app holds one longer."""

    free_s: float = 5.0
    """A vehicle that the station has told nothing may be flown by a pilot. It may use its speed in
    any direction for this long; a standing one is taken to stand, and watched."""

    stands_s: float = 30.0
    """What follows a steered order: a place is held this long before others must fear it no more;
    from then on each new order is judged anew, and the watchdog looks ahead."""

    climb_mps: float = 3.0
    sink_mps: float = 4.0
    """What aircraft of all sizes do at most by themselves on the way home and down."""

    takeoff_height_m: float = 3.0
    """A hover that takes off ends so high at most: DJI's own takeoff ends at 1.2 m, and bounces."""

    landing_mps: float = 1.0
    landing_wait_s: float = 30.0
    """A landing is slow near the ground, and waits for confirmation at its end; then it is down."""

    go_home_speed_mps: float = 10.0
    """DJI's aircraft fly home at 8 to 15 m/s."""

    unknown_climb_m: float = 500.0
    """The highest go-home height that can be set in an aircraft: assumed when nobody has told."""

    plausible_speed_mps: float = 23.0
    """No DJI survey aircraft flies faster: a reported speed above is cut to this."""

    unknown_speed_mps: float = DJI.max_speed_mps
    """A vehicle that tells no velocity: as fast as missions and sticks may make it."""

    stale_s: float = LATE_UNDER_S
    """Core telemetry older than this: the vehicle is a hazard somewhere near its last place."""

    hazard_radius_m: float = 150.0
    """How far such a hazard grows, or to its own stopping volume when that is larger."""

    hazard_least_speed_mps: float = 2.0
    """How fast it grows at least: one that hung still may have begun to move since."""

    corridor_m: float = 10.0
    """Half the width of a way home: GNSS error, wind, and where home really is."""

    escape_s: float = 20.0
    """Two vehicles already too near each other may be led apart: for this long only getting nearer
    is refused. Time for 100 m at a survey's speed."""
