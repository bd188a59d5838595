"""How well photos are tagged: simulated flights, rendered photos on cards, known truth.

    python -m studies.tagging                    # evaluation seeds from 1000
    python -m studies.tagging --first-seed 0 --ideal 2 --real 1

Each flight is flown by the whole station and recorded; its photos are written as on a card, with
whole seconds of a wrong clock and positions with errors of their own. `recon tag` reads record and
card; its table, masks and list are compared with the truth. Clocks wrong by up to 12 hours, by time
zones and daylight saving are tried on each card.
"""

import argparse
import csv
from bisect import bisect_right
from dataclasses import dataclass, field, replace
from math import radians, tan
from pathlib import Path
from random import Random
from tempfile import TemporaryDirectory

import cv2
import numpy as np
import numpy.typing as npt

from recon.cli.score import with_methods
from recon.cli.sim_photos import write_photos
from recon.cli.tag import tag_command
from recon.model.shade import SUNLIT_TRANSMITTANCE
from recon.model.units import NS_PER_S
from recon.product.coverage import cells_on, ground_of, region_of
from recon.product.flight import FlightData
from recon.product.footprint import Aim, PhotoView
from recon.product.photos.photo import read_photo_facts
from recon.product.sun_at import SunHistory
from recon.product.tag import SUNLIT_SHARE, light_around, tag_photo
from recon.product.timing import StatedCamera, TimedPhoto, timed_photos
from recon.product.write import masked_name
from recon.score import Scenario, load_scenario
from recon.sim.photos.card import CardSettings, PhotoShot
from studies.survey_photos import SurveyFlown, fly

SCENARIO = Path(__file__).parents[1] / "scenarios" / "cumulus-40.toml"
PLANNER = "lawnmower_again"
COLS = 456
"""Columns of the photos: a twelfth of the camera's."""
EXACT, REAL = "ideal maps", "sunlit_reference"
CLEARLY = 0.25
"""Transmittances farther than this from the threshold are clearly sun or shade."""
CLOCKS = 25
"""Wrong clocks that are tried on each card."""
ZONES_S = (-25_200.0, -18_000.0, 3_600.0, 7_200.0, 19_800.0, 43_200.0)

BoolArray = npt.NDArray[np.bool_]
FloatArray = npt.NDArray[np.float64]


@dataclass(slots=True)
class TagScore:
    """Sums over photos and flights."""

    flights: int = 0
    photos: int = 0
    unknown: int = 0
    """Photos of which less than half of the ground is known: not called anything."""
    errors: list[float] = field(default_factory=list)
    right: list[bool] = field(default_factory=list)
    mixed_errors: list[float] = field(default_factory=list)
    """Of photos that truly show both."""
    wrong_m2: float = 0.0
    edge_m: float = 0.0
    edge_widths_m: list[float] = field(default_factory=list)
    """Over which the true transmittance goes from a quarter to three quarters; a median a photo."""
    clear_px: int = 0
    clear_wrong_px: int = 0
    """Of the pixels of photos with sun and shade: clearly one of them, and masked as the other."""
    cells: int = 0
    covered: int = 0
    chosen: int = 0
    clock_errors_s: list[float] = field(default_factory=list)
    clocks_refused: int = 0
    others: dict[str, list[float]] = field(default_factory=lambda: {"nearest": [], "mixed": []})
    """Errors of the shade map nearest in time, and of maps mixed without moving them."""


def main() -> None:
    """Fly, tag and print the table."""
    parser = argparse.ArgumentParser(description="Score `recon tag` on simulated flights.")
    parser.add_argument("--first-seed", type=int, default=1000)
    parser.add_argument("--exact", type=int, default=4, help="Flights with true shade maps.")
    parser.add_argument("--ideal", type=int, default=2, help="True maps, projected by telemetry.")
    parser.add_argument("--real", type=int, default=5, help="Flights with detected shade.")
    parser.add_argument("--minutes", type=float, default=8.0, help="Longest flight.")
    options = parser.parse_args()
    for name, method, count in (
        (EXACT, "ideal", options.exact),
        ("ideal maps, projected by telemetry", "ideal", options.ideal),
        (f"detection by {REAL}", REAL, options.real),
    ):
        if count:
            score = TagScore()
            for seed in range(options.first_seed, options.first_seed + count):
                scenario = with_methods(load_scenario(SCENARIO), PLANNER, method, "none")
                add_flight(score, scenario, seed, 60.0 * options.minutes, is_exact=name == EXACT)
                print(f"# {name}, seed {seed}: {score.photos} photos so far", flush=True)
            print(table(name, score), flush=True)


