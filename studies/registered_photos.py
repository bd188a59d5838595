"""How well photos are registered to each other: simulated flights, rendered photos, known truth.

    python -m studies.registered_photos                  # evaluation seeds from 1000
    python -m studies.registered_photos --flights 1 --minutes 5
    python -m studies.registered_photos --real           # real photos, by RECON_DATA

Each flight is flown by the whole station and recorded; its photos state GNSS positions with errors
that change slowly, and headings that are right or wrong in the ways that real gimbals' are.
"""

import argparse
import os
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
import numpy.typing as npt
from tests.product.registration.real_photos import FIELDS_DEG, timed_of

from recon.cli.progress import usable_cores
from recon.cli.score import with_methods
from recon.cli.sim_photos import write_photos
from recon.product.footprint import PhotoView, projected
from recon.product.headings import AIRCRAFT, GIMBAL, signed_deg
from recon.product.photos.photo import GimbalAttitude, Photo, read_photo_facts
from recon.product.registration import PhotoRegistration, read_grey, register, with_headings
from recon.product.timing import StatedCamera, TimedPhoto, timed_photos
from recon.score import load_scenario
from recon.sim.photos.card import CardSettings
from studies.survey_photos import SurveyFlown, fly
from studies.tagging import PLANNER, SCENARIO

POINTS = 8
"""Along a picture, whose place on the ground is compared."""
COLS = 660
"""Columns of the photos: an eighth of the camera's, as registration reads them."""

FloatArray = npt.NDArray[np.float64]


@dataclass(slots=True)
class Variant:
    """One way in which photos state their headings, and the errors found."""

    name: str
    errors_deg: list[float] = field(default_factory=list)
    before_deg: list[float] = field(default_factory=list)
    cameras: int = 0
    verified: int = 0
    warned: int = 0


@dataclass(slots=True)
class Places:
    """Errors of places in metres, before and after, and of headings after."""

    before_m: list[float] = field(default_factory=list)
    after_m: list[float] = field(default_factory=list)
    neighbours_before_m: list[float] = field(default_factory=list)
    neighbours_m: list[float] = field(default_factory=list)
    headings_deg: list[float] = field(default_factory=list)
    residuals_m: list[float] = field(default_factory=list)
    scales: list[float] = field(default_factory=list)


def main() -> None:
    """Fly, register and print the tables."""
    parser = argparse.ArgumentParser(description="Score the registration of photos.")
    parser.add_argument("--first-seed", type=int, default=1000)
    parser.add_argument("--flights", type=int, default=3)
    parser.add_argument("--minutes", type=float, default=8.0, help="Longest flight.")
    parser.add_argument("--real", action="store_true", help="Real photos by RECON_DATA instead.")
    options = parser.parse_args()
    if options.real:
        print(real_table(Path(os.environ["RECON_DATA"]) / "photos"))
        return
    names = ("gimbal right", "gimbal 53 off", "gimbal 180 off", "roll 180", "a tenth turned")
    variants = [Variant(name) for name in (*names, "no gimbal")]
    places, photos = Places(), 0
    for seed in range(options.first_seed, options.first_seed + options.flights):
        with TemporaryDirectory() as name:
            folder = Path(name)
            scenario = with_methods(load_scenario(SCENARIO), PLANNER, "ideal", "none")
            settings = CardSettings(cols=COLS)
            limit_s = 60.0 * options.minutes
            flown = fly(SCENARIO, scenario, seed, folder / "record", settings, limit_s)
            photos += write_photos(folder / "card", flown.flight, flown.truth, settings)
            card = sorted((folder / "card").glob("*.JPG"))
            facts = [read_photo_facts(path, path.name) for path in card]
            for variant in variants:
                add_headings(variant, flown, stated_as(variant.name, facts))
            add_places(places, flown, facts)
        print(f"# seed {seed}: {photos} photos so far", flush=True)
    print(tables(variants, places))


