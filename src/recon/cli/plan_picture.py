"""A picture of a survey plan: region, site, rows by drone and flight, takeoff, scale."""

from collections.abc import Sequence
from dataclasses import dataclass
from enum import Enum

import cv2
import numpy as np

from recon.cli.picture import COLOURS, png_of
from recon.cli.plan_output import counted, flights_in_order, minutes, row_ends_m
from recon.geo import round_length_m
from recon.guidance.survey import Surveyor, SurveyPlan, SurveySurroundings
from recon.guidance.survey.estimate import PlannedFlight, SurveyEstimate
from recon.guidance.survey.lattice import EastNorth
from recon.model.airspace import Region
from recon.model.arrays import FloatArray
from recon.model.imagery import RgbImage

SIDE_PX, MARGIN_PX, HEAD_PX, LINE_PX = 1000, 48, 48, 30
LEGEND_COLUMNS = 2
TITLE_PX, TEXT_PX, NUMBER_PX = 24, 16, 13
DISC_PX, TAKEOFF_PX, TIP_PX = 12, 5, 12
FAINT = 0.45
"""Share of a colour, the rest is paper, for all but rows."""

Colour = tuple[int, int, int]


class Theme(Enum):
    """Background of the picture."""

    LIGHT = "light"
    DARK = "dark"


PAPER: dict[Theme, Colour] = {Theme.LIGHT: (255, 255, 255), Theme.DARK: (24, 26, 30)}
INK: dict[Theme, Colour] = {Theme.LIGHT: (40, 40, 40), Theme.DARK: (225, 228, 232)}
FIELD: dict[Theme, Colour] = {Theme.LIGHT: (226, 238, 226), Theme.DARK: (44, 56, 46)}
KEEP_OUT: dict[Theme, Colour] = {Theme.LIGHT: (190, 30, 45), Theme.DARK: (240, 100, 110)}