def add_flight(
    score: TagScore,
    scenario: Scenario,
    seed: int,
    limit_s: float,
    every: int = 1,
    *,
    is_exact: bool = False,
) -> None:
    """Fly a scenario, tag its photos with the command, and add the figures."""
    with TemporaryDirectory() as name:
        folder = Path(name)
        ahead_s = round(Random(f"{seed}/clock").uniform(-43_200.0, 43_200.0), 2)
        settings = CardSettings(cols=COLS, clock_ahead_s=ahead_s, states_gimbal=False)
        record = folder / "record"
        flown = fly(SCENARIO, scenario, seed, record, settings, limit_s, is_exact=is_exact)
        write_photos(folder / "card", flown.flight, flown.truth, settings, every)
        tag_command(images=[folder / "card"], flight=flown.record, out=folder / "tagged")
        score.flights += 1
        _add_photos(score, flown, folder / "tagged")
        _add_clocks(score, flown, folder / "card")
        _add_coverage(score, flown, folder / "tagged")


def _add_photos(score: TagScore, flown: SurveyFlown, tagged: Path) -> None:
    for row in _rows(tagged):
        score.photos += 1
        if row["state"] in ("unknown", ""):
            score.unknown += 1
            continue
        mask = cv2.imread(str(tagged / "masks" / masked_name(row["name"])), cv2.IMREAD_GRAYSCALE)
        assert mask is not None
        shot = flown.shots[row["name"]]
        sun = flown.sunlit(shot, mask.shape[1], mask.shape[0])
        lit = sun >= SUNLIT_TRANSMITTANCE
        share, found = float(lit.mean()), float(row["sunlit"])
        score.errors.append(abs(found - share))
        score.right.append((found >= SUNLIT_SHARE) == (share >= SUNLIT_SHARE))
        if lit.all() or not lit.any():
            continue
        score.mixed_errors.append(abs(found - share))
        if float(row["known"]) > 0.98:
            pixel_m = _pixel_m(flown, shot, mask.shape[1])
            is_wrong = (mask > 127) != lit
            score.wrong_m2 += float(is_wrong.sum()) * pixel_m**2
            score.edge_m += _edge_px(lit) * pixel_m
            score.edge_widths_m.append(_edge_width_m(sun, lit, pixel_m))
            is_clear = np.abs(sun - SUNLIT_TRANSMITTANCE) > CLEARLY
            score.clear_px += int(is_clear.sum())
            score.clear_wrong_px += int((is_clear & is_wrong).sum())


def _pixel_m(flown: SurveyFlown, shot: PhotoShot, cols: int) -> float:
    half = tan(radians(flown.settings.camera.across_deg / 2.0))
    return 2.0 * half * float(shot.place_m[2]) / cols


def _edge_px(lit: BoolArray) -> float:
    """Return the length of the edges, from the sides between unequal pixels (Crofton)."""
    sides = (lit[1:] != lit[:-1]).sum() + (lit[:, 1:] != lit[:, :-1]).sum()
    return float(sides) * np.pi / 4.0


def _edge_width_m(sun: FloatArray, lit: BoolArray, pixel_m: float) -> float:
    """Return the median width of the edges, by the slope of the transmittance at them."""
    down, right = np.gradient(sun, pixel_m)
    is_edge = np.zeros_like(lit)
    is_edge[1:] |= lit[1:] != lit[:-1]
    is_edge[:, 1:] |= lit[:, 1:] != lit[:, :-1]
    return float(2.0 * CLEARLY / max(np.median(np.hypot(down, right)[is_edge]), 1e-6))


def _add_coverage(score: TagScore, flown: SurveyFlown, tagged: Path) -> None:
    """Count the cells that were truly photographed in sun, and those of them on the list."""
    area = region_of(flown.flight.surveys)
    assert area is not None
    ground = ground_of(area, flown.flight.frame)
    rows = {row["name"]: row for row in _rows(tagged)}
    in_sun, listed = np.zeros((2, len(ground.centres_m)), dtype=np.bool_)
    for shot in flown.shots.values():
        row = rows.get(shot.name)
        if row is None:
            continue
        on = cells_on(_true_view(flown, shot), ground)
        east_m, north_m = ground.centres_m[on].T
        lit = flown.truth.sky.transmittance(east_m, north_m, shot.at_s) >= SUNLIT_TRANSMITTANCE
        in_sun[on[lit]] = True
        if row["chosen"] == "yes":
            listed[on[lit]] = True
        score.chosen += row["chosen"] == "yes"
    score.cells += int(in_sun.sum())
    score.covered += int((in_sun & listed).sum())


