"""Draws how `sunlit_first` decides: six moments of a survey under bands of shade that move.

    python -m studies.survey_decisions --out survey-decisions.png

Dark ground lies in shade at that moment. Yellow cells are imaged in sun, blue ones in shade only.
Thick lines are the rows of each vehicle's mission, dots the vehicles. Below stands what was decided
for each. Prints the decisions of each moment.
"""

import argparse

import cv2
import numpy as np
from tests.guidance.survey.fields import rectangle, survey_of
from tests.guidance.survey.flyers import (
    BoolArray,
    Flights,
    FloatArray,
    begun,
    fleet,
    middles_m,
)

from recon.model.survey import CellState, SurveyBudget

MOMENTS_S = (1.0, 60.0, 120.0, 200.0, 280.0, 360.0)
COLUMNS = 3
EAST_M, NORTH_M = 360.0, 240.0
EDGE_M = 45.0
PX_PER_M = 1.2
TEXT_PX = 84
PAPER, INK = (255, 255, 255), (40, 40, 40)
GROUND, SHADE = (222, 236, 222), (150, 150, 138)
IN_SUN, IN_SHADE = (90, 200, 245), (200, 140, 90)
COLOURS = ((180, 110, 30), (40, 90, 215), (150, 40, 140))
"""Blue, green, red as OpenCV wants them; apart also for those who tell red and green badly."""

Picture = cv2.typing.MatLike


def bands(places_m: FloatArray, time_s: float) -> BoolArray:
    """Bands of shade, 130 m wide and 140 m apart, move north-east at 2 m/s."""
    along_m = (places_m[:, 0] + places_m[:, 1]) / np.sqrt(2.0) - 2.0 * time_s
    return np.asarray(np.mod(along_m, 270.0) < 140.0)


def flights_under_bands() -> Flights:
    """Return three vehicles at the beginning of a survey under the bands."""
    budget = SurveyBudget(rounds=20)
    survey = survey_of(
        rectangle(EAST_M, NORTH_M), planner="sunlit_first", bearing_deg=90.0, budget=budget
    )
    flyers = fleet(len(COLOURS))
    return Flights(begun(survey, flyers), flyers, sky=bands, foresees=True)


def panel(flights: Flights) -> Picture:
    """Return one moment, (H, W, 3) u8."""
    high, wide = round((NORTH_M + 2 * EDGE_M) * PX_PER_M), round((EAST_M + 2 * EDGE_M) * PX_PER_M)
    canvas = np.full((high + TEXT_PX, wide, 3), PAPER, dtype=np.uint8)
    _draw_ground(canvas[:high], flights)
    plan = flights.plan
    for index, flyer in enumerate(flights.flyers):
        colour = COLOURS[index]
        flight = flights.state.flights.get(flyer.serial)
        for leg in () if flight is None else flight.route:
            ends = plan.lattice.east_north_m(leg.ends_m(plan.lattice, 0.0))
            cv2.polylines(canvas, [to_px(ends)], False, colour, 3, cv2.LINE_AA)
        (place,) = to_px(np.array([flyer.place_m]))
        cv2.circle(canvas, place.tolist(), 8, PAPER, -1, cv2.LINE_AA)
        cv2.circle(canvas, place.tolist(), 6, colour, -1, cv2.LINE_AA)
        decision = flights.state.decisions.get(flyer.serial)
        words = "" if decision is None else decision.text
        write(canvas, f"{index + 1}: {words}", (10, high + 18 + 22 * index), colour)
    write(canvas, f"{flights.time_s:.0f} s", (10, 22), INK)
    return canvas


def _draw_ground(canvas: Picture, flights: Flights) -> None:
    rows, cols = canvas.shape[:2]
    east = (np.arange(cols) + 0.5) / PX_PER_M - EDGE_M
    north = NORTH_M + EDGE_M - (np.arange(rows) + 0.5) / PX_PER_M
    places = np.stack(np.meshgrid(east, north), axis=-1).reshape(-1, 2)
    is_lit = bands(places, flights.time_s).reshape(rows, cols)
    canvas[:] = np.where(is_lit[..., np.newaxis], GROUND, SHADE)
    cells, state = flights.plan.cells, flights.state.progress.state
    for wanted, colour in ((CellState.IN_SHADE, IN_SHADE), (CellState.IN_SUN, IN_SUN)):
        chosen = (cells.is_inside & (state == wanted)).ravel()
        half_px = max(1, round(cells.grid.cell_m * PX_PER_M / 2.0 - 1.0))
        for col, row in to_px(middles_m(cells.grid)[chosen]).tolist():
            canvas[row - half_px : row + half_px, col - half_px : col + half_px] = colour
    outline = to_px(flights.plan.survey.region.outline_m)
    cv2.polylines(canvas, [outline], True, INK, 1, cv2.LINE_AA)


def to_px(points_m: FloatArray) -> np.typing.NDArray[np.int32]:
    """Return pixels (N, 2), right and down, of places (N, 2) east-north."""
    east_m, down_m = points_m[:, 0] + EDGE_M, NORTH_M + EDGE_M - points_m[:, 1]
    return np.round(np.column_stack([east_m, down_m]) * PX_PER_M).astype(np.int32)


def write(
    canvas: Picture,
    text: str,
    at: tuple[int, int],
    colour: tuple[int, int, int],
    size: float = 0.45,
) -> None:
    """Write a line from `at` on, its lower left corner."""
    cv2.putText(canvas, text, at, cv2.FONT_HERSHEY_SIMPLEX, size, colour, 1, cv2.LINE_AA)


def out_path(about: str | None, usual: str) -> str:
    """Return where the picture goes, by the command's only option."""
    parser = argparse.ArgumentParser(
        description=about, formatter_class=argparse.RawTextHelpFormatter
    )
    parser.add_argument("--out", default=usual, help="where the picture goes")
    return str(parser.parse_args().out)


def save(panels: list[Picture], columns: int, out: str) -> None:
    """Write panels of one size into one picture, row by row."""
    rows = [np.hstack(panels[at : at + columns]) for at in range(0, len(panels), columns)]
    cv2.imwrite(out, np.vstack(rows))


def main() -> None:
    """Draw all moments into one file."""
    out = out_path(__doc__, "survey-decisions.png")
    flights = flights_under_bands()
    panels: list[Picture] = []
    for moment_s in MOMENTS_S:
        flights.run(moment_s - flights.time_s)
        for serial, decision in flights.state.decisions.items():
            print(f"{flights.time_s:4.0f} s, {serial}: {decision.text}")
        panels.append(panel(flights))
    save(panels, COLUMNS, out)


if __name__ == "__main__":
    main()
