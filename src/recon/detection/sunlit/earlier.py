"""The land in full sun as an earlier flight saw it, adopted by the next one.

Theory of operation: a reference is of one camera, at one place, with the sun in one direction: then
the land's own light, the lens and the hot spot are the same. It is adopted with the first frame
whose cells it explains, and is the land from there on, until the flight has seen enough of its own.

An edge of shade in the first frame is then seen as one at once. A frame without an edge is still
all sun or all shade: its light shows nothing, because exposure is another one in each flight. Its
colour does where exposure and white balance are locked in both flights: shade is bluer than sun.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from math import acos, degrees, dist

import numpy as np
import numpy.typing as npt

from recon.detection.sunlit.belief import WORTH_S, Belief
from recon.detection.sunlit.colour import CellColour
from recon.detection.sunlit.contrast import COLOUR_NOISE, LIGHT_NOISE, Contrast, explained
from recon.detection.sunlit.keyframes import Earlier, Keyframe, SunlitLand
from recon.detection.sunlit.levels import LEAST_CELLS, Level, Values, level_of
from recon.model.geo import GroundGrid
from recon.model.imagery import GroundImage
from recon.model.shade import SunlitReference
from recon.model.units import NS_PER_S

LEAST_KEYFRAMES, LEAST_S = 12, 300.0
"""What a flight must have seen for its land to be worth keeping: each cell mostly in sun."""
NEAREST_SUN_DEG = 12.0
"""Twice the hot spot's width; the sun moves so far in 50 minutes."""
NEAREST_M = 30.0
"""Distance of the cameras: beyond, the lens's own light falls on other cells."""
NOISES = 3.0
"""Standard deviations of light and colour within which a cell is explained."""
LEAST_EXPLAINED = 0.8
"""Share of a frame's cells: a field that was mown or ploughed since explains far fewer."""


@dataclass(frozen=True, slots=True, eq=False)
class AdoptedReference:
    """The reference that a flight adopts, if any fits, and what came of looking for it."""

    earlier: Earlier | None
    note: str
    """One sentence for the operator; empty without any reference."""


def reference_of(
    kept: Sequence[Keyframe], land: SunlitLand | None, image: GroundImage, grid: GroundGrid
) -> SunlitReference | None:
    """Return what a flight has learned; None while that is too little, or without the sun."""
    levels = [each.level.colour for each in kept if each.level is not None]
    if land is None or len(levels) < LEAST_KEYFRAMES or image.toward_sun_enu is None:
        return None
    if (kept[-1].at_ns - kept[0].at_ns) / NS_PER_S < LEAST_S:
        return None
    missing = np.float32(np.nan)
    return SunlitReference(
        serial=image.serial,
        grid=grid,
        toward_sun_enu=_three(image.toward_sun_enu),
        camera_enu_m=_three(image.pose.position_enu_m),
        light=np.where(land.known, land.light, missing),
        colour=np.where(land.known, land.colour, missing),
        light_contrast=land.contrast.light,
        colour_contrast=land.contrast.colour,
        sun_colour=float(np.median(levels)),
        is_exposure_locked=image.exposure_locked,
    )


def adopted_reference(
    references: Sequence[SunlitReference], image: GroundImage, grid: GroundGrid, coarse: CellColour
) -> AdoptedReference:
    """Return the reference of the sun nearest to a frame's, if it fits the frame."""
    if not references:
        return AdoptedReference(None, "")
    if image.toward_sun_enu is None:
        return AdoptedReference(
            None, "no earlier flight is used: the direction of the sun is unknown"
        )
    sun, camera = _three(image.toward_sun_enu), _three(image.pose.position_enu_m)
    fitting = [
        (_angle_deg(each.toward_sun_enu, sun), each)
        for each in references
        if each.serial == image.serial
        and each.grid == grid
        and each.light.shape == coarse.light.shape
        and dist(each.camera_enu_m, camera) <= NEAREST_M
    ]
    if not fitting:
        text = (
            f"none of {len(references)} earlier flights is used: expected one of {image.serial} on "
            f"this ground grid, with its camera within {NEAREST_M:.0f} m of where it is now"
        )
        return AdoptedReference(None, text)
    off_deg, nearest = min(fitting, key=lambda each: each[0])
    if off_deg > NEAREST_SUN_DEG:
        text = (
            "no earlier flight is used: expected one with the sun within "
            f"{NEAREST_SUN_DEG:.0f} degrees of where it is now, the nearest is {off_deg:.0f} off"
        )
        return AdoptedReference(None, text)
    earlier = _earlier(nearest, image.exposure_locked)
    share = _explained_share(coarse, earlier.land)
    if share < LEAST_EXPLAINED:
        text = (
            f"the earlier flight is not used: it explains {share:.0%} of the land in view, "
            f"expected {LEAST_EXPLAINED:.0%}; the land or the light has changed"
        )
        return AdoptedReference(None, text)
    text = f"of an earlier flight, with the sun {off_deg:.0f} degrees from where it is now"
    return AdoptedReference(earlier, text)


def _earlier(reference: SunlitReference, is_locked: bool) -> Earlier:
    contrast = Contrast(reference.light_contrast, reference.colour_contrast).bounded()
    known = np.isfinite(reference.light) & np.isfinite(reference.colour)
    is_comparable = is_locked and reference.is_exposure_locked
    return Earlier(
        SunlitLand(reference.light, reference.colour, known, contrast),
        reference.sun_colour if is_comparable else None,
    )


def _explained_share(coarse: CellColour, land: SunlitLand) -> float:
    """Return the share of a frame's cells that lie between sun and shade over a land.

    At the level of sun that explains most.
    """
    cells = coarse.seen & land.known
    if np.count_nonzero(cells) < LEAST_CELLS:
        return 0.0
    light, colour = (coarse.light - land.light)[cells], (coarse.colour - land.colour)[cells]
    unknown = np.zeros((1, 1), np.float32)
    belief = Belief(level_of(light, colour), unknown).seen(light, colour, land.contrast, WORTH_S)
    return _share_near(light, colour, belief.estimate(land.contrast).level, land.contrast)


def _share_near(light: Values, colour: Values, level: Level, contrast: Contrast) -> float:
    by_light, by_colour = light - np.float32(level.light), colour - np.float32(level.colour)
    _, near_light, near_colour = explained(by_light[np.newaxis], by_colour[np.newaxis], contrast)
    off = np.hypot(
        (by_light - near_light[0]) / LIGHT_NOISE, (by_colour - near_colour[0]) / COLOUR_NOISE
    )
    return float((off < NOISES).mean())


def _angle_deg(one: Sequence[float], other: Sequence[float]) -> float:
    cosine = sum(a * b for a, b in zip(one, other, strict=True))
    return degrees(acos(max(-1.0, min(1.0, cosine))))


def _three(values: npt.NDArray[np.float64]) -> tuple[float, float, float]:
    east, north, up = (float(each) for each in values)
    return east, north, up
