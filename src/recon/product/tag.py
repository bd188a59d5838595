"""The sun on the photos of a flight: each one's share and mask, and the photos to keep. Pure."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt
import shapely  # type: ignore[import-untyped, unused-ignore]

from recon.model.arrays import BoolArray, IntArray
from recon.model.errors import RecordError
from recon.model.geo import GroundGrid
from recon.model.shade import SUNLIT_TRANSMITTANCE
from recon.product.choose import choose, views_for
from recon.product.coverage import (
    ENOUGH_VIEWS,
    Ground,
    cells_on,
    ground_of,
    incidence,
    light_of_cells,
    region_of,
    region_of_views,
    to_fly_again,
)
from recon.product.flight import FlightData
from recon.product.footprint import sun_on_photo
from recon.product.sun_at import SunHistory, Sunshine
from recon.product.timing import TimedPhoto

ByteMap = npt.NDArray[np.uint8]
Light = tuple[Sunshine, GroundGrid]
"""The sun on the ground around a photo, and that ground's grid."""

SUNLIT_SHARE = 0.9
"""Share of a photo's known ground for the photo to be called sunlit."""
MASK_SCALE = 8
"""A mask's pixel is 8 x 8 of the photo's: decimetres on the ground, edges are known to metres."""
LEAST_KNOWN = 0.5
"""Share of a photo's ground: with less known, the photo is called unknown."""
WHITE, BLACK = 255, 0
"""Values of a mask: used and excluded."""


@dataclass(frozen=True, slots=True)
class PhotoTag:
    """What was found for one photo."""

    name: str
    sunlit: float
    """Share of its known ground in sun, 0 to 1; NaN where nothing is known."""
    confidence: float
    """0 to 1: the mean over all of its ground."""
    known: float
    """Share of its ground that the shade maps show."""
    is_by_sensor: bool = False
    """Whether its light is what the camera's sun sensor states, for want of shade maps."""

    def state(self, sunlit_share: float) -> str:
        """Return sunlit, shaded, mixed or unknown."""
        if not (self.is_by_sensor or self.known >= LEAST_KNOWN):
            return "unknown"
        if self.sunlit >= sunlit_share:
            return "sunlit"
        return "shaded" if self.sunlit <= 1.0 - sunlit_share else "mixed"


@dataclass(frozen=True, slots=True, eq=False)
class Selection:
    """The shortest list of photos, and what no photo shows in sun."""

    ground: Ground
    shown: IntArray
    """(N,): photos of each cell inside."""
    sunlit: IntArray
    """(N,): of them, those with the cell in sun."""
    chosen: tuple[str, ...]
    bound: int
    views: int
    again: tuple[shapely.Polygon, ...]


@dataclass(frozen=True, slots=True, eq=False)
class Shown:
    """The cells that a photo shows (N,), and of each whether it lies in sun, and in unknown
    light."""

    cells: IntArray
    is_lit: BoolArray
    is_unknown: BoolArray


def tag_photo(timed: TimedPhoto, light: Light) -> tuple[PhotoTag, ByteMap]:
    """Return a photo's tag, and its mask (rows, cols) at 1 / `MASK_SCALE`: white in sun.

    Ground that is not known stays white: a mask removes what is known to be in shade.
    """
    view = timed.view
    small = replace(
        view,
        cols=max(1, round(view.cols / MASK_SCALE)),
        rows=max(1, round(view.rows / MASK_SCALE)),
    )
    sun = sun_on_photo(*light, small)
    is_known = sun.confidence > 0.0
    is_lit = sun.transmittance >= SUNLIT_TRANSMITTANCE
    known = float(is_known.mean())
    sunlit = float(is_lit[is_known].mean()) if is_known.any() else float("nan")
    mask = np.where(is_known & ~is_lit, np.uint8(BLACK), np.uint8(WHITE))
    name = timed.photo.name
    return PhotoTag(name, sunlit, float(sun.confidence.mean()), known), mask


def shown_by(timed: TimedPhoto, light: Light, ground: Ground) -> Shown:
    """Return the cells that a photo shows, and their light."""
    cells = cells_on(timed.view, ground)
    return Shown(cells, *light_of_cells(cells, ground, *light))


def light_around(timed: TimedPhoto, history: SunHistory) -> Light:
    """Return the sun around a photo."""
    if timed.view.shows_sky:
        return history.at(timed.at_ns), history.grid
    return history.around(timed.at_ns, timed.view.corners_m)


def sun_history(flight: FlightData, *, may_be_empty: bool = False) -> SunHistory:
    """Return the sun of a flight by time; raises `RecordError` without shade maps, unless it may
    know nothing."""
    if flight.grid is None or not flight.maps:
        if may_be_empty:
            return SunHistory(GroundGrid(flight.frame, 0.0, 0.0, 1.0, 1, 1), ())
        raise RecordError(
            f"{flight.path}: expected a flight with shade maps, got none: no imaging drone, or no "
            "frame of it could be used"
        )
    return SunHistory(flight.grid, flight.maps)


def ground_of_flight(flight: FlightData, photos: Sequence[TimedPhoto]) -> Ground:
    """Return the cells of the surveys' regions, without any those that photos show."""
    area = region_of(flight.surveys)
    if area is None:
        area = region_of_views([each.view for each in photos])
    return ground_of(area, flight.frame)


def select(
    photos: Sequence[TimedPhoto], shown_by_each: Sequence[Shown], ground: Ground, overlap: float
) -> Selection:
    """Return the photos to keep and the ground to fly again.

    `overlap` is wanted of neighbouring photos, along and across.
    """
    cells = len(ground.centres_m)
    shown = np.zeros(cells, dtype=np.int64)
    for each in shown_by_each:
        shown[each.cells] += 1
    shows = incidence([each.cells[each.is_lit] for each in shown_by_each], cells)
    sunlit = np.asarray(shows.sum(axis=0)).ravel().astype(np.int64)
    # Where too few photos are surely in sun, those in unknown light count too: some may be.
    is_poor = sunlit < ENOUGH_VIEWS
    unclear = [each.cells[each.is_unknown] for each in shown_by_each]
    shows = shows + incidence([each[is_poor[each]] for each in unclear], cells)
    views = views_for(overlap)
    choice = choose(shows, views)
    names = tuple(photos[number].photo.name for number in choice.photos.tolist())
    again = tuple(to_fly_again(ground, shown, sunlit))
    return Selection(ground, shown, sunlit, names, choice.bound, views, again)
