"""Photos of calibrated reflectance panels, taken on the ground before and after a flight.

Mosaics do not want them, but who works out reflectance from bands needs them. A camera that knows
panels marks them itself. Others are looked for among the photos that were not tagged, near the
place where a vehicle took off or landed: a panel has a square code beside it, or is itself a bright
even square on the ground.
"""

import csv
import io
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import cv2
import numpy as np
import numpy.typing as npt

from recon.geo import enu_from_geo
from recon.product.flight import FlightData
from recon.product.linked_folder import replace_folder
from recon.product.photos.photo import Photo
from recon.product.photos.shots import CameraShot
from recon.product.write import FILE_MODE, cell
from recon.record.files.atomic_file import replace_file

GreyMap = npt.NDArray[np.uint8]

NEAR_M = 60.0
"""From takeoff or landing."""
MOST_LOOKED_AT = 60
LONGEST_PX = 1280
PANELS, TABLE = "panels", "panels.csv"
LEAST_SHARE, MOST_SHARE = 0.01, 0.6
"""Share of the picture that a panel fills when it is held as its maker says."""
MOST_UNEVEN = 0.08
"""Standard deviation within a panel by its brightness: grass and soil have several times as
much."""
LEAST_BRIGHTER = 1.3
"""Than what lies around it: panels reflect about half of the light, crops less in most bands."""
CORNER_SHARE = 0.04
"""Of a contour's length: how far it may be from a polygon of four corners."""


@dataclass(frozen=True, slots=True)
class PanelShot:
    """A shot of a panel: its files, its panel's serial number where known, and how it was found."""

    shot: CameraShot
    serial: str
    found_by: str


def marked_panels(shots: Sequence[CameraShot]) -> list[PanelShot]:
    """Return the shots whose camera found a panel on one of their files."""
    found = []
    for shot in shots:
        marks = [photo.panel for photo in shot.files if photo.panel is not None]
        if marks:
            serial = next((mark.serial for mark in marks if mark.serial), "")
            found.append(PanelShot(shot, serial, "the camera's mark"))
    return found


def panels_on_ground(
    flight: FlightData,
    shots: Iterable[CameraShot],
    picture: Callable[[Path], GreyMap | None],
) -> list[PanelShot]:
    """Return those of some shots that show a panel: of multispectral cameras, near a takeoff."""
    near = [shot for shot in shots if _has_bands(shot) and _is_near_takeoff(flight, shot.lead)]
    found = []
    for shot in near[:MOST_LOOKED_AT]:
        grey = picture(shot.lead.path)
        if grey is None:
            continue
        serial = code_on(grey)
        if serial:
            found.append(PanelShot(shot, serial, "its code"))
        elif shows_square(grey):
            found.append(PanelShot(shot, "", "its square"))
    return found


def _has_bands(shot: CameraShot) -> bool:
    return any(photo.kind == "band" for photo in shot.files)


def _is_near_takeoff(flight: FlightData, photo: Photo) -> bool:
    height_m = flight.frame.origin.ellipsoid_height_m
    place = enu_from_geo(flight.frame, [photo.latitude_deg], [photo.longitude_deg], height_m)[0, :2]
    ends = [
        (track.east_m[end], track.north_m[end])
        for track in flight.tracks.values()
        for end in (0, -1)
    ]
    return any(bool(np.hypot(*(place - end)) <= NEAR_M) for end in ends)


def code_on(grey: GreyMap) -> str:
    """Return the text of the square code on a picture; empty without one."""
    try:
        text, _corners, _straight = cv2.QRCodeDetector().detectAndDecode(grey)
    except cv2.error:
        return ""
    return "".join(each for each in text if each.isprintable())[:64]


def shows_square(grey: GreyMap) -> bool:
    """Return whether a picture (rows, cols) has a bright even area with four corners."""
    _level, bright = cv2.threshold(grey, 0, 255, cv2.THRESH_BINARY | cv2.THRESH_OTSU)
    contours, _tree = cv2.findContours(bright, cv2.RETR_LIST, cv2.CHAIN_APPROX_SIMPLE)
    return any(_is_panel(grey, each) for each in contours)


def _is_panel(grey: GreyMap, contour: Any) -> bool:
    share = cv2.contourArea(contour) / grey.size
    if not LEAST_SHARE <= share <= MOST_SHARE:
        return False
    corners = cv2.approxPolyDP(contour, CORNER_SHARE * cv2.arcLength(contour, True), True)
    if len(corners) != 4 or not cv2.isContourConvex(corners):
        return False
    inside = np.zeros_like(grey)
    cv2.fillPoly(inside, [corners], 1)
    within = grey[cv2.erode(inside, np.ones((5, 5), np.uint8)) > 0]
    if len(within) == 0:
        return False
    is_even = within.std() <= MOST_UNEVEN * within.mean()
    return bool(is_even and within.mean() >= LEAST_BRIGHTER * np.median(grey[inside == 0]))


def picture_of(path: Path) -> GreyMap | None:
    """Return a photo's grey picture in 8 bits, spread over their range; None if it is damaged."""
    found = cv2.imread(str(path), cv2.IMREAD_ANYDEPTH | cv2.IMREAD_GRAYSCALE)
    if found is None or found.dtype not in (np.uint8, np.uint16):
        return None
    shrink = LONGEST_PX / max(found.shape)
    if shrink < 1.0:
        found = cv2.resize(found, None, fx=shrink, fy=shrink, interpolation=cv2.INTER_AREA)
    most = max(float(np.percentile(found, 99.5)), 1.0)
    grey: GreyMap = np.clip(found * (255.0 / most), 0.0, 255.0).astype(np.uint8)
    return grey


def write_panels(folder: Path, panels: Sequence[PanelShot], first_ns: int) -> None:
    """Write the photos of panels, and a table of them; raises OSError.

    `first_ns` is the camera clock's time of the flight's first photo: panels are before or after.
    """
    photos = [photo for panel in panels for photo in panel.shot.files]
    replace_folder(folder, [(photo.path, photo.name) for photo in photos])
    text = io.StringIO()
    rows = csv.writer(text, lineterminator="\n")
    rows.writerow(("name", "shot", "band", "when", "panel", "albedo", "found_by"))
    for panel in panels:
        for photo in panel.shot.files:
            rows.writerow(_row(panel, photo, first_ns))
    replace_file(folder / TABLE, text.getvalue().encode(), FILE_MODE)


def _row(panel: PanelShot, photo: Photo, first_ns: int) -> tuple[str, ...]:
    albedo = "" if photo.panel is None or photo.panel.albedo is None else f"{photo.panel.albedo:g}"
    band = photo.band.name if photo.band else ""
    when = "before" if photo.clock_ns < first_ns else "after"
    lead = panel.shot.lead.name
    return photo.name, lead, band, when, cell(panel.serial), albedo, panel.found_by
