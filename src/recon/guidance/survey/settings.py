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
    """Added to the margin to boundary and keep-out zones, so that rounding never breaks it."""

    turning_mps2: float = 2.5
    """What aircraft brake and start with: a stop costs speed over this."""

    steered_corner_s: float = 1.5
    """A vehicle that the station steers settles on a corner, where one on a mission stops at it."""

    flight_time_share: float = 0.8
    """Share of a battery's time that is planned with: wind, and turns that take longer."""

    longest_gap_s: float = 3.0
    """Longest gap between two positions: over a longer gap the path is unknown."""

    least_step_s: float = 0.5
    """Positions nearer in time are thinned: telemetry comes in bursts, and two that are stamped a
    moment apart give no speed."""

    burst_s: float = 0.03
    """Positions stamped nearer than this arrived together; aircraft report ten times a second."""

    least_move_m: float = 0.15
    """Least movement between two positions: with less the course is undefined, and so is the
    camera's heading."""

    steepest_course: float = 0.27
    """Largest across over along a row, 15 degrees: the camera is turned with the course."""

    course_slack_m: float = 0.3
    """What GNSS adds to that between two positions."""

    height_slack_m: float = 5.0
    """Barometers drift by metres; at 60 m this is an eighth of the footprint less overlap."""

    fastest_share: float = 1.5
    """Factor on the planned speed: positions stamped a few tenths of a second wrong reach it."""

    settle_s: float = 3.0
    """Positions wait this long before they count, so that the shade maps of that time are there:
    images are up to a second late, the detection takes another."""

    shade_age_s: float = 5.0
    """Shade maps farther off in time do not count: shadows move at 10 m/s."""

    light_shown_s: float = 150.0
    """Time over which the station averages how often shade maps show a cell's light: longer than a
    side-step."""

    light_shown_from: float = 0.25
    """A cell that fewer maps show lies outside the imaging drone's view, or at its edge: it cannot
    count in sun. One that no map shows is known as such after 208 s."""

    decided_least: float = 0.02
    """Share of the ground whose light was shown: a map that knows less of it shows nothing of the
    view, as in flat light, when a method decides single spots."""

    least_transmittance: float = 0.55
    """A cell counts in sun from this share of the direct beam, more than half, because shade maps
    have errors. Forecasts call a cell sunlit from half on: ground between the two is photographed
    and does not count. With 0.6 too much ground lay between them under thin cloud."""

    terrain_below_m: float = 1.5
    """Allowance below the height wanted above ground, between two waypoints: rows are this much
    narrower for each 100 m of footprint per 60 m of height, and clearance comes first."""

    terrain_above_m: float = 3.0
    """Allowance above it: pixels are a twentieth larger from 60 m. Fewer waypoints save stops."""

    terrain_step_m: float = 10.0
    """Distance between waypoints that follow the ground, at most twice as near: braking from 5 m/s
    and starting again take as much."""

    terrain_cell_m: float = 5.0
    """Wanted heights are kept on a lattice this fine: ground is smoother than that."""

    terrain_mean_m: float = 10.0
    """The ground's mean is taken this far to each side: the middle of a footprint from 20 m. Plants
    and single cells of a model disappear in it."""

    least_clearance: float = 0.75
    """Share of the survey's height, kept above the highest ground near: over a row of trees the
    aircraft climbs, over plants it does not."""

    shade_maps_kept: int = 16
    positions_kept: int = 1_000
    """Most positions of each vehicle that wait to count: at 10 Hz, far more than settling takes."""

    retry_s: float = 15.0
    """A mission refused while others flew is requested again after this: by then they are
    elsewhere."""

    retry_soon_s: float = 3.0
    """A mission refused for what may end without a command, such as late telemetry, is asked for
    again after this: telemetry comes ten times a second, and a link is open again within
    seconds."""

    segment_m: float = 60.0
    """Length of a row decided on at once: shorter takes longer to plan; shade's edges are wider."""

    planned_s: float = 300.0
    """How far ahead a flight is planned; beyond, forecasts know little but the share of sun."""

    moment_s: float = 10.0
    """Time between two look-ups of the expected sun: an edge of shade takes 15 s."""

    patience_s: float = 150.0
    """A gain this much later counts for a third: a forecast that far ahead is uncertain."""

    beam_step_s: float = 5.0
    beam_width: int = 24
    """Flights that are followed at each step; twice as many image no more."""

    rows_looked_at: int = 5
    """Nearest rows with something left in sun on which a flight may continue."""

    transit_s: float = 40.0
    """Time to reach one of these rows: it must be in sun within this."""

    expected_rate: float = 0.8
    """Share of the rate without a stop, to compare flights that end at different moments."""

    gap_costs_s: float = 6.0
    """What a gap left in a row costs: a stop at both of its ends, later."""

    least_sun_probability: float = 0.15
    """Probability of sun from which flying over ground is worth it."""

    least_gain: float = 0.02
    """Least share of a segment's ground; a row is not flown for less."""

    put_off_share: float = 0.02
    """Rows that image less in sun than this share of what is flown in their time are put off while
    the vehicle's last rows are not counted: what they left is near, and known in seconds."""

    near_m: float = 90.0
    """Distance to a row within which a vehicle flies at the rows' height, if the gate approves."""

    near_rows: float = 2.6
    """Rows this far apart are within one mission; farther ones cost the path in a layer."""

    start_s: float = 3.5
    """Time from the decision until a hovering aircraft moves: upload and start."""

    takeoff_s: float = 5.0
    taken_off_m: float = 5.0
    """An aircraft takes off to about 1.2 m on its own, and then flies its mission."""

    climb_mps: float = 2.5
    corner_s: float = 0.8
    """Time at a corner in addition to braking and starting."""

    layer_s: float = 14.0
    """Time for a climb to a layer of its own and the descent to its first row."""

    committed_s: float = 90.0
    """A mission takes the rows begun by then; what comes later is decided anew, with a newer
    forecast. Each mission costs some seconds."""

    at_end_m: float = 12.0
    """A vehicle this near to the end of a row has reached it: positions come each second, and it
    stops there."""

    closed_from_s: float = 10.0
    """A mission that leads over ground where a vehicle was lost is replaced after this: most links
    are back by then."""

    handed_on_s: float = 30.0
    """Rows are handed on to a vehicle without any if that saves as much: its path there, and
    another mission, take half of it."""

    hand_on_free_share: float = 0.2
    """Rows are handed on only if the free ground in sun is at most this share of the mission's."""

    in_shade_below_sun_share: float = 0.3
    """A mission is flown in shade if less than this share of its rest is expected in sun."""

    mission_kept_sun_share: float = 0.6
    """Share of a mission's missing ground expected in sun from which on its rest is flown."""

    replacement_gain_share: float = 0.25
    """Gain of ground in sun from which it is replaced, as a share of what is flown
    meanwhile."""

    clear_sky_probability: float = 0.85
    """Mean probability of sun for as long as is planned from which on choosing gains nothing: a
    share is flown row by row."""

    best_flight_worth: float = 1.1
    """Ratio to the share flown row by row from which on the best flight is flown under a clear sky:
    it comes to the first long row much sooner."""

    round_sun_share: float = 0.6
    """Share of a round's missing ground expected in sun when it passes, from which on it is flown:
    choosing takes longer than it gains."""

    clear_view: float = 0.99
    """Share of the view in sun from which on no edge of shade can show a motion: the planner does
    not wait for one. It is so under thin uniform cloud."""

    motion_within_s: float = 9.0
    """Longest time from the start to the first forecast with motion, where there are shadows: three
    maps or more show it."""

    share_worth: float = 0.15
    """Share of a vehicle's missing ground that must be expected in sun; else it helps others."""

    least_worth: float = 0.2
    """Ground in shade counts this much when shares are made: it must be flown some time."""

    standby_s: float = 60.0
    """Time by which a vehicle takes off before sun is expected at its first row."""

    standby_m: float = 30.0
    """A vehicle this near to its next row waits where it is."""

    decided_again_s: float = 3.0
    """A waiting vehicle looks for a flight again after this."""

    battery_change_away_s: float = 300.0
    """The route home, landing, another battery, takeoff and the path back."""

    battery_kept_fraction: float = 0.5
    """A battery that is this full after a landing stays in; a lower one is changed."""

    battery_kept_above_reserve: float = 0.25
    """Battery above a site's large reserve: a vehicle that flies rows is above the reserve."""

    ground_wait_away_s: float = 150.0
    """The route home, landing, takeoff with the same battery and the path back."""

    saved_battery_gain: float = 0.25
    """A wait in the air costs a quarter of it later, in a change of battery, if one is needed."""

    takeoff_probability: float = 0.3
    """One on the ground takes off for sun at least so probable on what it flies first."""

    swap_later: float = 0.5
    """A later change costs this share of its time in sun: half of it under broken cloud."""

    shade_lasts_s: float = 250.0
    """How long it lasts on average: longer than that with a probability of 1 / e."""

    level_m: float = 3.0
    """A height that differs by less from the rows' is at the rows' height: barometers drift."""

    forecast_age_s: float = 15.0
    """A forecast older than this is not used; one comes with each shade map."""

    shade_persists_s: float = 120.0
    """Observed sun or shade is worth a third after this long, and nothing from then on."""

    route_home_waits_s: float = 60.0
    """Reserve besides the return for a vehicle that waits for others' rows: it may wait there."""

    enough_share: float = 0.99
    """Share of the cells that rows reach from which on a survey is done; a cell or two at an edge
    are not worth a flight."""


DEFAULT = SurveySettings()
