"""Cloud shadows on the ground: shade maps and sun forecasts."""

from dataclasses import dataclass
from typing import TypeAlias

import numpy as np
import numpy.typing as npt

from recon.model.geo import GroundGrid
from recon.model.units import NS_PER_S

FloatArray: TypeAlias = npt.NDArray[np.float64]
FloatMap: TypeAlias = npt.NDArray[np.float32]
MaskMap: TypeAlias = npt.NDArray[np.bool_]

SUNLIT_TRANSMITTANCE = 0.5
"""A place is "in sun" when at least this share of the clear-sky direct beam reaches it."""

SURE = 255
"""A `sun_probability` of 1."""


@dataclass(frozen=True, slots=True, eq=False)
class ShadeMap:
    """How much of the clear-sky direct beam reaches each cell of `grid`; all arrays are (R, C).

    Where `valid` is False nothing is known: transmittance and metres per pixel are NaN there, the
    confidence is 0.
    """

    grid: GroundGrid
    captured_at_ns: int
    source_serials: tuple[str, ...]
    """The vehicles that took the frames; empty when unknown to the method."""
    transmittance: FloatMap
    """Transmittance in [0, 1]; in sun from `SUNLIT_TRANSMITTANCE` on."""
    valid: MaskMap
    confidence: FloatMap
    """Confidence in [0, 1]: how much evidence there was, not the distance from the threshold."""
    metres_per_pixel: FloatMap
    """Ground size of the longer side of one camera pixel."""

    def __post_init__(self) -> None:
        for name in ("transmittance", "valid", "confidence", "metres_per_pixel"):
            _expect_shape(name, getattr(self, name).shape, (self.grid.rows, self.grid.cols))

    @property
    def is_sunlit(self) -> MaskMap:
        """(R, C): valid and in sun."""
        with np.errstate(invalid="ignore"):
            return self.valid & (self.transmittance >= SUNLIT_TRANSMITTANCE)


@dataclass(frozen=True, slots=True, eq=False)
class SunlitReference:
    """The land in full sun as one flight has seen it, for the flights after it.

    `light` and `colour` (blue over red) are (r, c) natural logs up to a constant, NaN where the
    land was not seen; r and c are whole multiples of the cells of `grid`.
    """

    serial: str
    """Serial of the vehicle whose camera it belongs to."""
    grid: GroundGrid
    toward_sun_enu: tuple[float, float, float]
    camera_enu_m: tuple[float, float, float]
    light: FloatMap
    colour: FloatMap
    light_contrast: float
    colour_contrast: float
    """Natural logs by which shade was darker, and blue over red higher."""
    sun_colour: float
    """The level of `colour` in full sun, in this flight's white balance."""
    is_exposure_locked: bool

    def __post_init__(self) -> None:
        _expect_shape("colour", self.colour.shape, self.light.shape)


