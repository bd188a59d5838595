"""Real photos, timed by their own clocks and statements: no flight record exists of them."""

from pathlib import Path

from recon.geo import enu_from_geo
from recon.model.geo import GeoPoint, LocalFrame
from recon.product.footprint import Aim, PhotoView
from recon.product.headings import AIRCRAFT, GIMBAL, best_guess_deg
from recon.product.photos.photo import read_photo_facts
from recon.product.timing import TimedPhoto

FIELDS_DEG = {"thermal-mavic2": 50.0, "beach-phantom3": 82.0}
"""Fields of view along the longer side: of the first EXIF says nothing."""


def timed_of(folder: Path) -> list[TimedPhoto]:
    """Return the photos of a folder."""
    facts = [read_photo_facts(path, path.name) for path in sorted(folder.glob("*.JPG"))]
    frame = LocalFrame(GeoPoint(facts[0].latitude_deg, facts[0].longitude_deg, 0.0))
    found = []
    for photo in facts:
        (enu_m,) = enu_from_geo(frame, [photo.latitude_deg], [photo.longitude_deg], 0.0)
        assert photo.attitude is not None
        assert photo.height_above_takeoff_m is not None
        assert photo.flight_yaw_deg is not None
        headings = {GIMBAL: photo.attitude.yaw_deg, AIRCRAFT: photo.flight_yaw_deg}
        height_m = photo.height_above_takeoff_m
        aim = Aim(float(enu_m[0]), float(enu_m[1]), height_m, best_guess_deg(headings))
        view = PhotoView(aim, FIELDS_DEG[folder.name], photo.cols, photo.rows)
        found.append(TimedPhoto(photo, "D", photo.clock_ns, 0.1, view, height_m, headings))
    return found
