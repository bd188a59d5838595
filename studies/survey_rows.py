"""Draws the rows of surveys: three fields, each shared among one, three and eight vehicles.

    python -m studies.survey_rows --out survey-rows.png

Each vehicle's way has a colour of its own, a dot where it begins, and thin lines between its rows.
Prints for each picture how long the ways are.
"""

import argparse
from collections.abc import Sequence

import cv2
import numpy as np
from tests.oracles.places import FloatArray

from recon.guidance.survey import (
    AssignedMission,
    Surveyor,
    SurveyPlan,
    SurveyState,
    create,
    plan_survey,
    start,
    step,
)
from recon.model.airspace import Region
from recon.model.geo import GeoPoint, LocalFrame
from recon.model.survey import Survey

FRAME = LocalFrame(GeoPoint(44.99, -93.2, 250.0))
COUNTS = (1, 3, 8)
SIDE_PX = 400
EDGE_PX = 28
PAPER, FIELD, OUTLINE = (255, 255, 255), (222, 236, 222), (110, 130, 110)
COLOURS = (
    (180, 110, 30),
    (40, 90, 215),
    (60, 150, 50),
    (150, 40, 140),
    (20, 150, 190),
    (110, 60, 60),
    (60, 60, 60),
    (170, 120, 200),
)
"""Blue, green, red as OpenCV wants them; apart also for those who tell red and green badly."""

Ring = Sequence[tuple[float, float]]


def fields() -> dict[str, Region]:
    """Return an L-shaped field, one with a pond, and a large slanted one."""
    return {
        "L-shaped, 5 ha": _region([(0, 0), (300, 0), (300, 120), (120, 120), (120, 250), (0, 250)]),
        "holed, 11 ha": _region(
            [(0, 0), (400, 0), (380, 300), (20, 280)],
            [(150, 100), (250, 110), (240, 200), (160, 190)],
        ),
        "large, 60 ha": _region(
            [
                (0, 150),
                (500, 0),
                (1000, 130),
                (900, 700),
                (560, 620),
                (430, 420),
                (250, 680),
                (60, 600),
            ]
        ),
    }


def flights_of(region: Region, count: int) -> tuple[SurveyPlan, dict[str, AssignedMission]]:
    """Return the first missions of a survey by vehicles that stand south of the field."""
    survey = Survey(1, "field", region, height_above_takeoff_m=60.0, speed_mps=8.0)
    plan = plan_survey(survey, FRAME)
    assert isinstance(plan, SurveyPlan), plan
    created = create(plan)
    assert isinstance(created, SurveyState), created
    surveyors = [Surveyor(f"{i}", (20.0 * i, -30.0)) for i in range(count)]
    begun = start(created, [each.serial for each in surveyors], 0)
    assert isinstance(begun, SurveyState), begun
    flying, _missions = step(begun, surveyors, 10**10)
    return plan, dict(flying.flights)


def picture(
    plan: SurveyPlan, flights: dict[str, AssignedMission], title: str
) -> cv2.typing.MatLike:
    """Return one field with the ways of its vehicles, (H, W, 3) u8."""
    canvas = np.full((SIDE_PX, SIDE_PX, 3), PAPER, dtype=np.uint8)
    region = plan.survey.region
    scale = _scale(region.outline_m)
    cv2.fillPoly(canvas, [_px(region.outline_m, region, scale)], FIELD, cv2.LINE_AA)
    for hole_m in region.holes_m:
        cv2.fillPoly(canvas, [_px(hole_m, region, scale)], PAPER, cv2.LINE_AA)
    rings = [_px(ring, region, scale) for ring in (region.outline_m, *region.holes_m)]
    cv2.polylines(canvas, rings, True, OUTLINE, 1, cv2.LINE_AA)
    for serial, flight in flights.items():
        colour = COLOURS[int(serial) % len(COLOURS)]
        way = _px(np.array(flight.corners_m), region, scale)
        cv2.polylines(canvas, [way], False, colour, 1, cv2.LINE_AA)
        for leg in flight.route:
            ends = plan.lattice.east_north_m(leg.ends_m(plan.lattice, plan.swath.lead_m))
            cv2.polylines(canvas, [_px(ends, region, scale)], False, colour, 2, cv2.LINE_AA)
        cv2.circle(canvas, way[0].tolist(), 5, colour, -1, cv2.LINE_AA)
    cv2.putText(
        canvas, title, (12, 22), cv2.FONT_HERSHEY_SIMPLEX, 0.5, (40, 40, 40), 1, cv2.LINE_AA
    )
    return canvas


def _scale(outline_m: FloatArray) -> float:
    wide_m = float((outline_m.max(axis=0) - outline_m.min(axis=0)).max())
    return (SIDE_PX - 2 * EDGE_PX) / wide_m


def _px(points_m: FloatArray, region: Region, scale: float) -> np.typing.NDArray[np.int32]:
    west, north = region.outline_m[:, 0].min(), region.outline_m[:, 1].max()
    east_m, down_m = points_m[:, 0] - west, north - points_m[:, 1]
    return np.round(np.column_stack([east_m, down_m]) * scale + EDGE_PX).astype(np.int32)


def _region(outline: Ring, *holes: Ring) -> Region:
    rings = [np.array(ring, dtype=np.float64) for ring in (outline, *holes)]
    return Region(rings[0], tuple(rings[1:]))


def main() -> None:
    """Draw all pictures into one file."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawTextHelpFormatter
    )
    parser.add_argument("--out", default="survey-rows.png", help="where the picture goes")
    out = parser.parse_args().out
    rows: list[cv2.typing.MatLike] = []
    for name, region in fields().items():
        pictures: list[cv2.typing.MatLike] = []
        for count in COUNTS:
            plan, flights = flights_of(region, count)
            lengths_m = [flight.length_m for flight in flights.values()]
            print(f"{name}, {count}:", ", ".join(f"{length_m:.0f} m" for length_m in lengths_m))
            pictures.append(picture(plan, flights, f"{name}, {count} vehicle{'s' * (count > 1)}"))
        rows.append(np.hstack(pictures))
    cv2.imwrite(out, np.vstack(rows))


if __name__ == "__main__":
    main()
