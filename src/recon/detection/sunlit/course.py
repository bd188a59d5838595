"""The course of the level of sun over all keyframes, and the contrast that explains it best.

The contrast and all levels are looked for together: a shorter contrast with a lower level explains
thin cloud about as well, so either alone is found wrong. For each contrast that is tried, the best
course of levels is scored (`belief`); the contrast is bettered by a step with each keyframe.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np

from recon.detection.sunlit.belief import (
    Belief,
    Spread,
    best_course,
    lacking,
    near,
    smoothed,
    worth,
)
from recon.detection.sunlit.contrast import TRANSMITTANCES, Contrast, curve
from recon.detection.sunlit.keyframes import Earlier, Keyframe, SunlitLand
from recon.detection.sunlit.land import FloatStack
from recon.detection.sunlit.levels import LEAST_CELLS, Level
from recon.detection.sunlit.likelihood import (
    LIGHT_BINS,
    REACH,
    FloatGrid,
    Spectra,
    counted,
    fits,
    spectra_of,
)
from recon.model.shade import MaskMap
from recon.model.units import NS_PER_S

FEW = 10
"""Keyframes that the contrast is read from: it is that of the whole flight."""
STEPS_A_KEYFRAME = 1
"""Steps by which each keyframe improves the contrast."""
NEIGHBOURS = (-1, 0), (1, 0), (0, -1), (0, 1), (1, 1), (-1, -1)
USUAL_SPREAD, USUAL_WORTH = (0.2, 0.15), 3.0
"""Spread of contrasts between flights: cameras, haze and suns differ. Errors of neighbouring frames
are alike: the usual contrast counts so many times."""
DRIFT_SPREAD, LOCKED_SPREAD = (0.016, 0.002), (0.001, 0.0005)
"""Errors of light and colour after a second by which the change between two frames is known; they
grow with the square root of time."""
HINT_FLOOR = 1e-6
"""Probability that knowledge besides the frames is altogether wrong."""
COLOUR_NEAR = 0.25
"""Distance from sun or from shade at which a view's colour shows it, as a share of the contrast."""
COLOUR_SPREAD, ANY_LIGHT = 0.06, 10.0
"""Spread of the level that an earlier flight had with a locked camera."""
BETWEEN, MOST_BETWEEN = (0.1, 0.9), 0.6
"""Transmittances that are neither full sun nor full shade, and the share of a view's cells from
which edges are as wide as the view."""
UNEVEN = 0.1
"""Standard deviation of such a view's light from which it shows by its slope where it lies."""
REFINED_WITHIN, REFINED_FLOOR = (0.1, 0.06), 1e-9
"""Errors of light and colour of a level that is decided, and how likely it is wrong altogether."""


def change_between(start: Level, end: Level, is_locked: bool) -> Level:
    """Return by what the camera is taken to have changed between two totals of the drift.

    Of light alone: white balance walks slowly, and errors of its drift add up to more.
    """
    return Level(0.0 if is_locked else end.light - start.light, 0.0)


def spread_after(seconds: float, is_locked: bool) -> Spread:
    """Return the errors of light and colour by which a change in this time is known."""
    light, colour = LOCKED_SPREAD if is_locked else DRIFT_SPREAD
    return light * seconds**0.5, colour * seconds**0.5


@dataclass(frozen=True, slots=True, eq=False)
class Stack:
    """Keyframes as arrays (K, R, C), and their times."""

    kept: tuple[Keyframe, ...]
    light: FloatStack
    colour: FloatStack
    seen: MaskMap
    is_locked: bool

    @staticmethod
    def of(kept: tuple[Keyframe, ...], is_locked: bool) -> "Stack":
        """Return the keyframes stacked."""
        light = np.stack([each.cells.light for each in kept])
        colour = np.stack([each.cells.colour for each in kept])
        return Stack(kept, light, colour, np.isfinite(light), is_locked)

    def thinned(self) -> "Stack":
        """Return FEW of the keyframes at most, evenly from the first to the newest."""
        count = len(self.kept)
        some = np.unique(np.linspace(0, count - 1, min(count, FEW)).round().astype(int))
        kept = tuple(self.kept[i] for i in some)
        return replace(
            self, kept=kept, light=self.light[some], colour=self.colour[some], seen=self.seen[some]
        )

    @property
    def gaps_s(self) -> list[float]:
        """Return the times from each to the next."""
        times = [each.at_ns for each in self.kept]
        return [(later - each) / NS_PER_S for each, later in pairwise(times)]

    @property
    def changes(self) -> list[Level]:
        """Return the camera's changes since the newest."""
        newest = self.kept[-1].drift
        return [change_between(newest, each.drift, self.is_locked) for each in self.kept]


