"""How far ahead flights are predicted, and within which bounds; all with their reasons."""

from dataclasses import dataclass

from recon.model.mission import DJI, Mission
from recon.model.vehicle import LATE_UNDER_S


@dataclass(frozen=True, slots=True)
class StickBounds:
    """What a question about a stick adds to its timeout.

    `reaction_s` is flown on at the stick's velocity; None of `braking_mps2` leaves braking out.
    """

    reaction_s: float
    braking_mps2: float | None


@dataclass(frozen=True, slots=True)
class PredictionSettings:
    """How vehicles are thought to fly, and how wrong that may be."""

    braking_mps2: float = 2.5
    """What a loaded aircraft brakes and gains speed with."""

    reaction_s: float = 1.0
    """Time from the station's order to the aircraft's first deceleration: link, app and pacing."""

    time_uncertainty: float = 0.1
    """Share of the elapsed time: an aircraft holds its ground speed within a few percent, and takes
    a little longer or shorter at each corner and stop."""

    slack_s: float = 3.0
    """Additional uncertainty: gaining speed and stopping are counted in whole legs."""

    start_delay_s: float = 8.0
    waypoint_upload_s: float = 0.1
    """A mission under judgement, or another's that has not begun, starts at once or as late as
    this and the upload of its waypoints (`starts_within_s`); later it counts as ignored."""

    piece_s: float = 3.0
    """Paths are compared in pieces of this time, or of their own uncertainty when that is more."""

    stick: StickBounds = StickBounds(reaction_s=1.0, braking_mps2=2.5)
    """Bounds as for an order: `reaction_s` passes before braking, whatever ends the stick."""

    stick_line_deg: float = 15.0
    """A body-frame stick that turns the vehicle by more than this sweeps a disc, not a line."""

    stick_horizon_s: float = 5.0
    """A stick without a known target is predicted this far: no app holds one longer."""

    free_s: float = 5.0
    """A vehicle without a commanded motion may be flown by a pilot. It may use its speed in
    any direction for this long; a hovering one is assumed to stay, and watched."""

    stands_s: float = 30.0
    """Time that a place is assumed to be held after a steered order; from then on each new order is
    judged anew, and the watchdog looks ahead."""

    climb_mps: float = 3.0
    sink_mps: float = 4.0
    """Fastest automatic climb and descent of aircraft of all sizes on the route home."""

    slow_climb_mps: float = 2.0
    """What they climb and sink at least when they change height for an order."""

    takeoff_height_m: float = 3.0
    """A hover that takes off ends so high at most: DJI's own takeoff ends at 1.2 m, and bounces."""

    landing_mps: float = 1.0
    landing_wait_s: float = 30.0
    """A landing is slow near the ground, and waits for confirmation at its end; then it is down."""

    go_home_speed_mps: float = 10.0
    """DJI's aircraft fly home at 8 to 15 m/s."""

    unknown_climb_m: float = 500.0
    """The highest go-home height that can be set in an aircraft: assumed while it is unknown."""

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

    track_error_horizontal_m: float = 1.0
    track_error_vertical_m: float = 0.5
    """Vertical error in a fault-free flight: aircraft fly some decimetres beside a row, and a
    barometer resolves decimetres. The gate keeps this beyond the watchdog's minima."""

    height_drift_m_per_h: float = 0.5
    """Drift of a vehicle's height above takeoff, by its time in the air: the separation of two
    grows by both. An assumption, for barometers that were warm at takeoff: two in the air for half
    an hour differ by half a metre, which layers of 10 m allow (docs/decisions/0014)."""

    corridor_m: float = 10.0
    """Half the width of a route home: GNSS error, wind, and where home really is."""

    escape_s: float = 20.0
    """Two vehicles already too near each other may be led apart: for this long only getting nearer
    is refused. Time for 100 m at a survey's speed."""

    steered_corner_s: float = 4.0
    """A path that the station steers may take this much longer at each corner than a mission: it
    settles on the corner before it turns."""

    def steered_lateness_s(self, mission: Mission, passed: int = 0) -> float:
        """Return how much later than a mission a steered path may end."""
        return self.steered_corner_s * (len(mission.waypoints) - passed)

    def starts_within_s(self, mission: Mission | None) -> float:
        """Return how long after its order a mission, or a takeoff without one, may begin. Many
        waypoints are uploaded in parts of as many as an aircraft takes."""
        waypoints = () if mission is None else mission.waypoints
        uploaded = min(len(waypoints), DJI.max_waypoints)
        return self.start_delay_s + self.waypoint_upload_s * uploaded
