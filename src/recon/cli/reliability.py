"""A picture of reliability: what share of cells was in sun, by the probability given to them."""

from collections.abc import Mapping

import cv2
import numpy as np

from recon.cli.picture import COLOURS, png_of
from recon.model.imagery import RgbImage
from recon.score.forecast_figures import Calibration

SIDE_PX, MARGIN_PX, LEGEND_PX = 480, 64, 190
INK, GRID = (40, 40, 40), (210, 210, 210)
FEWEST = 50
"""Cells in a bin for a point: fewer are chance."""


def reliability_png(title: str, curves: Mapping[str, Calibration]) -> bytes:
    """Return a PNG: one curve a method; the diagonal is what a right probability has."""
    height, width = SIDE_PX + 2 * MARGIN_PX, SIDE_PX + 2 * MARGIN_PX + LEGEND_PX
    picture: RgbImage = np.full((height, width, 3), 255, np.uint8)
    _axes(picture, title)
    for number, (name, calibration) in enumerate(curves.items()):
        colour = COLOURS[number % len(COLOURS)]
        points = _points(calibration)
        pixels = np.array([_pixel(*point[:2]) for point in points], np.int32).reshape(-1, 1, 2)
        cv2.polylines(picture, [pixels], False, colour, 1, cv2.LINE_AA)
        for (col, row), (_chance, _lit, of_all) in zip(pixels.reshape(-1, 2), points, strict=True):
            # Its area shows how often such a probability was given.
            radius_px = round(3.0 + 14.0 * of_all**0.5)
            cv2.circle(picture, (int(col), int(row)), radius_px, colour, 2, cv2.LINE_AA)
        row = MARGIN_PX + 24 * number + 12
        cv2.line(picture, (width - LEGEND_PX - 40, row), (width - LEGEND_PX - 10, row), colour, 3)
        _text(picture, name, (width - LEGEND_PX, row + 5))
    return png_of(picture)


def _points(calibration: Calibration) -> list[tuple[float, float, float]]:
    """Return mean probability, share in sun, and share of all cells, of bins with enough cells."""
    bins = zip(calibration.predicted, calibration.sunlit, calibration.cells, strict=True)
    total = max(1, sum(calibration.cells))
    return [
        (chance / cells, lit / cells, cells / total)
        for chance, lit, cells in bins
        if cells >= FEWEST
    ]


def _pixel(chance: float, share: float) -> tuple[int, int]:
    return MARGIN_PX + round(chance * SIDE_PX), MARGIN_PX + round((1.0 - share) * SIDE_PX)


def _axes(picture: RgbImage, title: str) -> None:
    for tenth in range(0, 11, 2):
        share = tenth / 10.0
        cv2.line(picture, _pixel(share, 0.0), _pixel(share, 1.0), GRID, 1)
        cv2.line(picture, _pixel(0.0, share), _pixel(1.0, share), GRID, 1)
        col, row = _pixel(share, 0.0)
        _text(picture, f"{share:.1f}", (col - 12, row + 20))
        col, row = _pixel(0.0, share)
        _text(picture, f"{share:.1f}", (col - 36, row + 5))
    cv2.line(picture, _pixel(0.0, 0.0), _pixel(1.0, 1.0), INK, 1, cv2.LINE_AA)
    _text(picture, title, (MARGIN_PX, MARGIN_PX - 20))
    _text(picture, "probability of sun in the forecast", (MARGIN_PX, SIDE_PX + MARGIN_PX + 48))
    _text(picture, "in sun then", (8, MARGIN_PX - 40))


def _text(picture: RgbImage, text: str, at: tuple[int, int]) -> None:
    cv2.putText(picture, text, at, cv2.FONT_HERSHEY_SIMPLEX, 0.48, INK, 1, cv2.LINE_AA)
