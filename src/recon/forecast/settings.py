"""What the forecast of sun goes by, each with its reason."""

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class ForecastSettings:
    """Times in seconds, lengths in metres, probabilities in [0, 1]."""

    method: str = "global_shift"
    """A name in `recon.forecast.FORECASTERS`."""

    lead_s: tuple[float, ...] = tuple(30.0 * i for i in range(21))
    """Now to ten minutes: a survey's row takes about half a minute, a whole mission ten."""

    surest: float = 0.97
    """No cell is called surer than this: detection errs in some per cent of what it is sure of."""

    soft_edge: float = 0.2
    """Half the width, in transmittance, in which sun passes into shade: detection is no finer."""

    cover_memory_s: float = 900.0
    """The share in sun that is taken where nothing is known is a mean over about this time: covers
    change over a quarter of an hour."""

    cover_view_s: float = 120.0
    """Views this far apart show other clouds. The share in sun counts as many of them as were seen,
    beside one half-sunlit view that stands for not having seen any."""

    persistence_memory_s: float = 150.0
    """In this time all but 1/e of what is seen is forgotten when no motion is known. Measured
    shadows (36, 88, 640 s as 10th, 50th, 90th percentile) and gaps (40, 129, 836 s) last some 250
    and 330 s on the mean; a place that switches so between two states forgets in about 140 s."""

    persistence_horizon_s: float = 300.0
    """Beyond it nothing is known without a motion."""

    shape_memory_s: float = 600.0
    """In this time all but 1/e of the clouds' shapes is forgotten, moved along or not: clouds of
    half a kilometre live about ten minutes."""

    keep_every_s: float = 5.0
    """Shade maps kept to be compared: in 5 s low clouds move ten cells at most."""

    pair_s: tuple[float, ...] = (10.0, 20.0, 40.0)
    """How far apart the compared maps are: at 10 s a cell's error is 0.4 m/s and fast clouds are
    still in view; at 40 s it is a quarter of that for slow ones."""

    motion_window_s: float = 60.0
    """The motion is the median of what the pairs of this time said; wind turns over minutes."""

    least_pairs: int = 4
    """Fewer may agree by chance."""

    most_spread_mps: float = 1.5
    """Pairs that disagree by more on the whole (as a standard deviation) do not see one motion."""

    least_spread_mps: float = 0.3
    """The velocity is never taken as better known: clouds do not move as one."""

    slowest_mps: float = 0.5
    """What seems to stand still is the ground's pattern in the maps, or is served by persistence
    just as well: such a pair tells no motion."""

    fastest_mps: float = 30.0
    """No shift beyond is looked for: high clouds move at 18 m/s."""

    detail_m: float = 24.0
    """Only shade that differs from the mean this far around it is compared, so that the edge of
    what is seen, which stays where it is, does not count as motion."""

    smooth_cells: float = 2.0
    """Details under this are noise: phases count alike, and most of them are of small details."""

    least_peak: float = 0.2
    """Share of the phases that agree on the shift. With these two bounds 4 in 100 pairs of
    unrelated drawn maps pass, and nine in ten pairs that moved for 10 to 20 s."""

    most_rival: float = 0.7
    """The next best shift's peak as a share of the best one's."""

    least_contrast: float = 0.08
    """Standard deviation of the transmittance under which there is nothing to compare."""

    horizon_step_s: float = 5.0
    """The horizon is told to this step, downwards."""
