"""Settings of the sun forecast, each with its reason."""

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class ForecastSettings:
    """Times in seconds, lengths in metres, probabilities in [0, 1]."""

    method: str = "advection"
    """A name in `recon.forecast.FORECASTERS`."""
    lead_s: tuple[float, ...] = (0.0, 15.0, 30.0, 45.0, *(30.0 * i for i in range(2, 21)))
    """0 to ten minutes: a survey row takes about half a minute, a whole mission ten. Denser where
    most is known."""
    surest: float = 0.97
    """Largest probability: detection is wrong in a few per cent of the cells it is sure of."""
    soft_edge: float = 0.2
    """Half the width, in transmittance, of the transition from shade to sun: detection is no
    finer."""
    cover_memory_s: float = 900.0
    """Averaging time of the share in sun, the prior where nothing is known: cloud cover changes
    over a quarter of an hour."""
    cover_view_s: float = 120.0
    """Time after which a view shows other clouds, so counts as independent. The prior is the mean
    of the views so far and one half-sunlit view, which stands for no knowledge."""
    persistence_memory_s: float = 150.0
    """Time constant of the decay to the prior when no motion is known. Measured shadows (36, 88,
    640 s as 10th, 50th, 90th percentile) and gaps (40, 129, 836 s) last 250 and 330 s on average;
    a place that switches like this between two states has a correlation time of about 140 s."""
    persistence_horizon_s: float = 300.0
    """Horizon without a motion."""
    keep_every_s: float = 5.0
    """Interval of the maps kept for comparison: in 5 s low clouds move ten cells at most."""
    least_spread_mps: float = 0.3
    """The velocity's uncertainty: clouds do not all move alike."""
    fastest_mps: float = 30.0
    """Search limit: high clouds move at 18 m/s."""
    detail_m: float = 24.0
    """Radius of the local mean that is subtracted before comparing, so that the edge of the visible
    area, which does not move, has no weight."""
    smooth_cells: float = 2.0
    """Size below which details are noise: phases have equal weight, mostly of small details."""
    longest_pair_s: float = 40.0
    """Maps are compared with all kept ones up to this old."""
    agreement_memory_s: float = 60.0
    """Time constant of fading of older pairs: wind changes over minutes."""
    velocity_step_mps: float = 0.5
    """Step of the agreement by velocity: a cell in 8 s."""
    match_step_mps: float = 1.0
    """Step of the mismatch by velocity, which is smooth."""
    match_memory_s: float = 300.0
    """Time constant of fading of the mismatch: over sparse maps a minute of it is chance."""
    least_match_s: float = 75.0
    """Time of maps before such a velocity counts: in the first minute, chance may explain most."""
    least_match_share: float = 0.1
    """Share of the weight of all pairs that a velocity must have, for fast ones leave the view."""
    least_explained: float = 0.3
    """Share of the changes that the best velocity must explain, to count without an agreement."""
    slowest_match_mps: float = 1.5
    """Slower, it is a pattern that stands still, as in `slowest_pooled_mps`: a coarse step."""
    clear_over_rival: float = 1.5
    """As `least_over_rival`, for a velocity that explains little."""
    least_of_best: float = 0.5
    """Share of what the best velocity of the last minute explains that one must explain to be no
    false one: a slow velocity of a pattern that stands still explains little of fast shadows."""
    peak_mps: float = 3.0
    """Half width of the area around the best velocity without rivals."""
    slowest_pooled_mps: float = 1.0
    """Slower is no motion but the ground's pattern in the maps: the agreement of what stands still
    has its peak within a step or two of rest."""
    least_over_rival: float = 1.25
    """The best velocity's agreement over the next best one's, to count."""
    least_soft_edge: float = 0.04
    soft_edge_per_m: float = 0.0008
    most_soft_edge: float = 0.4
    """Soft edge, as `soft_edge`, of shadows that are followed: they keep their edges, less so where
    another place must stand for the one upwind. How far off edges are later is measured."""
    edge_memory_s: float = 300.0
    """Time constant of fading of what was measured of the errors of followed edges."""
    usual_edge_weight: float = 0.005
    """Weight of the usual error, as edges per metre: that of one pair of maps."""
    most_edge_m: float = 400.0
    """Largest such error: beyond it shade is not followed any more."""
    followed_for_s: float = 60.0
    """Time for which shade out of view is followed: one seen cell in twelve is wrong then
    by its motion alone."""
    followed_memory_s: float = 300.0
    """Time constant of the confidence in it."""
    shade_scale_m: float = 2_500.0
    """Distance at which the nearest seen shade shows half as much of the sun as shade that is
    followed. Fitted, as the correlation, to Brier scores of the scenarios' skies, seeds 0 to 7."""
    most_scale_of_shade_m: float = 700.0
    """The same at most, of seen shade: a view all in shade is correlated throughout, and does not
    show that the shade ends beyond it. Fitted likewise, seeds 0 to 19."""
    correlation_lag_m: float = 160.0
    """Distance at which the correlation of shade is measured: a third of a view."""
    usual_correlation: float = 0.8
    """Correlation of deviations from the prior of cells so far apart, under usual skies."""
    usual_correlation_s: float = 6.0
    """Weight of the usual correlation: half a minute of maps with as much sun as shade."""
    least_correlation: float = 0.02
    most_correlation: float = 0.9
    usual_change: float = 0.15
    """Change of the transmittance between partly shaded cells `correlation_lag_m` apart in usual
    skies. Soft edges scale with this flight's change over the usual one: it is 0.02 under uniform
    thin cloud. Fitted to Brier scores likewise, seeds 0 to 39."""
    usual_change_s: float = 0.3
    """Weight of the usual change: less than one map that is all partly shaded."""
    shade_memory_s: float = 3_000.0
    """Time constant of the same for shadows that are followed: they change their shape."""
    usual_speed_mps: float = 6.0
    """Speed of shadows of unknown motion: what shades a place now has moved on so far."""
    wind_aloft_mps: tuple[float, float] | None = None
    """Wind at the clouds' height, east and north, from a weather forecast: the motion that is
    expected until maps show it. None: none is."""
    wind_aloft_error_mps: float = 3.0
    """How far off that may be: half of the usual speed, for the forecast's wind and the clouds'
    height are both inexact."""
    least_pooled_contrast: float = 0.02
    """Standard deviation of the transmittance below which maps are not compared."""
    hindcast_lead_s: tuple[float, ...] = (15.0, 30.0, 60.0, 120.0, 300.0)
    """Leads at which earlier forecasts are compared with what came."""
    hindcast_memory_s: float = 1_200.0
    """Time constant of fading of these comparisons: what a pilot still remembers of the sky."""
    horizon_step_s: float = 5.0
    """Resolution of the horizon, rounded down."""
