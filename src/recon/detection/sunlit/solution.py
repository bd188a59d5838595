"""The land in full sun and the level of sun of every keyframe, found from all of them together."""

from dataclasses import replace

import numpy as np

from recon.detection.sunlit.contrast import Contrast, explained
from recon.detection.sunlit.drift import moved
from recon.detection.sunlit.hot_spot import FlatScene, hot_spot
from recon.detection.sunlit.keyframes import Earlier, Keyframe, SunlitLand
from recon.detection.sunlit.land import FloatStack, land_of
from recon.detection.sunlit.levels import (
    LEAST_CELLS,
    FrameLevels,
    Level,
    above,
    apart,
    read,
)
from recon.detection.sunlit.likelihood import Belief, best_contrast, counted, most_likely
from recon.model.shade import MaskMap
from recon.model.units import NS_PER_S

LEAST = 4
"""Keyframes for a median over time."""
KNOWN_SHARE = 0.5
"""Of the keyframes must show a cell."""
ROUNDS = 2
FLAT_VOTE = 0.05
"""Of a keyframe that does not tell by itself, in shares of the cells."""
VOTE_S = 60.0
"""A vote counts half after this time: the drift's errors add up."""
AGREED = 0.25
"""Distance of two levels at which they agree by half."""
AGREED_SPREAD = 0.2, 0.12
"""Errors of light and colour of what keyframes agreed on."""
LAND_WEIGHT, EARLIER_WEIGHT = 0.5, 6.0
"""Of the land found from differences, and of an earlier flight's, in samples, against each cell's
own samples."""
COLOUR_NEAR = 0.25
"""Distance from sun or from shade at which a frame's colour shows it, as a share of the contrast:
haze and thin cloud lie between."""
SUN_WEIGHT, SHADE_WEIGHT, EDGE_WEIGHT = 1.0, 0.5, 0.05
PRIOR_WEIGHT = 0.3
"""Of the usual contrast, as the share of cells of a measured one."""


def solved(
    kept: tuple[Keyframe, ...],
    before: SunlitLand | None,
    earlier: Earlier | None,
    is_locked: bool,
) -> tuple[tuple[Keyframe, ...], SunlitLand | None]:
    """Return the keyframes with their levels, and the land in full sun; None while all are flat."""
    if earlier is None and len(kept) < LEAST:
        return kept, before
    light = np.stack([each.cells.light for each in kept])
    colour = np.stack([each.cells.colour for each in kept])
    seen = np.isfinite(light)
    usual = Contrast() if earlier is None else earlier.land.contrast
    land = _first_land(light, colour, _known(seen, before, earlier), earlier)
    if not land.known.any():
        return kept, before
    land = replace(land, contrast=usual if before is None else before.contrast)
    # Twice at first: what counts as darker depends on the contrast that is measured.
    for _ in range(2 if before is None else 1):
        land, readings = _read_all(light, colour, seen, land, usual)
    levels = _levels(kept, readings, land, before, earlier)
    if levels is None:
        return kept, before
    weight = LAND_WEIGHT if earlier is None else EARLIER_WEIGHT
    land, levels = _alternated(light, colour, land, levels, weight)
    land = replace(land, contrast=_pooled_contrast(light, colour, land, levels, usual))
    if is_locked:
        levels = _steady(kept, levels)
    named = (replace(each, level=level) for each, level in zip(kept, levels, strict=True))
    return tuple(named), land


def _known(seen: MaskMap, before: SunlitLand | None, earlier: Earlier | None) -> MaskMap:
    known: MaskMap = seen.mean(axis=0) >= KNOWN_SHARE
    if len(seen) < LEAST and earlier is not None:
        known &= earlier.land.known
    if before is not None:
        known |= before.known & seen.any(axis=0)
    return known


def _first_land(
    light: FloatStack, colour: FloatStack, known: MaskMap, earlier: Earlier | None
) -> SunlitLand:
    """Return the land as differences show it; as an earlier flight knew it, where it did."""
    own = SunlitLand(land_of(light, known), land_of(colour, known), known, Contrast())
    if earlier is None:
        return own
    both = known & earlier.land.known
    parts = []
    for was, found in ((earlier.land.light, own.light), (earlier.land.colour, own.colour)):
        # Both are known up to a constant.
        off = np.median((was - found)[both]) if both.any() else np.float32(0.0)
        parts.append(np.where(both, was, found + off).astype(np.float32))
    return replace(own, light=parts[0], colour=parts[1])


