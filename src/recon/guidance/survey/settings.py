"""The survey planning's thresholds, each with its reason."""

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class SurveySettings:
    """Distances in metres, times in seconds."""

    place_slack_m: float = 3.0
    """Taken off each side of a footprint before it counts: GNSS is 2.5 m off, telemetry at 8 m/s is
    a few tenths of a second late (along the row only, where there is more room)."""

    least_mark_m: float = 10.0
    """Rows are flown again in pieces between marks at least this far apart: less than that is lost
    in stopping."""

    least_cut_m: float = 25.0
    """A row is not cut between two vehicles nearer than this to its end: a stop costs as much."""

    join_gap_m: float = 30.0
    """Flying on over a gap this long is cheaper than a stop at 8 m/s, its start, and a turn."""

    sliver_m: float = 0.5
    """What is narrower in both directions is a drawn corner, not a piece of field."""

    kept_off_m: float = 0.5
    """Kept beyond the margin to boundary and keep-out zones, so that rounding never breaks it."""

    turning_mps2: float = 2.5
    """What aircraft brake and start with: a stop costs speed over this."""

    flight_time_share: float = 0.8
    """Of a battery's time that is planned with: wind, and turns that take longer."""

    longest_gap_s: float = 3.0
    """Between two positions: over a longer gap the path is unknown."""

    least_step_s: float = 0.5
    """Positions nearer in time are thinned: telemetry comes in bursts, and two that are stamped a
    moment apart give no speed."""

    burst_s: float = 0.03
    """Positions stamped nearer than this arrived together; aircraft report ten times a second."""

    least_move_m: float = 0.15
    """Between two positions: with less movement the course is undefined, and so is the camera's
    heading."""

    steepest_course: float = 0.27
    """Across over along a row, 15 degrees: the camera is turned with the course."""

    course_slack_m: float = 0.3
    """What GNSS adds to that between two positions."""

    height_slack_m: float = 5.0
    """Barometers drift by metres; at 60 m this is an eighth of the footprint less overlap."""

    fastest_share: float = 1.5
    """Of the planned speed: two positions stamped a few tenths of a second wrong seem this fast."""

    settle_s: float = 3.0
    """Positions wait this long before they count, so that the shade maps of that time are there:
    images are up to a second late, the detection takes another."""

    shade_age_s: float = 5.0
    """Shade maps farther off in time do not count: shadows move at 10 m/s."""

    least_transmittance: float = 0.6
    """In a shade map, for a cell to count in sun: half of the beam is sun, and maps err by up to
    0.1. A photo taken home with shade in it costs more than a row flown again."""

    shade_maps_kept: int = 16
    positions_kept: int = 1_000
    """Of each vehicle, waiting to count: at 10 Hz, far more than settling takes."""

    retry_s: float = 15.0
    """A mission refused while others flew is asked for again after this: by then they are
    elsewhere."""

    retry_soon_s: float = 3.0
    """A mission refused for what may end by itself, such as late telemetry, is asked for again
    after this: telemetry comes ten times a second, and a link is open again within seconds."""

    way_home_waits_s: float = 60.0
    """A vehicle that waits for others' rows keeps this beside its return: there it may wait too."""

    enough_share: float = 0.99
    """Of the cells that rows reach: from here on a survey is done; a cell or two at an edge are not
    worth a flight."""


DEFAULT = SurveySettings()
