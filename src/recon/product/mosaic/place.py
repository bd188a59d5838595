"""Photos with their cameras and their light, and the raster that they make."""

from collections.abc import Iterable, Sequence
from concurrent.futures import ThreadPoolExecutor

import numpy as np
import shapely  # type: ignore[import-untyped, unused-ignore]

from recon.model.errors import RecordError
from recon.product.coverage import region_of
from recon.product.flight import FlightData
from recon.product.footprint import PhotoView
from recon.product.mosaic.cameras import Camera, camera_of_view
from recon.product.mosaic.choice import PlacedPhoto
from recon.product.mosaic.ground import LevelGround, MosaicGround
from recon.product.mosaic.light import light_on
from recon.product.mosaic.plan import MosaicPlan, plan_over, round_m
from recon.product.progress import Over
from recon.product.sun_at import SunHistory
from recon.product.timing import TimedPhoto

PREVIEW_PIXELS = 4.0
"""Pixels of a photo, each way, in one of a preview: its place is known to decimetres, and photos
are decoded in a third of the time."""


def preview_cameras(
    flight: FlightData,
    photos: Sequence[TimedPhoto],
    views: Sequence[PhotoView],
    ground: MosaicGround,
) -> list[Camera]:
    """Return the cameras of photos over a ground, by their `views` as stated or registered.

    Heights above takeoff become heights above the site's origin by the ground where the vehicle
    took off; over level ground they stay what they are.
    """
    if isinstance(ground, LevelGround):
        return [camera_of_view(view, view.aim.height_m) for view in views]
    takeoff_m = {serial: _takeoff_up_m(flight, serial, ground) for serial in flight.tracks}
    cameras = []
    for timed, view in zip(photos, views, strict=True):
        # What registration has changed of the height above ground holds for this one too.
        changed_m = view.aim.height_m - timed.view.aim.height_m
        up_m = takeoff_m[timed.serial] + timed.height_above_takeoff_m + changed_m
        cameras.append(camera_of_view(view, up_m))
    return cameras


def _takeoff_up_m(flight: FlightData, serial: str, ground: MosaicGround) -> float:
    track = flight.tracks[serial]
    lowest = int(np.nanargmin(np.where(np.isfinite(track.height_m), track.height_m, np.inf)))
    east_m, north_m = track.east_m[[lowest]], track.north_m[[lowest]]
    up_m = float(ground.up_m(east_m, north_m)[0, 0])
    if not np.isfinite(up_m):
        name = flight.names.get(serial, serial)
        raise RecordError(
            f"expected the site's elevation to reach to where {name} took off, {east_m[0]:.0f} m "
            f"east and {north_m[0]:.0f} m north of the site's origin, got none there: leave out "
            "--site to take the ground as level"
        )
    return up_m


def placed_photos(
    photos: Sequence[TimedPhoto],
    cameras: Iterable[Camera],
    history: SunHistory,
    ground: MosaicGround,
    over: Over,
    threads: int = 2,
) -> list[PlacedPhoto]:
    """Return photos with their light, as the shade maps have it at their times."""
    bounds_m = ground.bounds_m

    def placed(pair: tuple[TimedPhoto, Camera]) -> PlacedPhoto:
        timed, camera = pair
        footprint = camera.footprint(*bounds_m)
        return PlacedPhoto(timed, camera, light_on(history, timed.at_ns, footprint), footprint)

    with ThreadPoolExecutor(threads) as pool:
        pairs = zip(photos, cameras, strict=True)
        return list(over(pool.map(placed, pairs), "light on photos", len(photos)))


def plan_of(
    flight: FlightData,
    photos: Sequence[PlacedPhoto],
    ground: MosaicGround,
    resolution_m: float | None,
    pixels: float = PREVIEW_PIXELS,
) -> MosaicPlan:
    """Return the raster: of the surveys' regions, or of all that photos show if none was flown.

    Without a resolution stated, a pixel is `pixels` of the photos' each way, rounded up. Raises
    `RecordError`.
    """
    area = region_of(flight.surveys)
    if area is None:
        area = region_shown(photos)
    if resolution_m is None:
        middle_m = sum(ground.bounds_m) / 2.0
        sizes_m = [photo.camera.metres_per_pixel(middle_m) for photo in photos]
        resolution_m = round_m(max(pixels * float(np.median(sizes_m)), 1e-3))
    return plan_over(area, flight.frame, resolution_m)


def region_shown(photos: Sequence[PlacedPhoto]) -> shapely.Geometry:
    """Return the ground that photos show."""
    return shapely.union_all([photo.footprint for photo in photos])
