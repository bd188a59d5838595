"""Projects for OpenDroneMap: chosen photos with their masks, and what they do not say themselves.

How it reads a project is taken from its source (`opendm/photo.py`, `opendm/geo.py`). A photo's
position and height come from EXIF, a missing side of the equator or of Greenwich counts as north
and east; RTK accuracy and angles from XMP, but only from attributes with DJI's usual prefix, and
doubled or turned once for each of several descriptions. A line of `geo.txt` replaces all of these,
those that it leaves out by nothing: a photo without height takes the vertical datum from the whole
project. So photos that say it all themselves have no line, and the others a whole one. Its yaw is
the heading of the picture's top, its pitch 0 straight down.
"""

from collections.abc import Sequence
from pathlib import Path

from recon.product.flight import FlightData
from recon.product.footprint import DOWN_DEG
from recon.product.linked_folder import replace_folder
from recon.product.timing import TimedPhoto
from recon.product.write import FILE_MODE, lon_lat, masked_name
from recon.record.files.atomic_file import replace_file

GEO = "geo.txt"


def write_odm_project(
    project: Path, masks: Path, flight: FlightData, photos: Sequence[TimedPhoto]
) -> None:
    """Write the folder of a run of OpenDroneMap: photos, their masks, and `geo.txt` if needed.

    The photos take the place of those of an earlier run when they are all there; what OpenDroneMap
    has made in the project stays. Raises OSError.
    """
    names = [(timed.photo.path, timed.photo.name) for timed in photos]
    names += [(masks / mask, mask) for mask in (masked_name(name) for _path, name in names)]
    replace_folder(project / "images", names)
    _write_geo(project / GEO, flight, photos)


def _write_geo(path: Path, flight: FlightData, photos: Sequence[TimedPhoto]) -> None:
    lines = [_geo_line(flight, timed) for timed in photos if not timed.photo.is_plain]
    if lines:
        replace_file(path, "\n".join(["EPSG:4326", *lines, ""]).encode(), FILE_MODE)
    else:
        path.unlink(missing_ok=True)


def _geo_line(flight: FlightData, timed: TimedPhoto) -> str:
    """Return the whole line of a photo; its order allows no accuracy without height and angles."""
    photo, aim = timed.photo, timed.view.aim
    longitude_deg, latitude_deg = lon_lat(flight, timed)
    line = f"{photo.name} {longitude_deg:.8f} {latitude_deg:.8f}"
    if photo.absolute_height_m is None:
        return line
    roll_deg = 0.0 if photo.attitude is None else photo.attitude.roll_deg or 0.0
    # Rolled over by 180 degrees is a turn of the picture, which the heading of its top has.
    roll_deg = (roll_deg + 90.0) % 180.0 - 90.0
    pitch_deg = aim.pitch_deg - DOWN_DEG
    line += f" {photo.absolute_height_m:.3f} {aim.yaw_deg:.2f} {pitch_deg:.2f} {roll_deg:.2f}"
    if photo.horizontal_sigma_m is None or photo.vertical_sigma_m is None:
        return line
    return f"{line} {photo.horizontal_sigma_m:.4f} {photo.vertical_sigma_m:.4f}"
