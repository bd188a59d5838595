"""What an imaging drone sees of the shade that comes over a field, from its middle and upwind.

    python -m studies.upwind_place --picture docs/images/upwind-place.png

Geometry alone: a square of 15 ha, level ground, the demonstration's lens at 118 m, as the simulator
has it, and shadows of three speeds from twelve directions (means). The picture draws one case.
"""

import argparse
from collections.abc import Sequence
from math import cos, hypot, radians, sin
from pathlib import Path

import cv2
import numpy as np

from recon.camera.sight import COARSEST_M, farthest_sight_m
from recon.forecast import ForecastSettings
from recon.guidance.upwind_place import (
    GroundView,
    UpwindPlace,
    best_place,
    field_points_m,
    seen_from,
    upwind_deg,
)
from recon.model.imagery import RgbImage
from recon.site.demo_site import demo_camera

HEIGHT_M, FIELD_RAD = 118.0, radians(65.0)
HALF_M = 0.5 * (15.0 * 10_000.0) ** 0.5
FIELD_M = field_points_m(
    np.array([[-HALF_M, -HALF_M], [HALF_M, HALF_M]]), lambda p: np.ones(len(p), np.bool_)
)
SPEEDS_MPS, DIRECTIONS = (5.0, 7.5, 10.0), 12
TILTS_DEG = (0.0, 15.0, 20.0, 25.0)
FOLLOWED_FOR_S = ForecastSettings().followed_for_s
SHOWN_S = (0.0, 30.0, 60.0, 90.0)
SIDE_PX, PIXEL_M, WEST_M, NORTH_M = 460, 2.6, -890.0, 430.0
SEEN, BLUE, RED, INK = (255, 232, 170), (20, 80, 130), (190, 40, 30), (30, 30, 30)


def view_of(tilt_deg: float) -> GroundView:
    """Return the view of the demonstration's lens at this tilt."""
    farthest_m = farthest_sight_m(HEIGHT_M, demo_camera().pixels_per_radian, COARSEST_M)
    return GroundView(HEIGHT_M, FIELD_RAD, radians(tilt_deg), farthest_m)


def places(tilt_deg: float, velocity: tuple[float, float]) -> tuple[UpwindPlace, UpwindPlace]:
    """Return the middle of the field, looking upwind, and the best place."""
    view = view_of(tilt_deg)
    middle = seen_from(FIELD_M, (0.0, 0.0), upwind_deg(velocity), velocity, view, FOLLOWED_FOR_S)
    best = best_place(FIELD_M, velocity, view, FOLLOWED_FOR_S, lambda p: np.ones(len(p), np.bool_))
    assert best is not None
    return middle, best


def row(tilt_deg: float, speed_mps: float) -> str:
    """Return a line of the table: means over the directions."""
    turns = np.arange(DIRECTIONS) * 2.0 * np.pi / DIRECTIONS
    found = [places(tilt_deg, (speed_mps * cos(a), speed_mps * sin(a))) for a in turns.tolist()]
    middle, best = zip(*found, strict=True)
    away_m = float(np.mean([hypot(each.east_m, each.north_m) for each in best]))
    return (
        f"| {tilt_deg:.0f} deg | {speed_mps:g} m/s | {shares(middle)} | {away_m:.0f} m | "
        f"{shares(best)} |"
    )


def shares(found: Sequence[UpwindPlace]) -> str:
    """Return the mean shares at the shown leads."""
    means = [np.mean([each.predicted_at(s) for each in found]) for s in SHOWN_S]
    return " / ".join(f"{mean:.2f}" for mean in means)


def drawn(path: Path) -> None:
    """Draw what is seen from the middle and upwind, with a level and with a tilted camera."""
    velocity = (7.5 * cos(radians(30.0)), 7.5 * sin(radians(30.0)))
    cases = (
        ("above the field, straight down", 0.0, 0),
        ("upwind, straight down", 0.0, 1),
        ("upwind, tilted 20 degrees", 20.0, 1),
    )
    parts = [
        _drawn_case(title, view_of(tilt_deg), places(tilt_deg, velocity)[which], velocity)
        for title, tilt_deg, which in cases
    ]
    cv2.imwrite(str(path), cv2.cvtColor(np.hstack(parts), cv2.COLOR_RGB2BGR))


def _drawn_case(
    title: str, view: GroundView, place: UpwindPlace, velocity: tuple[float, float]
) -> RgbImage:
    """Return a picture: the ground in view, and the field with its shade to come."""
    picture: RgbImage = np.full((SIDE_PX, SIDE_PX, 3), 255, np.uint8)
    rows, cols = np.mgrid[0:SIDE_PX, 0:SIDE_PX]
    off = np.stack([WEST_M + cols * PIXEL_M, NORTH_M - rows * PIXEL_M], axis=-1)
    off = off - (place.east_m, place.north_m)
    ahead = np.array([sin(radians(place.heading_deg)), cos(radians(place.heading_deg))])
    picture[view.shows(off @ ahead, off @ np.array([ahead[1], -ahead[0]]))] = SEEN
    square = np.array([[-1, 1], [1, 1], [1, -1], [-1, -1]]) * HALF_M
    for lead_s in reversed(SHOWN_S):
        corners = square - lead_s * np.array(velocity)
        pixels = np.array([_pixel(*corner) for corner in corners.tolist()], np.int32)
        thick = 3 if lead_s == 0.0 else 1
        cv2.polylines(picture, [pixels.reshape(-1, 1, 2)], True, BLUE, thick, cv2.LINE_AA)
        when = "now" if lead_s == 0.0 else f"in {lead_s:.0f} s"
        col, row = pixels[3].tolist()
        text = f"{when}: {100.0 * place.predicted_at(lead_s):.0f} %"
        _write(picture, text, (max(col, 0) + 5, row - 7))
    cv2.drawMarker(picture, _pixel(place.east_m, place.north_m), RED, cv2.MARKER_TRIANGLE_UP, 16, 3)
    _write(picture, title, (12, 24), 0.55)
    return picture


def _write(picture: RgbImage, text: str, at: tuple[int, int], size: float = 0.45) -> None:
    cv2.putText(picture, text, at, cv2.FONT_HERSHEY_SIMPLEX, size, INK, 1, cv2.LINE_AA)


def _pixel(east_m: float, north_m: float) -> tuple[int, int]:
    return round((east_m - WEST_M) / PIXEL_M), round((NORTH_M - north_m) / PIXEL_M)


def main() -> None:
    """Print the table; draw the picture if asked for."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--picture", type=Path)
    asked = parser.parse_args()
    leads = " / ".join("now" if s == 0.0 else f"{s:.0f} s" for s in SHOWN_S)
    print(f"| tilt | shadows | from the middle, {leads} | best place | from there, {leads} |")
    print("| --- | --- | --- | --- | --- |")
    for tilt_deg in TILTS_DEG:
        for speed_mps in SPEEDS_MPS:
            print(row(tilt_deg, speed_mps), flush=True)
    if asked.picture is not None:
        drawn(asked.picture)
        print(f"drawn: {asked.picture}")


if __name__ == "__main__":
    main()
