"""Fields to survey: known shapes and drawn ones, and points in them found without polygons' code.

Whether a point is inside is found by counting the edges that a ray from it crosses.
"""

from collections.abc import Sequence

import numpy as np
import numpy.typing as npt

from recon.guidance.survey import SurveyPlan, plan_survey
from recon.guidance.survey.again import kept_lattice
from recon.model.airspace import Region
from recon.model.flown_region import FlownRegion
from recon.model.geo import GeoPoint, LocalFrame
from recon.model.survey import Survey, SurveyBudget, SurveyCamera

FloatArray = npt.NDArray[np.float64]
BoolArray = npt.NDArray[np.bool_]

FRAME = LocalFrame(GeoPoint(44.99, -93.2, 250.0))
HEIGHT_M = 60.0
FLOWN_S = 1_777_600_000
"""When a flown region was imaged, in May 2026."""


def region(*rings: Sequence[tuple[float, float]]) -> Region:
    outline, *holes = (np.array(ring, dtype=np.float64) for ring in rings)
    return Region(outline, tuple(holes))


def l_shape() -> Region:
    return region([(0, 0), (300, 0), (300, 120), (120, 120), (120, 250), (0, 250)])


def holed() -> Region:
    return region(
        [(0, 0), (400, 0), (380, 300), (20, 280)],
        [(150, 100), (250, 110), (240, 200), (160, 190)],
    )


def rectangle(east_m: float = 300.0, north_m: float = 200.0) -> Region:
    return region([(0, 0), (east_m, 0), (east_m, north_m), (0, north_m)])


def star(rng: np.random.Generator, radius_m: float, has_hole: bool) -> Region:
    """A field whose corners all see its middle: its edges never cross, seldom convex."""
    middle_m = rng.uniform(-200.0, 200.0, 2)
    outline_m = _star(rng, middle_m, radius_m)
    holes = (_star(rng, middle_m, radius_m * 0.2),) if has_hole else ()
    return Region(outline_m, holes)


def survey_of(
    over: Region,
    *,
    camera: SurveyCamera | None = None,
    height_m: float = HEIGHT_M,
    speed_mps: float = 8.0,
    front: float = 0.7,
    side: float = 0.6,
    bearing_deg: float | None = None,
    planner: str = "lawnmower_once",
    budget: SurveyBudget | None = None,
    cell_m: float = 4.0,
) -> Survey:
    return Survey(
        id=1,
        name="north field",
        region=over,
        height_above_takeoff_m=height_m,
        speed_mps=speed_mps,
        camera=camera or SurveyCamera(),
        front_overlap=front,
        side_overlap=side,
        row_bearing_deg=bearing_deg,
        planner=planner,
        budget=budget or SurveyBudget(),
        cell_m=cell_m,
    )


def planned(survey: Survey) -> SurveyPlan:
    plan = plan_survey(survey, FRAME)
    assert isinstance(plan, SurveyPlan), plan
    return plan


def points_in(over: Region, rng: np.random.Generator, count: int) -> FloatArray:
    """Random places in a region, and places close inside its edges."""
    least, most = over.outline_m.min(axis=0), over.outline_m.max(axis=0)
    anywhere = rng.uniform(least, most, (count, 2))
    near = [_near_edges(ring, rng, count // 4) for ring in (over.outline_m, *over.holes_m)]
    points = np.concatenate([anywhere, *near])
    return points[is_inside(over, points)]


def is_inside(over: Region, points_m: FloatArray) -> BoolArray:
    crossed = sum(_crossings(ring, points_m) for ring in (over.outline_m, *over.holes_m))
    return np.asarray(crossed % 2 == 1)


def distance_m(over: Region, points_m: FloatArray) -> FloatArray:
    """How far points are outside a region, 0 inside: the least over all its edges."""
    far = np.full(len(points_m), np.inf)
    for ring in (over.outline_m, *over.holes_m):
        for a, b in zip(ring, np.roll(ring, -1, axis=0), strict=True):
            along = np.clip(((points_m - a) @ (b - a)) / ((b - a) @ (b - a)), 0.0, 1.0)
            nearest = a + along[:, np.newaxis] * (b - a)
            far = np.minimum(far, np.hypot(*(points_m - nearest).T))
    return np.where(is_inside(over, points_m), 0.0, far)


def _star(rng: np.random.Generator, middle_m: FloatArray, radius_m: float) -> FloatArray:
    count = int(rng.integers(5, 12))
    angles = (np.arange(count) + rng.uniform(0.25, 0.75, count)) / count * 2.0 * np.pi
    radii = radius_m * rng.uniform(0.45, 1.0, count)
    star: FloatArray = middle_m + np.column_stack([radii * np.cos(angles), radii * np.sin(angles)])
    return star


def _near_edges(ring: FloatArray, rng: np.random.Generator, count: int) -> FloatArray:
    which = rng.integers(0, len(ring), count)
    share = rng.uniform(0.0, 1.0, (count, 1))
    on_edge = ring[which] * (1.0 - share) + np.roll(ring, -1, axis=0)[which] * share
    near: FloatArray = on_edge + rng.normal(0.0, 0.3, (count, 2))
    return near


def _crossings(ring: FloatArray, points_m: FloatArray) -> npt.NDArray[np.int64]:
    crossed = np.zeros(len(points_m), dtype=np.int64)
    for a, b in zip(ring, np.roll(ring, -1, axis=0), strict=True):
        if a[1] == b[1]:
            continue
        spans = (a[1] > points_m[:, 1]) != (b[1] > points_m[:, 1])
        east_m = a[0] + (points_m[:, 1] - a[1]) * (b[0] - a[0]) / (b[1] - a[1])
        crossed += spans & (points_m[:, 0] < east_m)
    return crossed


def flown(plan: SurveyPlan, imaged: BoolArray | None = None) -> FlownRegion:
    """What is kept of a survey that has imaged these cells in sun, by default all."""
    shape = plan.cells.is_reached.shape
    times_s = np.where(np.ones(shape, bool) if imaged is None else imaged, FLOWN_S, 0)
    times_s = times_s.astype(np.uint32)
    return FlownRegion(
        survey=plan.survey,
        lattice=kept_lattice(plan.lattice),
        grid=plan.cells.grid,
        is_reached=plan.cells.is_reached,
        is_light_known=times_s > 0,
        imaged_s=times_s,
        in_sun_s=times_s,
        begun_s=FLOWN_S - 60,
        started_s=FLOWN_S,
        is_simulated=False,
    )
