"""What speaks against a photo: blur, exposure, tilt, a place on the way. Pure.

Nothing is left out for it; a person sees the reasons in the table. Detail depends on what lies
below, so that of a photo is compared with its neighbours in time.
"""

from collections import defaultdict
from collections.abc import Callable, Iterator, Sequence
from math import acos, cos, degrees, hypot, radians, tan

import numpy as np
import shapely  # type: ignore[import-untyped, unused-ignore]

from recon.model.arrays import FloatArray
from recon.model.units import NS_PER_S
from recon.product.clock import places_at
from recon.product.coverage import region_of
from recon.product.flight import FlightData
from recon.product.photos.photo import Photo
from recon.product.shot_files import ShotFiles
from recon.product.timing import TimedPhoto

MOST_MOVED_PX = 1.5
"""During its exposure: more is seen as blur. Survey guides ask for half a pixel to one."""
BLANK_DETAIL = 0.002
"""A picture of one colour has 0, noise of a third of a grey level more than this, ground far more:
0.07 in real photos, a tenth of it in one that is very blurred."""
LEAST_DETAIL = 0.4
"""Of the neighbours' median. A shaded photo among sunlit ones keeps half; out of focus by three
pixels of its preview, a fifth is left."""
LEAST_SIZE = 0.5
"""Of the neighbours' median, for files without a preview: compression keeps detail, so a blurred
photo's file is small."""
NEIGHBOURS = 5
"""Photos compared on each side."""
MOST_WHITE, MOST_BLACK = 0.05, 0.5
MOST_TILT_DEG = 20.0
"""Off straight down: then scale and shade differ much within a photo."""
LOW_SHARE = 0.75
"""Of the median height: lower photos are of the way up or down."""
SPEED_OVER_NS = NS_PER_S // 2


def quality_of(flight: FlightData, files: ShotFiles) -> dict[str, str]:
    """Return by a file's name what speaks against it; files against which nothing does are left
    out."""
    reasons: dict[str, list[str]] = defaultdict(list)
    judges = _moved(flight), _exposed, _tilted, _on_the_way(flight, files.photos)
    for timed in files.photos:
        for judge in judges:
            reasons[timed.photo.name] += judge(timed)
    for name, reason in _blurred(files.photos):
        reasons[name].append(reason)
    return {name: "; ".join(found) for name, found in reasons.items() if found}


Judge = Callable[[TimedPhoto], Iterator[str]]


def _moved(flight: FlightData) -> Judge:
    def judge(timed: TimedPhoto) -> Iterator[str]:
        exposure_s = timed.photo.exposure_s
        if exposure_s is None:
            return
        around = timed.at_ns + np.array([-SPEED_OVER_NS, SPEED_OVER_NS])
        (from_e, to_e), (from_n, to_n) = places_at(flight.tracks[timed.serial], around)
        moved_m = hypot(to_e - from_e, to_n - from_n) * exposure_s / (2 * SPEED_OVER_NS / NS_PER_S)
        view = timed.view
        wide_m = 2.0 * abs(view.aim.height_m) * tan(radians(view.across_deg / 2.0))
        moved_px = moved_m / wide_m * max(view.cols, view.rows)
        if moved_px > MOST_MOVED_PX:
            yield f"moved {moved_px:.1f} pixels during its exposure"

    return judge


def _exposed(timed: TimedPhoto) -> Iterator[str]:
    look = timed.photo.look
    if look is None or timed.photo.kind == "thermal":
        return
    if look.white > MOST_WHITE:
        yield f"{100.0 * look.white:.0f} % of it is white"
    if look.black > MOST_BLACK:
        yield f"{100.0 * look.black:.0f} % of it is black"


def _tilted(timed: TimedPhoto) -> Iterator[str]:
    attitude = timed.photo.attitude
    roll_deg = 0.0 if attitude is None else attitude.roll_deg or 0.0
    down = cos(radians(timed.view.aim.pitch_deg + 90.0)) * cos(radians(roll_deg))
    # Rolled over by 180 degrees is a turn of the picture, no tilt.
    tilt_deg = degrees(acos(min(1.0, abs(down))))
    if tilt_deg > MOST_TILT_DEG:
        yield f"looks {tilt_deg:.0f} degrees off straight down"


def _on_the_way(flight: FlightData, photos: Sequence[TimedPhoto]) -> Judge:
    region = region_of(flight.surveys)
    if region is not None:
        shapely.prepare(region)
    heights: dict[str, list[float]] = defaultdict(list)
    for each in photos:
        heights[each.serial].append(each.view.aim.height_m)
    usual_m = {serial: float(np.median(found)) for serial, found in heights.items()}

    def judge(timed: TimedPhoto) -> Iterator[str]:
        height_m, most_m = timed.view.aim.height_m, usual_m[timed.serial]
        if height_m < LOW_SHARE * most_m:
            yield f"taken at {height_m:.0f} m, most at {most_m:.0f} m: on the way"
        corners = timed.view.corners_m
        if region is not None and not region.intersects(shapely.Polygon(corners).convex_hull):
            yield "shows nothing of the surveys' regions: on the way"

    return judge


def _blurred(photos: Sequence[TimedPhoto]) -> Iterator[tuple[str, str]]:
    """Yield names with a reason, of blank photos, and of those with far less detail than the ones
    before and after."""
    series: dict[object, list[TimedPhoto]] = defaultdict(list)
    for each in photos:
        band = each.photo.band.name if each.photo.band else ""
        series[each.serial, each.photo.camera, each.photo.kind, band].append(each)
    for found in series.values():
        looks = [each.photo.look for each in found]
        detail = np.array([np.nan if look is None else look.detail for look in looks])
        small = np.array([_bytes_per_pixel(each.photo) for each in found])
        small[np.isfinite(detail)] = np.nan
        for number in np.flatnonzero(detail < BLANK_DETAIL):
            yield found[number].photo.name, "blank: its picture shows no detail"
        # Blank photos, as of water or snow, are no measure for others.
        detail[detail < BLANK_DETAIL] = np.nan
        said = "blurred: {:.0f} % of its neighbours' detail"
        yield from _poorer(found, detail, LEAST_DETAIL, said)
        said = "perhaps blurred: its file has {:.0f} % of its neighbours' size"
        yield from _poorer(found, small, LEAST_SIZE, said)


def _poorer(
    photos: Sequence[TimedPhoto], values: FloatArray, least: float, said: str
) -> Iterator[tuple[str, str]]:
    for number, each in enumerate(photos):
        usual = _neighbours(values, number)
        if values[number] < least * usual:
            yield each.photo.name, said.format(100.0 * values[number] / usual)


def _bytes_per_pixel(photo: Photo) -> float:
    """Return how much detail a JPEG's compression has kept; NaN for other files."""
    is_jpeg = photo.path.suffix.lower() in (".jpg", ".jpeg")
    if photo.size_bytes is None or not is_jpeg:
        return float("nan")
    return photo.size_bytes / (photo.cols * photo.rows)


def _neighbours(values: FloatArray, number: int) -> float:
    """Return the median of the values known on both sides; 0 where there are few."""
    around = values[max(0, number - NEIGHBOURS) : number + NEIGHBOURS + 1]
    known = around[np.isfinite(around)]
    return float(np.median(known)) if len(known) > NEIGHBOURS else 0.0