def picture_png(
    plan: SurveyPlan,
    needs: SurveyEstimate,
    fleet: Sequence[Surveyor],
    site: SurveySurroundings | None,
    title: str,
    theme: Theme,
) -> bytes:
    """Return a PNG: each drone's rows in its colour, with its number where each flight begins."""
    takeoff_m = {each.serial: each.home_m or each.place_m for each in fleet}
    takeoffs_m = [takeoff_m[drone.serial] for drone in needs.drones]
    shown_m = np.concatenate(
        [np.array(track) for _, flight in flights_in_order(needs) for track in flight.tracks_m]
        + [plan.survey.region.outline_m, np.array(takeoffs_m)]
    )
    wide_m, high_m = np.ptp(shown_m, axis=0)
    scale = (SIDE_PX - 2 * MARGIN_PX) / max(wide_m, high_m)
    width, height = (round(scale * m) + 2 * MARGIN_PX for m in (wide_m, high_m))
    width = max(width, SIDE_PX // 2)
    keys = 1 + -(-len(needs.drones) // LEGEND_COLUMNS)
    shape = (HEAD_PX + height + keys * LINE_PX + MARGIN_PX // 2, width, 3)
    picture: RgbImage = np.full(shape, PAPER[theme], np.uint8)
    west_north_m = np.array([shown_m[:, 0].min(), shown_m[:, 1].max()])
    ground = _Map(picture[HEAD_PX : HEAD_PX + height], theme, west_north_m, scale)
    _draw_site(ground, plan.survey.region, site)
    _draw_flights(ground, plan, needs, takeoffs_m)
    title = f"{title}: {minutes(needs.time_s)}, {needs.photos} photos"
    _text(picture, title, (MARGIN_PX, 34), INK[theme], TITLE_PX)
    _legend(picture[HEAD_PX + height :], needs, scale, theme, site is not None)
    return png_of(picture)


@dataclass(frozen=True, slots=True)
class _Map:
    """The part of the picture that shows ground, its west-north corner `MARGIN_PX` inside."""

    picture: RgbImage
    theme: Theme
    west_north_m: FloatArray
    scale: float

    def px(self, places_m: FloatArray | Sequence[EastNorth]) -> np.typing.NDArray[np.int32]:
        down_m = (np.array(places_m) - self.west_north_m) * np.array([1.0, -1.0])
        pixels: np.typing.NDArray[np.int32] = np.rint(down_m * self.scale + MARGIN_PX).astype("i4")
        return pixels

    def line(self, places_m: FloatArray | Sequence[EastNorth], colour: Colour, wide: int) -> None:
        cv2.polylines(self.picture, [self.px(places_m)], False, colour, wide, cv2.LINE_AA)

    def region(self, region: Region, fill: Colour | None, edge: Colour, wide: int = 1) -> None:
        """Draw a region; its holes are left as they were."""
        rings = [self.px(ring_m) for ring_m in (region.outline_m, *region.holes_m)]
        if fill is not None:
            cv2.fillPoly(self.picture, rings, fill)  # one call: the holes are even, not filled
        cv2.polylines(self.picture, rings, True, edge, wide, cv2.LINE_AA)

    def faint(self, colour: Colour) -> Colour:
        return _mixed(colour, PAPER[self.theme])


def _mixed(colour: Colour, paper: Colour) -> Colour:
    red, green, blue = (
        round(FAINT * one + (1.0 - FAINT) * other) for one, other in zip(colour, paper, strict=True)
    )
    return red, green, blue


def _draw_site(ground: _Map, region: Region, site: SurveySurroundings | None) -> None:
    """The region, the site's boundary and its keep-out zones, from the lowest to the highest."""
    ink, keep_out = INK[ground.theme], KEEP_OUT[ground.theme]
    ground.region(region, FIELD[ground.theme], ink)
    if site is None:
        return
    for zone in site.keep_out:
        ground.region(zone, ground.faint(keep_out), keep_out)
    if site.boundary is not None:
        ground.region(site.boundary, None, keep_out, 2)


def _draw_flights(
    ground: _Map, plan: SurveyPlan, needs: SurveyEstimate, takeoffs_m: Sequence[EastNorth]
) -> None:
    """Paths first, rows above them, and the numbers of drones on top."""
    flights = flights_in_order(needs)
    for drone, flight in flights:
        faint = ground.faint(_colour(drone))
        for track in _paths_m(flight, takeoffs_m[drone]):
            ground.line(track, faint, 1)
    for drone, flight in flights:
        for ends in row_ends_m(plan, flight):
            ground.line(ends, _colour(drone), 3)
            _arrow(ground, ends, _colour(drone))
    for place_m in takeoffs_m:
        middle = ground.px([place_m])[0]
        corners = (middle - TAKEOFF_PX).tolist(), (middle + TAKEOFF_PX).tolist()
        cv2.rectangle(ground.picture, *corners, INK[ground.theme], -1)
    for drone, flight in flights:
        _disc(ground.picture, ground.px(flight.tracks_m[0][:1])[0].tolist(), drone)


def _paths_m(flight: PlannedFlight, takeoff_m: EastNorth) -> list[tuple[EastNorth, ...]]:
    """Return the missions of a flight, with the leg to the first and back from the last."""
    first, last = flight.tracks_m[0][0], flight.tracks_m[-1][-1]
    return [(takeoff_m, first), *flight.tracks_m, (last, takeoff_m)]


def _arrow(ground: _Map, ends_m: tuple[EastNorth, ...], colour: Colour) -> None:
    """Show at a row's middle which way it is flown."""
    start, end = ground.px(ends_m)[[0, -1]]
    long_px = float(np.linalg.norm(end - start)) / 2.0
    if long_px > 2.0 * TIP_PX:
        tip = ((start + end) // 2).tolist()
        cv2.arrowedLine(
            ground.picture, start.tolist(), tip, colour, 3, cv2.LINE_AA, 0, TIP_PX / long_px
        )


def _colour(drone: int) -> Colour:
    return COLOURS[drone % len(COLOURS)]


def _disc(picture: RgbImage, middle: list[int], drone: int) -> None:
    """A disc with a drone's number: colours repeat, numbers do not."""
    cv2.circle(picture, middle, DISC_PX, _colour(drone), -1, cv2.LINE_AA)
    cv2.circle(picture, middle, DISC_PX, (255, 255, 255), 1, cv2.LINE_AA)
    number = str(drone + 1)
    place = (middle[0] - _width_px(number, NUMBER_PX) // 2, middle[1] + NUMBER_PX // 2 - 1)
    _text(picture, number, place, (0, 0, 0), NUMBER_PX, 700)


def _legend(
    picture: RgbImage, needs: SurveyEstimate, scale: float, theme: Theme, has_site: bool
) -> None:
    """A scale of round length, then a line for each drone."""
    ink = INK[theme]
    long_m = round_length_m(0.25 * SIDE_PX / scale)
    end = MARGIN_PX + round(long_m * scale)
    cv2.line(picture, (MARGIN_PX, 10), (end, 10), ink, 2)
    marks = "; square: takeoff" + "; red: boundary, keep-out" * has_site
    _text(picture, f"{long_m:g} m, north is up{marks}", (end + 12, 16), ink, TEXT_PX)
    column_px = (picture.shape[1] - MARGIN_PX) // LEGEND_COLUMNS
    for number, drone in enumerate(needs.drones):
        row, column = divmod(number, LEGEND_COLUMNS)
        left, middle = MARGIN_PX + column * column_px, 16 + LINE_PX * (row + 1)
        _disc(picture, [left + DISC_PX, middle], number)
        flights = counted(len(drone.flights), "flight")
        text = f"{drone.serial}: {minutes(drone.time_s)}, {flights}"
        _text(picture, text, (left + 3 * DISC_PX, middle + 6), ink, TEXT_PX)


FONT = cv2.FontFace("sans")
"""OpenCV's own, with Latin, Greek, Cyrillic and Chinese letters among others."""


def _width_px(text: str, size_px: int) -> int:
    return int(cv2.getTextSize((0, 0), text, (0, 0), FONT, size_px)[2])


def _text(
    picture: RgbImage,
    text: str,
    place: tuple[int, int],
    colour: Colour,
    size_px: int,
    weight: int = 400,
) -> None:
    """Write a text from a place on its base line, smaller where it would not fit."""
    fits = (picture.shape[1] - place[0] - 8) / max(1, _width_px(text, size_px))
    cv2.putText(picture, text, place, colour, FONT, int(size_px * min(1.0, fits)), weight)
