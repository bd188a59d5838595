"""A picture of a survey plan: region, rows by drone, takeoff, scale."""

from enum import Enum
from math import ceil

import cv2
import numpy as np

from recon.cli.picture import COLOURS, png_of
from recon.cli.plan_output import counted, flights_in_order, minutes, row_ends_m
from recon.geo import round_length_m
from recon.guidance.survey import SurveyPlan
from recon.guidance.survey.estimate import SurveyEstimate
from recon.model.arrays import FloatArray
from recon.model.imagery import RgbImage

SIDE_PX, MARGIN_PX, HEAD_PX, LINE_PX = 1000, 40, 56, 26
FONT = cv2.FONT_HERSHEY_SIMPLEX


class Theme(Enum):
    """Of the picture's ground."""

    LIGHT = "light"
    DARK = "dark"


PAPER = {Theme.LIGHT: (255, 255, 255), Theme.DARK: (24, 26, 30)}
INK = {Theme.LIGHT: (40, 40, 40), Theme.DARK: (225, 228, 232)}
FIELD = {Theme.LIGHT: (226, 238, 226), Theme.DARK: (44, 56, 46)}

PixelArray = np.typing.NDArray[np.int32]


def picture_png(plan: SurveyPlan, needs: SurveyEstimate, title: str, theme: Theme) -> bytes:
    """Return a PNG: each drone's rows in its colour, with a dot where each flight begins."""
    shown_m = np.concatenate(
        [np.array(track) for _, flight in flights_in_order(needs) for track in flight.tracks_m]
        + [plan.survey.region.outline_m]
    )
    west_north_m = np.array([shown_m[:, 0].min(), shown_m[:, 1].max()])
    wide_m, high_m = shown_m.max(axis=0) - shown_m.min(axis=0)
    scale = (SIDE_PX - 2 * MARGIN_PX) / max(wide_m, high_m)
    width, height = (round(scale * m) + 2 * MARGIN_PX for m in (wide_m, high_m))
    legend_px = LINE_PX * (len(needs.drones) + 1) + MARGIN_PX
    width = max(width, SIDE_PX // 2)
    shape = (height + HEAD_PX + legend_px, width, 3)
    picture: RgbImage = np.full(shape, PAPER[theme], np.uint8)

    def px(places_m: FloatArray) -> PixelArray:
        down_m = (places_m - west_north_m) * np.array([1.0, -1.0])
        pixels: PixelArray = np.rint(down_m * scale + (MARGIN_PX, MARGIN_PX + HEAD_PX)).astype("i4")
        return pixels

    region = plan.survey.region
    cv2.fillPoly(picture, [px(region.outline_m)], FIELD[theme], cv2.LINE_AA)
    for hole_m in region.holes_m:
        cv2.fillPoly(picture, [px(hole_m)], PAPER[theme], cv2.LINE_AA)
    rings = [px(ring_m) for ring_m in (region.outline_m, *region.holes_m)]
    cv2.polylines(picture, rings, True, INK[theme], 1, cv2.LINE_AA)
    for drone, flight in flights_in_order(needs):
        colour = COLOURS[drone % len(COLOURS)]
        for track in flight.tracks_m:
            cv2.polylines(picture, [px(np.array(track))], False, colour, 1, cv2.LINE_AA)
        for ends in row_ends_m(plan, flight):
            cv2.polylines(picture, [px(np.array(ends))], False, colour, 3, cv2.LINE_AA)
        start = px(np.array(flight.tracks_m[0][:1]))[0]
        cv2.circle(picture, start.tolist(), 8, colour, -1, cv2.LINE_AA)
        cv2.circle(picture, start.tolist(), 8, INK[theme], 1, cv2.LINE_AA)
    _text(picture, f"{title}: {minutes(needs.time_s)}, {needs.photos} photos", 34, theme, 0.8)
    _legend(picture, needs, height + HEAD_PX, scale, theme)
    return png_of(picture)


def _legend(picture: RgbImage, needs: SurveyEstimate, top: int, scale: float, theme: Theme) -> None:
    """A scale of round length, then a line for each drone."""
    long_m = round_length_m(0.25 * SIDE_PX / scale)
    end = MARGIN_PX + round(long_m * scale)
    cv2.line(picture, (MARGIN_PX, top + 8), (end, top + 8), INK[theme], 2)
    _text(picture, f"{long_m:g} m, north is up", top + 14, theme, 0.55, end + 12)
    for number, drone in enumerate(needs.drones, start=1):
        row = top + 12 + LINE_PX * number
        colour = COLOURS[(number - 1) % len(COLOURS)]
        cv2.line(picture, (MARGIN_PX, row - 6), (MARGIN_PX + 36, row - 6), colour, 3)
        flights = counted(len(drone.flights), "flight")
        text = f"{drone.serial}: {minutes(drone.time_s)}, {flights}"
        _text(picture, text, row, theme, 0.55, MARGIN_PX + 48)


def _text(
    picture: RgbImage, text: str, row: int, theme: Theme, size: float, col: int = MARGIN_PX
) -> None:
    # OpenCV's fonts have no other letters.
    ascii_text = text.encode("ascii", "replace").decode()
    (long_px, _), _ = cv2.getTextSize(ascii_text, FONT, size, 1)
    fits = min(1.0, (picture.shape[1] - col - 8) / max(long_px, 1))
    cv2.putText(
        picture, ascii_text, (col, row), FONT, size * fits, INK[theme], ceil(size), cv2.LINE_AA
    )