def _read_all(
    light: FloatStack, colour: FloatStack, seen: MaskMap, land: SunlitLand, usual: Contrast
) -> tuple[SunlitLand, list[FrameLevels | None]]:
    """Return each frame's reading, and the land with the contrast that they show."""
    readings: list[FrameLevels | None] = []
    for one_light, one_colour, one_seen in zip(light, colour, seen, strict=True):
        cells = one_seen & land.known
        if np.count_nonzero(cells) < LEAST_CELLS:
            readings.append(None)
            continue
        parts = (one_light - land.light)[cells], (one_colour - land.colour)[cells]
        readings.append(read(*parts, land.contrast))
    return replace(land, contrast=_contrast(readings, usual)), readings


def _contrast(readings: list[FrameLevels | None], usual: Contrast) -> Contrast:
    """Return the weighted median of the measured contrasts and the usual one."""
    measured = [(each.contrast, each.weight) for each in readings if each and each.contrast]
    values = [*measured, (usual, PRIOR_WEIGHT)]
    weights = np.array([weight for _, weight in values])
    light, colour = (
        _weighted_median(np.array([getattr(one, name) for one, _ in values]), weights)
        for name in ("light", "colour")
    )
    return Contrast(light, colour).bounded()


def _weighted_median(values: FloatStack, weights: FloatStack) -> float:
    order = np.argsort(values)
    total = np.cumsum(weights[order])
    return float(values[order][np.searchsorted(total, 0.5 * total[-1])])


def _levels(
    kept: tuple[Keyframe, ...],
    readings: list[FrameLevels | None],
    land: SunlitLand,
    before: SunlitLand | None,
    earlier: Earlier | None,
) -> list[Level] | None:
    """Return the level of sun of every keyframe; None while nothing tells sun from shade."""
    levels = [None if each is None else each.sun for each in readings]
    if all(level is None for level in levels):
        levels = _carried_over(kept, land, before)
    if all(level is None for level in levels):
        levels = _by_hot_spot(kept, readings, land)
    if all(level is None for level in levels) and earlier is not None:
        levels = _by_colour(readings, earlier)
    if all(level is None for level in levels):
        return None
    return [_agreed(i, kept, readings, levels, land.contrast) for i in range(len(kept))]


def _agreed(
    number: int,
    kept: tuple[Keyframe, ...],
    readings: list[FrameLevels | None],
    levels: list[Level | None],
    contrast: Contrast,
) -> Level:
    """Return the level of sun of a keyframe on which most keyframes near in time agree.

    Each keyframe that tells sun from shade votes for its own level, moved by the camera's drift;
    the more cells show it, the more it counts. So a shadow that stood still long enough to be taken
    for land does not turn a whole view around.
    """
    frame, reading = kept[number], readings[number]
    votes = []
    for other, shown, level in zip(kept, readings, levels, strict=True):
        if level is None:
            continue
        age_s = abs(other.at_ns - frame.at_ns) / NS_PER_S
        share = shown.weight if shown and shown.sun else FLAT_VOTE
        weight = share * float(np.exp2(-age_s / VOTE_S))
        votes.append((weight, moved(level, other.drift, frame.drift)))
    if reading is None:
        return max(votes, key=lambda vote: vote[0])[1]
    choices = [reading.main, above(reading.main, contrast)]
    if reading.sun is not None:
        choices.append(reading.sun)

    def support(choice: Level) -> float:
        return sum(
            weight * float(np.exp2(-((apart(level, choice, contrast) / AGREED) ** 2)))
            for weight, level in votes
        )

    return max(choices, key=support)


def _carried_over(
    kept: tuple[Keyframe, ...], land: SunlitLand, before: SunlitLand | None
) -> list[Level | None]:
    """Return the levels that were known, relative to the new land."""
    if before is None:
        return [None] * len(kept)
    both = land.known & before.known
    light = float(np.median((before.light - land.light)[both]))
    colour = float(np.median((before.colour - land.colour)[both]))
    return [
        None if each.level is None else Level(each.level.light + light, each.level.colour + colour)
        for each in kept
    ]


def _by_hot_spot(
    kept: tuple[Keyframe, ...], readings: list[FrameLevels | None], land: SunlitLand
) -> list[Level | None]:
    """Return the levels of flat frames that are all in sun, or all in shade."""
    light = np.stack([each.cells.light for each in kept])
    found = hot_spot(light, [each.hot_spot for each in kept])
    scene = FlatScene.UNKNOWN if found is None else found.scene
    if scene is FlatScene.UNKNOWN:
        return [None] * len(kept)
    mains = [None if each is None else each.main for each in readings]
    if scene is FlatScene.SUN:
        return list(mains)
    return [None if main is None else above(main, land.contrast) for main in mains]