def real_table(folder: Path) -> str:
    """Return what each half of a folder's photos says of the statements, as a table."""
    rows = [
        "| photos | gimbal's yaw off | aircraft's yaw off | used | within |",
        "|---|---|---|---|---|",
    ]
    for name in FIELDS_DEG:
        photos = timed_of(folder / name)
        halves = (photos[: len(photos) // 2 + 1], photos[len(photos) // 2 :])
        for number, half in enumerate((photos, *halves)):
            _turned, (found,) = with_headings(half, read_grey)
            what = ("all", "first half", "second half")[number]
            rows.append(
                f"| {name}, {what} | {found.off_deg[GIMBAL]:+.1f} | {found.off_deg[AIRCRAFT]:+.1f} "
                f"| {found.source} {found.offset_deg:+.1f} | {found.error_deg:.1f} |"
            )
    return "\n".join(rows)


def stated_as(name: str, facts: Sequence[Photo]) -> list[Photo]:
    """Return the photos with another statement of the gimbal's attitude."""
    found = []
    for number, photo in enumerate(facts):
        assert photo.attitude is not None
        yaw_deg = photo.attitude.yaw_deg
        stated = {
            "gimbal 53 off": GimbalAttitude(signed_deg(yaw_deg + 53.0), -90.0, 0.0),
            "gimbal 180 off": GimbalAttitude(signed_deg(yaw_deg + 180.0), -90.0, 0.0),
            "roll 180": GimbalAttitude(signed_deg(yaw_deg + 180.0), -90.0, 180.0),
        }.get(name, photo.attitude)
        if name == "a tenth turned" and number % 10 == 0:
            stated = GimbalAttitude(signed_deg(yaw_deg + 180.0), -90.0, 0.0)
        is_bare = name == "no gimbal"
        found.append(
            replace(photo, attitude=None, flight_yaw_deg=None)
            if is_bare
            else replace(photo, attitude=stated)
        )
    return found


def add_headings(variant: Variant, flown: SurveyFlown, facts: Sequence[Photo]) -> None:
    """Find the headings as `recon tag` does, and add their errors."""
    timed = timed_photos(flown.flight, facts, StatedCamera()).photos
    turned, found = with_headings(timed, read_grey, workers=usable_cores())
    variant.before_deg += [off_deg(flown, each, each.view.aim.yaw_deg) for each in timed]
    variant.errors_deg += [off_deg(flown, each, each.view.aim.yaw_deg) for each in turned]
    variant.cameras += len(found)
    variant.verified += sum(each.is_verified for each in found)
    variant.warned += sum(bool(each.warnings) for each in found)


def off_deg(flown: SurveyFlown, timed: TimedPhoto, heading_deg: float) -> float:
    """Return how far a heading is off the true one of a photo's top."""
    top = -flown.shots[timed.photo.name].pose.rotation_enu_camera[:, 1]
    return abs(signed_deg(heading_deg - float(np.rad2deg(np.arctan2(top[0], top[1])))))


def add_places(places: Places, flown: SurveyFlown, facts: Sequence[Photo]) -> None:
    """Register all photos, and add the errors of their places."""
    timed = timed_photos(flown.flight, facts, StatedCamera()).photos
    found = register(timed, read_grey, workers=usable_cores())
    by_serial = sorted(range(len(timed)), key=lambda index: (timed[index].serial, index))
    for views, off_m, neighbours_m in (
        ([each.view for each in timed], places.before_m, places.neighbours_before_m),
        (found.views, places.after_m, places.neighbours_m),
    ):
        errors = np.array(
            [off_ground_m(flown, each, view) for each, view in zip(timed, views, strict=True)]
        )
        off_m += np.hypot(*errors.mean(axis=1).T).tolist()
        apart = np.diff(errors[by_serial], axis=0)
        neighbours_m += np.hypot(apart[..., 0], apart[..., 1]).mean(axis=1).tolist()
    places.headings_deg += [
        off_deg(flown, each, view.aim.yaw_deg)
        for each, view in zip(timed, found.views, strict=True)
    ]
    add_figures(places, found)


def off_ground_m(flown: SurveyFlown, timed: TimedPhoto, view: PhotoView) -> FloatArray:
    """Return how far off the ground lies on which points of a picture are seen, (N, 2) metres."""
    few = replace(view, cols=POINTS, rows=POINTS * view.rows // view.cols)
    true = flown.ground_m(flown.shots[timed.photo.name], few.cols, few.rows)
    cols, rows = np.meshgrid(np.arange(few.cols), np.arange(few.rows))
    found = projected(few.homography, np.column_stack([cols.ravel(), rows.ravel()]))
    return found - true.reshape(-1, 2)


def add_figures(places: Places, found: PhotoRegistration) -> None:
    """Add a registration's own figures."""
    places.residuals_m.append(found.residual_m)
    places.scales += [each.scale for each in found.headings]


def tables(variants: Sequence[Variant], places: Places) -> str:
    """Return the figures as tables."""
    rows = [
        "| photos state | heading off before: median, largest | after: median, 95 %, largest, "
        "degrees | cameras verified, warned about |",
        "|---|---|---|---|",
        *(
            f"| {each.name} | {spread(each.before_deg, 0.5, 1.0)} | "
            f"{spread(each.errors_deg, 0.5, 0.95, 1.0)} | "
            f"{each.verified}, {each.warned} of {each.cameras} |"
            for each in variants
        ),
        "",
        "| of all photos | median, 95 %, largest |",
        "|---|---|",
    ]
    for name, values in (
        ("ground shown, off before, m", places.before_m),
        ("ground shown, off after, m", places.after_m),
        ("between neighbours before, m", places.neighbours_before_m),
        ("between neighbours after, m", places.neighbours_m),
        ("heading off after, degrees", places.headings_deg),
        ("scale of the field, off by %", [abs(100.0 * (s - 1.0)) for s in places.scales]),
        ("stated residual, m", places.residuals_m),
    ):
        rows.append(f"| {name} | {spread(values, 0.5, 0.95, 1.0)} |")
    return "\n".join(rows)


def spread(values: Sequence[float], *shares: float) -> str:
    """Return quantiles of values as text."""
    return ", ".join(f"{each:.2f}" for each in np.quantile(values, shares))


if __name__ == "__main__":
    main()