@dataclass(frozen=True, slots=True, eq=False)
class Course:
    """What the keyframes' levels follow from, on grids around a middle for each."""

    middles: list[Level]
    shown: Spectra
    worth: FloatStack
    spreads: list[Spread]
    first: FloatGrid
    lights: FloatGrid
    """Shares (K, bins) of each view's cells by light, relative to its middle."""

    @staticmethod
    def over(stack: Stack, land: SunlitLand, earlier: Earlier | None) -> "Course":
        """Return it for keyframes over a land."""
        changes = stack.changes
        newest = _middle(stack, land, changes)
        middles = [newest + by for by in changes]
        shown, weight = [], []
        for i, (middle, after_s) in enumerate(zip(middles, [1e9, *stack.gaps_s], strict=True)):
            cells = stack.seen[i] & land.known
            light = (stack.light[i] - land.light)[cells] - np.float32(middle.light)
            colour = (stack.colour[i] - land.colour)[cells] - np.float32(middle.colour)
            shown.append(counted(light, colour))
            weight.append(worth(after_s) if light.size >= LEAST_CELLS else 0.0)
        first = np.zeros([2 * reach + 1 for reach in REACH], np.float32)
        if earlier is not None and _shows(earlier, newest.colour):
            assert earlier.sun_colour is not None
            there = Level(middles[0].light, earlier.sun_colour)
            first = near(middles[0], there, (ANY_LIGHT, COLOUR_SPREAD), HINT_FLOOR)
        spreads = [spread_after(gap_s, stack.is_locked) for gap_s in stack.gaps_s]
        by_frame = np.array(weight, np.float32)[:, np.newaxis, np.newaxis]
        lights = np.stack(shown).sum(axis=2)
        return Course(middles, spectra_of(shown), by_frame, spreads, first, lights)

    def best_contrast(self, begin: Contrast, usual: Contrast) -> Contrast:
        """Return the contrast with which the best course of levels explains most.

        Found step by step from one to begin with.
        """
        best, score = begin, self._score(begin, usual)
        for _ in range(STEPS_A_KEYFRAME):
            steps = [best.stepped(light, colour) for light, colour in NEIGHBOURS]
            scored = [(self._score(each, usual), each) for each in steps if each != best]
            highest, there = max(scored, key=lambda pair: pair[0])
            if highest <= score:
                break
            best, score = there, highest
        return best

    def _score(self, contrast: Contrast, usual: Contrast) -> float:
        evidence = self.worth * fits(self.shown, contrast)
        off = np.hypot(
            (contrast.light - usual.light) / USUAL_SPREAD[0],
            (contrast.colour - usual.colour) / USUAL_SPREAD[1],
        )
        return best_course(evidence, self.spreads, self.first) - USUAL_WORTH * float(off) ** 2

    def beliefs(self, contrast: Contrast, hints: FloatGrid) -> list[Belief]:
        """Return the belief in each keyframe's level."""
        evidence = self.worth * lacking(fits(self.shown, contrast))
        found = smoothed(evidence + hints, self.spreads, self.first)
        return [Belief(middle, each) for middle, each in zip(self.middles, found, strict=True)]

    def refined(self, contrast: Contrast, levels: Sequence[Level | None]) -> list[Level | None]:
        """Return decided levels (K) again, found from where on the curve each view's cells lie.

        Levels are decided as if full sun and full shade were frequent in every view, which they
        are not where edges are as wide as the view: there the brightest ground would pass for full
        sun. Such a view shows by its slope where on the curve it lies, and needs no such ends.
        """
        has_no_ends = np.array(
            [
                level is not None and _is_between(lights, level.light - middle.light, contrast)
                for lights, level, middle in zip(self.lights, levels, self.middles, strict=True)
            ]
        )[:, np.newaxis, np.newaxis]
        likelihood = np.where(
            has_no_ends, fits(self.shown, contrast, ends_share=0.0), fits(self.shown, contrast)
        )
        near_decided = np.zeros_like(likelihood)
        for i, level in enumerate(levels):
            if level is not None:
                near_decided[i] = near(self.middles[i], level, REFINED_WITHIN, REFINED_FLOOR)
        found = smoothed(self.worth * likelihood + near_decided, self.spreads, self.first)
        return [
            None if level is None else Belief(middle, score).estimate(contrast).level
            for middle, score, level in zip(self.middles, found, levels, strict=True)
        ]


def _is_between(shares: FloatGrid, level: float, contrast: Contrast) -> bool:
    """Return whether most of a view, by its light (bins), is neither in full sun nor full shade."""
    light = LIGHT_BINS - np.float32(level)
    mean = float(shares @ light)
    spread = max(float(shares @ (light - mean) ** 2), 0.0) ** 0.5
    dark, bright = np.interp(BETWEEN, TRANSMITTANCES, curve(contrast)[0])
    between = float(shares[(light > dark) & (light < bright)].sum())
    return spread >= UNEVEN and between >= MOST_BETWEEN


def _middle(stack: Stack, land: SunlitLand, changes: list[Level]) -> Level:
    """Return about the level of the newest keyframe, in the middle of what all of them show."""
    found = []
    for i, by in enumerate(changes):
        cells = stack.seen[i] & land.known
        if np.count_nonzero(cells) < LEAST_CELLS:
            continue
        light = np.median((stack.light[i] - land.light)[cells])
        colour = np.median((stack.colour[i] - land.colour)[cells])
        found.append((light - by.light, colour - by.colour))
    light, colour = np.median(np.array(found), axis=0) if found else (0.0, 0.0)
    return Level(float(light), float(colour))


def _shows(earlier: Earlier, colour: float) -> bool:
    """Return whether most land's colour is that of full sun or full shade in an earlier flight.

    Between them are haze, thin cloud, and another white balance: those show nothing.
    """
    if earlier.sun_colour is None:
        return False
    contrast = earlier.land.contrast.colour
    bluer = colour - earlier.sun_colour
    return min(abs(bluer), abs(bluer - contrast)) < COLOUR_NEAR * contrast