def _true_view(flown: SurveyFlown, shot: PhotoShot) -> PhotoView:
    camera = flown.settings.camera
    aim = Aim(*shot.place_m.tolist(), shot.yaw_deg)
    return PhotoView(aim, camera.across_deg, COLS, camera.rows_of(COLS))


def _add_clocks(score: TagScore, flown: SurveyFlown, card: Path) -> None:
    """Try the card with other clocks; a photo's own truth is its time at the shutter."""
    flight = flown.flight
    photos = [read_photo_facts(path, path.name) for path in sorted(card.glob("*.JPG"))]
    random = Random(f"{flown.truth.sky.settings.seed}/clocks")
    offsets = [*ZONES_S, *(random.uniform(-43_200.0, 43_200.0) for _ in range(CLOCKS))]
    timed = timed_photos(flight, photos, StatedCamera())
    for ahead_s in offsets:
        shown = []
        for photo in photos:
            clock_ns = flown.shots[photo.name].utc_ns + round(ahead_s * NS_PER_S)
            shown.append(replace(photo, clock_ns=clock_ns // NS_PER_S * NS_PER_S))
        found = timed_photos(flight, shown, StatedCamera())
        score.clock_errors_s += [abs(each.offset_s + ahead_s) for each in found.clocks]
        score.clocks_refused += len({p.camera for p in photos}) - len(found.clocks)
    _add_others(score, flown, timed.photos, flight)


def _add_others(
    score: TagScore, flown: SurveyFlown, photos: list[TimedPhoto], flight: FlightData
) -> None:
    """Score simpler ways to know the sun between maps."""
    assert flight.grid is not None
    times_ns = [each.at_ns for each in flight.maps]
    for timed in photos[::5]:
        lit = flown.sunlit(flown.shots[timed.photo.name], 57, 43) >= SUNLIT_TRANSMITTANCE
        if lit.all() or not lit.any():
            continue
        after = bisect_right(times_ns, timed.at_ns)
        around = flight.maps[max(0, after - 1) : after + 1]
        nearest = min(around, key=lambda each: abs(each.at_ns - timed.at_ns))
        # So few maps show no motion: they are mixed as they are.
        for name, maps in (("nearest", [nearest]), ("mixed", around)):
            tag, _mask = tag_photo(timed, light_around(timed, SunHistory(flight.grid, maps)))
            if tag.known >= 0.5:
                score.others[name].append(abs(tag.sunlit - float(lit.mean())))


def _rows(tagged: Path) -> list[dict[str, str]]:
    with (tagged / "tags.csv").open(encoding="utf-8", newline="") as file:
        return list(csv.DictReader(file))


def table(name: str, score: TagScore) -> str:
    """Return the figures as a table."""
    clocks = np.array(score.clock_errors_s or [np.nan])
    tried = len(clocks) + score.clocks_refused
    listed = 100.0 * score.covered / max(1, score.cells)
    rows = (
        ("flights, photos", f"{score.flights}, {score.photos}"),
        ("photos called unknown", f"{score.unknown}"),
        ("sunlit share, mean absolute error", f"{np.mean(score.errors):.3f}"),
        ("the same, photos with sun and shade", f"{np.mean(score.mixed_errors or [0]):.3f}"),
        ("- by the map nearest in time", f"{np.mean(score.others['nearest'] or [0]):.3f}"),
        ("- by two maps, not moved", f"{np.mean(score.others['mixed'] or [0]):.3f}"),
        ("classed right at 0.9, %", f"{100.0 * np.mean(score.right):.1f}"),
        ("masks, boundary error, m", f"{score.wrong_m2 / max(score.edge_m, 1e-9):.2f}"),
        ("edges' true width, a quarter to three quarters of the sun, m: median",
         f"{np.median(score.edge_widths_m or [np.nan]):.0f}"),
        ("ground clearly in sun or shade, masked wrongly, %",
         f"{100.0 * score.clear_wrong_px / max(1, score.clear_px):.2f}"),
        ("cells photographed in sun, on the list, %", f"{listed:.2f}"),
        ("photos on the lists", f"{score.chosen}"),
        ("wrong clocks tried, refused", f"{tried}, {score.clocks_refused}"),
        ("clock offset, error: median, 95 %, largest, s",
         f"{np.median(clocks):.2f}, {np.quantile(clocks, 0.95):.2f}, {clocks.max():.2f}"),
    )  # fmt: skip
    lines = [
        f"| {name} | figure |",
        "|---|---|",
        *(f"| {what} | {value} |" for what, value in rows),
    ]
    return "\n" + "\n".join(lines) + "\n"


if __name__ == "__main__":
    main()