@dataclass(frozen=True, slots=True, eq=False)
class SunForecast:
    """Probability that each cell of `grid` is in sun, by lead time.

    `lead_s` (L,) float64 counts from `issued_at_ns` and rises. Beyond a cell's horizon nothing that
    will be over it is seen now: `sun_probability` is `prior_sunlit` there, or an estimate.
    """

    grid: GroundGrid
    issued_at_ns: int
    lead_s: FloatArray
    sun_probability: npt.NDArray[np.uint8]
    """(L, R, C), in 255ths."""
    horizon_s: FloatMap
    """(R, C): the longest lead whose clouds are over ground seen now; 0 where no more than the
    present is known, NaN where nothing was seen."""
    prior_sunlit: float
    """The recently observed share in sun, used where there is no prediction."""
    method: str
    """The method that made it, or its fallback."""
    velocity_mps: tuple[float, float] | None = None
    """East and north velocity of the shadows, where the method found one."""

    def __post_init__(self) -> None:
        cells = (self.grid.rows, self.grid.cols)
        _expect_shape("sun_probability", self.sun_probability.shape, (len(self.lead_s), *cells))
        _expect_shape("horizon_s", self.horizon_s.shape, cells)
        if len(self.lead_s) == 0 or self.lead_s[0] < 0.0 or (np.diff(self.lead_s) <= 0.0).any():
            raise ValueError(f"lead_s: expected rising leads from 0 s on, got {self.lead_s}")

    def probability_sunlit(
        self,
        cells: npt.NDArray[np.integer],
        t1_ns: int | npt.NDArray[np.int64],
        t2_ns: int | npt.NDArray[np.int64],
    ) -> FloatArray:
        """Return (N,): the mean probability of sun between t1 and t2.

        `cells` (N, 2) are rows and columns; the times are one for all or (N,), and equal times ask
        for one moment. Between leads the probability is interpolated; before the first lead it is
        the first one's; after the last lead, and off the grid, it is `prior_sunlit`. Raises
        `ValueError` where t2 comes before t1.
        """
        from_s, to_s = (
            np.broadcast_to((np.asarray(t) - self.issued_at_ns) / NS_PER_S, len(cells))
            for t in (t1_ns, t2_ns)
        )
        if (to_s < from_s).any():
            raise ValueError("probability_sunlit: expected t1 <= t2, got an end before its start")
        by_lead = self._probabilities(cells)
        long_s = to_s - from_s
        sunlit_s = self._sunlit_s(by_lead, to_s) - self._sunlit_s(by_lead, from_s)
        at_once = self._at(by_lead, from_s)
        return np.clip(
            np.where(long_s > 0.0, sunlit_s / np.where(long_s > 0.0, long_s, 1.0), at_once),
            0.0,
            1.0,
        )

    def _probabilities(self, cells: npt.NDArray[np.integer]) -> FloatArray:
        """(N, L): each cell's probability at each lead."""
        rows, cols = cells[:, 0], cells[:, 1]
        is_inside = (rows >= 0) & (rows < self.grid.rows) & (cols >= 0) & (cols < self.grid.cols)
        chosen = self.sun_probability[:, rows * is_inside, cols * is_inside].T / SURE
        return np.where(is_inside[:, np.newaxis], chosen, self.prior_sunlit)

    def _at(self, by_lead: FloatArray, at_s: FloatArray) -> FloatArray:
        """(N,): each cell's probability at its own moment."""
        index, share = self._between(at_s)
        each = np.arange(len(at_s))
        after = np.minimum(index + 1, len(self.lead_s) - 1)
        value = by_lead[each, index] * (1.0 - share) + by_lead[each, after] * share
        return np.where(at_s > self.lead_s[-1], self.prior_sunlit, value)

    def _sunlit_s(self, by_lead: FloatArray, until_s: FloatArray) -> FloatArray:
        """(N,): the expected seconds of sun from the first lead until each cell's own moment."""
        steps = np.diff(self.lead_s) * (by_lead[:, 1:] + by_lead[:, :-1]) / 2.0
        before = np.concatenate([np.zeros((len(by_lead), 1)), np.cumsum(steps, axis=1)], axis=1)
        index, _share = self._between(until_s)
        each = np.arange(len(until_s))
        inside_s = np.clip(until_s, None, self.lead_s[-1]) - self.lead_s[index]
        now = self._at(by_lead, np.clip(until_s, None, self.lead_s[-1]))
        trapezium = inside_s * (by_lead[each, index] + now) / 2.0
        beyond = np.clip(until_s - self.lead_s[-1], 0.0, None) * self.prior_sunlit
        total: FloatArray = before[each, index] + trapezium + beyond
        return total

    def _between(self, at_s: FloatArray) -> tuple[npt.NDArray[np.intp], FloatArray]:
        """The lead at or before each moment, and how far on to the next one, in [0, 1]."""
        index = np.clip(np.searchsorted(self.lead_s, at_s, side="right") - 1, 0, None)
        gaps = np.append(np.diff(self.lead_s), 1.0)
        return index, np.clip((at_s - self.lead_s[index]) / gaps[index], 0.0, 1.0)


def _expect_shape(name: str, got: tuple[int, ...], expected: tuple[int, ...]) -> None:
    if got != expected:
        raise ValueError(f"{name}: expected shape {expected}, got {got}")
