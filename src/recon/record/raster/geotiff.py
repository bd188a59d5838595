"""Ground images as GeoTIFF, which QGIS and its like open at the right place.

The file's reference system is a transverse Mercator centred on the site's origin, with the scale
that belongs to the origin's height: within 1 km of the origin its eastings and northings are the
local frame's east and north to better than a millimetre, so no pixel is resampled, and every
program that reads GeoTIFF knows the projection.
"""

import os
from pathlib import Path

import numpy as np

from recon.geo.local_frame import meridian_radius_m, prime_vertical_radius_m
from recon.model.errors import RecordError
from recon.model.geo import LocalFrame
from recon.model.imagery import GroundImage

TILE_SIDE_PX = 256
CAPTURED_UTC_TAG = "RECON_CAPTURED_UTC"
"""ISO 8601."""
WGS84 = (
    'GEOGCS["WGS 84",DATUM["WGS_1984",SPHEROID["WGS 84",6378137,298.257223563]],'
    'PRIMEM["Greenwich",0],UNIT["degree",0.0174532925199433],AUTHORITY["EPSG","4326"]]'
)


def projected_crs(frame: LocalFrame) -> str:
    """Return the local frame's map projection as WKT, with a name that GIS programs show."""
    origin = frame.origin
    return (
        f'PROJCS["Recon site frame at {origin.latitude_deg:.5f}, {origin.longitude_deg:.5f}",'
        f"{WGS84},"
        'PROJECTION["Transverse_Mercator"],'
        f'PARAMETER["latitude_of_origin",{origin.latitude_deg!r}],'
        f'PARAMETER["central_meridian",{origin.longitude_deg!r}],'
        f'PARAMETER["scale_factor",{height_scale(frame):.12f}],'
        'PARAMETER["false_easting",0],PARAMETER["false_northing",0],'
        'UNIT["metre",1],AXIS["Easting",EAST],AXIS["Northing",NORTH]]'
    )


def height_scale(frame: LocalFrame) -> float:
    """Return how much longer a distance is at the origin's height than on the ellipsoid."""
    latitude_rad = np.deg2rad(np.array([frame.origin.latitude_deg]))
    radius_m = np.sqrt(meridian_radius_m(latitude_rad) * prime_vertical_radius_m(latitude_rad))
    return 1.0 + frame.origin.ellipsoid_height_m / float(radius_m[0])


def geotiff_bytes(
    image: GroundImage, *, captured_utc: str | None = None, rms_px: float | None = None
) -> bytes:
    """Return a GeoTIFF file: red, green, blue and alpha (0 where invalid), uint8.

    Tags RECON_* carry the frame's id, capture time in station time (ns), registration state and
    residual, cell size; `captured_utc` (ISO 8601) and the marked frame's `rms_px` when given.
    Raises `RecordError` when the image's arrays do not fit its grid.
    """
    from rasterio.enums import ColorInterp
    from rasterio.io import MemoryFile
    from rasterio.transform import Affine

    _refuse_misfit(image)
    grid = image.grid
    profile = {
        "driver": "GTiff",
        "height": grid.rows,
        "width": grid.cols,
        "count": 4,
        "dtype": "uint8",
        "crs": projected_crs(grid.frame),
        "transform": Affine(grid.cell_m, 0.0, grid.west_m, 0.0, -grid.cell_m, grid.north_m),
        "compress": "deflate",
        "predictor": 2,
        "photometric": "RGB",
    }
    if min(grid.rows, grid.cols) >= TILE_SIDE_PX:
        profile |= {"tiled": True, "blockxsize": TILE_SIDE_PX, "blockysize": TILE_SIDE_PX}
    with MemoryFile() as memory:
        with memory.open(**profile) as dataset:
            dataset.colorinterp = (
                ColorInterp.red,
                ColorInterp.green,
                ColorInterp.blue,
                ColorInterp.alpha,
            )
            dataset.write(np.moveaxis(image.rgb, 2, 0), indexes=[1, 2, 3])
            dataset.write(np.where(image.valid, np.uint8(255), np.uint8(0)), 4)
            dataset.update_tags(**_tags(image, captured_utc, rms_px))
        return bytes(memory.read())


def write_ground_image(
    path: Path,
    image: GroundImage,
    *,
    captured_utc: str | None = None,
    rms_px: float | None = None,
) -> None:
    """Write `geotiff_bytes` to a file, whole or not at all; raises `RecordError`."""
    data = geotiff_bytes(image, captured_utc=captured_utc, rms_px=rms_px)
    part = path.with_name(path.name + ".part")
    try:
        with part.open("wb") as file:
            file.write(data)
            file.flush()
            os.fsync(file.fileno())
        part.replace(path)
    except OSError as problem:
        part.unlink(missing_ok=True)
        raise RecordError(
            f"{path}: expected to write {len(data)} bytes, got: {problem.strerror or problem}; "
            "check that the folder exists and has room"
        ) from problem


def _tags(image: GroundImage, captured_utc: str | None, rms_px: float | None) -> dict[str, str]:
    tags = {
        "RECON_FRAME_ID": str(image.frame_id),
        "RECON_CAPTURED_AT_NS": str(image.captured_at_ns),
        "RECON_REGISTRATION": image.registration.value,
        "RECON_CELL_M": f"{image.grid.cell_m:g}",
        "RECON_GROUND_ALTITUDE_M": f"{image.grid.frame.origin.ellipsoid_height_m:g}",
    }
    if image.registration_residual_m is not None:
        tags["RECON_REGISTRATION_RESIDUAL_M"] = f"{image.registration_residual_m:.3f}"
    if captured_utc is not None:
        tags[CAPTURED_UTC_TAG] = captured_utc
    if rms_px is not None:
        tags["RECON_MARKED_FRAME_RMS_PX"] = f"{rms_px:.3f}"
    return tags


def _refuse_misfit(image: GroundImage) -> None:
    size = (image.grid.rows, image.grid.cols)
    fits = image.rgb.shape == (*size, 3) and image.valid.shape == size
    if not fits or image.rgb.dtype != np.uint8:
        raise RecordError(
            f"ground image {image.frame_id}: expected {size[0]} x {size[1]} cells of RGB uint8 "
            f"and as many of validity, got {image.rgb.shape} of {image.rgb.dtype} and "
            f"{image.valid.shape}"
        )