def _by_colour(readings: list[FrameLevels | None], earlier: Earlier) -> list[Level | None]:
    """Return the level of sun of flat frames by their colour: shade is bluer than sun.

    None where it lies between the two, or the white balance may be another than it was.
    """
    mains = [None if each is None else each.main for each in readings]
    seen = [main.colour for main in mains if main is not None]
    if earlier.sun_colour is None or not seen:
        return [None] * len(mains)
    contrast = earlier.land.contrast
    bluer = float(np.median(seen)) - earlier.sun_colour
    if abs(bluer) < COLOUR_NEAR * contrast.colour:
        return list(mains)
    if abs(bluer - contrast.colour) < COLOUR_NEAR * contrast.colour:
        return [None if main is None else above(main, contrast) for main in mains]
    return [None] * len(mains)


def _alternated(
    light: FloatStack,
    colour: FloatStack,
    land: SunlitLand,
    levels: list[Level],
    first_weight: float,
) -> tuple[SunlitLand, list[Level]]:
    """Return land and levels after rounds of: transmittance, land from it, levels from both."""
    first = land
    is_seen = np.isfinite(light)
    for _ in range(ROUNDS):
        relative = _relative(light, colour, land, levels)
        flat_light, flat_colour = (each.reshape(-1, light.shape[2]) for each in relative)
        in_rows = explained(flat_light, flat_colour, land.contrast)
        found = [each.reshape(light.shape) for each in in_rows]
        weight = _weights(found[0], is_seen)
        total = weight.sum(axis=0) + np.float32(first_weight)
        parts = []
        for own, rest, made in (
            (first.light, relative[0] + land.light, found[1]),
            (first.colour, relative[1] + land.colour, found[2]),
        ):
            samples = np.where(is_seen, rest - made, 0.0)
            summed = np.einsum("krc,krc->rc", weight, samples.astype(np.float32))
            parts.append(((summed + first_weight * own) / total).astype(np.float32))
        land = replace(land, light=parts[0], colour=parts[1])
        levels = _refined(light, colour, land, levels)
    return land, levels


def _relative(
    light: FloatStack, colour: FloatStack, land: SunlitLand, levels: list[Level]
) -> tuple[FloatStack, FloatStack]:
    lights = np.array([level.light for level in levels], np.float32)[:, np.newaxis, np.newaxis]
    colours = np.array([level.colour for level in levels], np.float32)[:, np.newaxis, np.newaxis]
    return light - land.light - lights, colour - land.colour - colours


def _weights(transmittance: FloatStack, is_seen: MaskMap) -> FloatStack:
    weight = np.full(transmittance.shape, EDGE_WEIGHT, dtype=np.float32)
    weight[transmittance < 0.1] = SHADE_WEIGHT
    weight[transmittance > 0.9] = SUN_WEIGHT
    weight[~is_seen] = 0.0
    return weight


def _refined(
    light: FloatStack, colour: FloatStack, land: SunlitLand, levels: list[Level]
) -> list[Level]:
    found = []
    for i, level in enumerate(levels):
        rest_light, rest_colour = light[i] - land.light, colour[i] - land.colour
        cells = np.isfinite(rest_light)
        before = Belief(level, *AGREED_SPREAD)
        belief, _ = most_likely(rest_light[cells], rest_colour[cells], land.contrast, before)
        found.append(belief.level)
    return found


def _pooled_contrast(
    light: FloatStack,
    colour: FloatStack,
    land: SunlitLand,
    levels: list[Level],
    usual: Contrast,
) -> Contrast:
    """Return the contrast that explains the cells of all keyframes together."""
    by_light, by_colour = _relative(light, colour, land, levels)
    cells = np.isfinite(by_light)
    return best_contrast(counted(by_light[cells], by_colour[cells]), usual)


def _steady(kept: tuple[Keyframe, ...], levels: list[Level]) -> list[Level]:
    """Return the levels of a locked camera: only the sun's height changes them, slowly."""
    times = np.array([each.at_ns for each in kept], dtype=np.float64)
    times = (times - times[0]) / NS_PER_S
    table = np.array([(level.light, level.colour) for level in levels])
    if times[-1] < 120.0:
        smooth = np.broadcast_to(np.median(table, axis=0), table.shape)
    else:
        smooth = np.stack([_line(times, column) for column in table.T], axis=1)
    return [Level(float(light), float(colour)) for light, colour in smooth]


def _line(times: FloatStack, values: FloatStack) -> FloatStack:
    """Return a straight line through values, the half farthest from it left out."""
    fitted = np.polyval(np.polyfit(times, values, 1), times)
    off = np.abs(values - fitted)
    near = off <= np.median(off)
    line = np.polyval(np.polyfit(times[near], values[near], 1), times)
    return np.asarray(line)
