"""The land in full sun and the level of sun of every keyframe, found from all of them together."""

from dataclasses import dataclass, replace

import numpy as np

from recon.detection.sunlit.belief import Belief, near
from recon.detection.sunlit.contrast import Contrast, explained
from recon.detection.sunlit.course import HINT_FLOOR, Course, Stack
from recon.detection.sunlit.hot_spot import FlatScene, hot_spot, with_detail
from recon.detection.sunlit.keyframes import Earlier, Keyframe, SunlitLand
from recon.detection.sunlit.land import FloatStack, land_of
from recon.detection.sunlit.levels import LEAST_CELLS, UNCHANGED, Level, level_of
from recon.detection.sunlit.likelihood import REACH, FloatGrid
from recon.model.shade import MaskMap

LEAST = 4
"""Keyframes for a median over time."""
KNOWN_SHARE = 0.5
"""Share of the keyframes that must show a cell."""
DOUBT = 2e-2
"""A frame is unknown when another level is likelier than this, against the best: an edge of shade
that passes through the view shows within a minute which side is sun. With a twentieth of it such
views stayed unknown for a minute more, and hardly a decision was better."""
LAND_WEIGHT, EARLIER_WEIGHT = 0.5, 6.0
"""Weights of the land found from differences, and of an earlier flight's, in samples, against each
cell's own samples."""
SUN_WEIGHT, SHADE_WEIGHT, EDGE_WEIGHT = 1.0, 0.5, 0.2
HINT_SPREAD = 0.12, 0.07
"""Errors of light and colour of what was known before."""
ALL_ALIKE = 0.05
"""Largest share of cells that differ where everything is in sun, or in shade."""


Hints = list[Level | None]
"""A level for each keyframe, where there is one."""


@dataclass(frozen=True, slots=True, eq=False)
class Solution:
    """What all keyframes together show."""

    keyframes: tuple[Keyframe, ...]
    """The keyframes with their levels."""
    land: SunlitLand | None
    """None while too little was seen."""
    belief: Belief | None
    """Belief in the newest keyframe's level."""
    correction: Level = UNCHANGED
    """Correction of that level, once it is decided: see `Course.refined`."""


def solved(
    kept: tuple[Keyframe, ...],
    before: SunlitLand | None,
    earlier: Earlier | None,
    is_locked: bool,
) -> Solution:
    """Return the keyframes with their levels, and the land in full sun."""
    if earlier is None and len(kept) < LEAST:
        return Solution(kept, before, None)
    stack = Stack.of(kept, is_locked)
    usual = Contrast() if earlier is None else earlier.land.contrast
    land = _first_land(stack, _known(stack.seen, before, earlier), earlier)
    if not land.known.any():
        return Solution(kept, before, None)
    land = replace(land, contrast=usual if before is None else before.contrast)
    few = Course.over(stack.thinned(), land, earlier)
    first = replace(land, contrast=few.best_contrast(land.contrast, usual))
    weight = LAND_WEIGHT if earlier is None else EARLIER_WEIGHT
    beliefs, levels = _levels(stack, first, before, earlier)
    land = first
    if levels[-1] is not None:
        land = _with_samples(stack, first, levels, weight)
        beliefs, levels = _levels(stack, land, before, earlier)
    decided = beliefs[-1].estimate(land.contrast).level
    correction = UNCHANGED if levels[-1] is None else levels[-1] - decided
    if levels[-1] is None:
        levels = _carried_over(stack, land, before)
    named = (replace(each, level=level) for each, level in zip(kept, levels, strict=True))
    return Solution(tuple(named), land, beliefs[-1], correction)


def _known(seen: MaskMap, before: SunlitLand | None, earlier: Earlier | None) -> MaskMap:
    known: MaskMap = seen.mean(axis=0) >= KNOWN_SHARE
    if len(seen) < LEAST and earlier is not None:
        known &= earlier.land.known
    if before is not None:
        known |= before.known & seen.any(axis=0)
    return known


def _first_land(stack: Stack, known: MaskMap, earlier: Earlier | None) -> SunlitLand:
    """Return the land as differences show it; as an earlier flight knew it, where it did."""
    own = SunlitLand(land_of(stack.light, known), land_of(stack.colour, known), known, Contrast())
    if earlier is None:
        return own
    both = known & earlier.land.known
    parts = []
    for was, found in ((earlier.land.light, own.light), (earlier.land.colour, own.colour)):
        # Both are known up to a constant.
        off = np.median((was - found)[both]) if both.any() else np.float32(0.0)
        parts.append(np.where(both, was, found + off).astype(np.float32))
    return replace(own, light=parts[0], colour=parts[1])


def _levels(
    stack: Stack, land: SunlitLand, before: SunlitLand | None, earlier: Earlier | None
) -> tuple[list[Belief], Hints]:
    """Return the belief in every keyframe's level, and the level; None where it is open.

    What the keyframes show by themselves counts first; then what was known before; then what the
    hot spot shows. Minutes of nearly uniform sun can look like uniform shade: where the hot
    spot contradicts, the next one decides.
    """
    course = Course.over(stack, land, earlier)
    for known in (_nothing, _newest_known, _by_hot_spot):
        beliefs = course.beliefs(land.contrast, _hinted(course.middles, known(stack, land, before)))
        found = [belief.estimate(land.contrast) for belief in beliefs]
        levels = [each.level if each.doubt < DOUBT else None for each in found]
        if levels[-1] is not None:
            if not _is_contradicted(stack, land, levels):
                return beliefs, course.refined(land.contrast, levels)
            levels[-1] = None
            beliefs[-1] = replace(beliefs[-1], score=np.zeros_like(beliefs[-1].score))
    return beliefs, levels


def _is_contradicted(stack: Stack, land: SunlitLand, levels: Hints) -> bool:
    """Return whether the hot spot shows sun where all would be in shade, or the other way round."""
    light = _relative(stack, land, levels)[0]
    sunlit = light[np.isfinite(light)] > -0.5 * land.contrast.light
    share = float(sunlit.mean()) if sunlit.size else 0.5
    if ALL_ALIKE < share < 1.0 - ALL_ALIKE:
        return False
    return _flat_scene(stack) is (FlatScene.SUN if share <= ALL_ALIKE else FlatScene.SHADE)


def _hinted(middles: list[Level], hints: Hints) -> FloatGrid:
    """Return what is known besides the evidence, as log likelihoods (K, grid)."""
    found = np.zeros((len(middles), *(2 * reach + 1 for reach in REACH)), np.float32)
    for i, (middle, level) in enumerate(zip(middles, hints, strict=True)):
        if level is not None:
            found[i] = near(middle, level, HINT_SPREAD, HINT_FLOOR)
    return found


def _nothing(stack: Stack, land: SunlitLand, before: SunlitLand | None) -> Hints:
    return [None] * len(stack.kept)


def _newest_known(stack: Stack, land: SunlitLand, before: SunlitLand | None) -> Hints:
    """Return the newest level that was known."""
    hints = _carried_over(stack, land, before)
    known = [i for i, level in enumerate(hints) if level is not None]
    return [level if known and i == known[-1] else None for i, level in enumerate(hints)]


def _carried_over(stack: Stack, land: SunlitLand, before: SunlitLand | None) -> Hints:
    """Return the levels that were known, relative to the new land."""
    both = land.known if before is None else land.known & before.known
    if before is None or not both.any():
        return [None] * len(stack.kept)
    light = float(np.median((before.light - land.light)[both]))
    colour = float(np.median((before.colour - land.colour)[both]))
    by = Level(light, colour)
    return [None if each.level is None else each.level + by for each in stack.kept]


def _by_hot_spot(stack: Stack, land: SunlitLand, before: SunlitLand | None) -> Hints:
    """Return the levels of flat frames that are all in sun, or all in shade."""
    hints: Hints = [None] * len(stack.kept)
    scene = _flat_scene(stack)
    if scene is FlatScene.UNKNOWN:
        return hints
    for i in range(len(hints)):
        cells = stack.seen[i] & land.known
        if np.count_nonzero(cells) < LEAST_CELLS:
            continue
        main = level_of(
            (stack.light[i] - land.light)[cells], (stack.colour[i] - land.colour)[cells]
        )
        by = Contrast(0.0, 0.0) if scene is FlatScene.SUN else land.contrast
        hints[i] = main + Level(by.light, -by.colour)
    return hints


def _flat_scene(stack: Stack) -> FlatScene:
    light = np.stack([with_detail(each.cells) for each in stack.kept])
    found = hot_spot(light, [each.hot_spot for each in stack.kept])
    return FlatScene.UNKNOWN if found is None else found.scene


def _relative(stack: Stack, land: SunlitLand, levels: Hints) -> tuple[FloatStack, FloatStack]:
    """Return light and colour against full sun; NaN where that is open."""
    nan = Level(np.nan, np.nan)
    table = [(each or nan).light for each in levels], [(each or nan).colour for each in levels]
    light, colour = (np.array(column, np.float32)[:, np.newaxis, np.newaxis] for column in table)
    return stack.light - land.light - light, stack.colour - land.colour - colour


def _with_samples(
    stack: Stack, first: SunlitLand, levels: Hints, first_weight: float
) -> SunlitLand:
    """Return the land that is left of all keyframes when their shade is taken out."""
    relative = _relative(stack, first, levels)
    is_known = np.isfinite(relative[0])
    flat_light, flat_colour = (each.reshape(-1, each.shape[2]) for each in relative)
    found = [
        each.reshape(is_known.shape) for each in explained(flat_light, flat_colour, first.contrast)
    ]
    weight = _weights(found[0], is_known)
    total = weight.sum(axis=0) + np.float32(first_weight)
    parts = []
    for own, rest, made in (
        (first.light, relative[0] + first.light, found[1]),
        (first.colour, relative[1] + first.colour, found[2]),
    ):
        samples = np.where(is_known, rest - made, 0.0)
        summed = np.einsum("krc,krc->rc", weight, samples.astype(np.float32))
        parts.append(((summed + first_weight * own) / total).astype(np.float32))
    return replace(first, light=parts[0], colour=parts[1])


def _weights(transmittance: FloatStack, is_known: MaskMap) -> FloatStack:
    weight = np.full(transmittance.shape, EDGE_WEIGHT, dtype=np.float32)
    weight[transmittance < 0.1] = SHADE_WEIGHT
    weight[transmittance > 0.9] = SUN_WEIGHT
    weight[~is_known] = 0.0
    return weight
