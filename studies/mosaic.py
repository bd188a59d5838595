"""How true mosaics are: simulated surveys, rendered photos, the truth of every pixel.

    python -m studies.mosaic                       # evaluation seeds 1000 to 1004
    python -m studies.mosaic --seeds 0-1 --minutes 6

The whole station flies the survey with detected shade and is recorded; the photos of its drones are
rendered, and `recon mosaic` makes its mosaic of record and photos alone. Each pixel's photo has a
true time and pose, so the sky tells whether its ground lay in sun. Beside it stands the mosaic that
has no regard to light: of the same photos, each piece of ground from the one most nearly above it.
Places are measured in the finished picture, against the land as it is drawn from straight above.
"""

import argparse
from collections.abc import Sequence
from contextlib import redirect_stdout
from dataclasses import dataclass, field
from io import StringIO
from pathlib import Path
from tempfile import TemporaryDirectory
from time import process_time

import numpy as np

from recon.cli.mosaic import mosaic_command
from recon.cli.score import with_methods
from recon.cli.sim_photos import write_photos
from recon.score import load_scenario
from recon.sim.photos.card import CardSettings
from studies.survey_photos import SurveyFlown, fly
from studies.true_headings import headings_off
from studies.true_mosaic import Lights, lights_of, places_off_m
from studies.true_odm import write_odm

SCENARIO = Path(__file__).parents[1] / "scenarios" / "cumulus-40.toml"
PLANNER, DETECTION, FORECAST = "sunlit_first", "sunlit_reference", "advection"
COLS = 660
"""Columns of the photos: 12 cm on the ground from 56 m, an eighth of the camera's."""
OFF_DEG = (53.0, 180.0)


@dataclass(slots=True)
class MosaicFigures:
    """Of all flights together; errors of places in metres."""

    flights: int = 0
    photos: int = 0
    lights: Lights = field(default_factory=Lights)
    preview_m: list[float] = field(default_factory=list)
    exact_m: list[float] = field(default_factory=list)
    """The same with the true cameras and ground, as a perfect run of OpenDroneMap leaves them."""
    headings: dict[float, list[list[float]]] = field(
        default_factory=lambda: {off_deg: [] for off_deg in OFF_DEG}
    )
    """Errors in degrees of each flight's photos, none where they are warned of; by the error of
    what the photos state."""


def main() -> None:
    """Fly, render, make mosaics and print the table."""
    parser = argparse.ArgumentParser(description="Score `recon mosaic` on simulated flights.")
    parser.add_argument("--seeds", default="1000-1004", help="FIRST-LAST.")
    parser.add_argument("--minutes", type=float, default=7.0, help="Longest flight.")
    parser.add_argument("--keep", type=Path, help="Folder for records, photos and mosaics.")
    options = parser.parse_args()
    first, _, last = options.seeds.partition("-")
    figures = MosaicFigures()
    for seed in range(int(first), int(last or first) + 1):
        with TemporaryDirectory() as name:
            folder = Path(name) if options.keep is None else options.keep / str(seed)
            started_s = process_time()
            line = add_flight(figures, seed, folder, 60.0 * options.minutes)
            print(f"# seed {seed}: {line}, {process_time() - started_s:.0f} s", flush=True)
    print(table(figures), flush=True)


def add_flight(figures: MosaicFigures, seed: int, folder: Path, limit_s: float) -> str:
    """Fly a seed's survey, make its mosaics and add their figures; return them as a line."""
    settings = CardSettings(cols=COLS)
    scenario = with_methods(load_scenario(SCENARIO), PLANNER, DETECTION, FORECAST)
    flown = fly(SCENARIO, scenario, seed, folder / "record", settings, limit_s)
    card = folder / "card"
    count = write_photos(card, flown.flight, flown.truth, settings)
    preview = made(flown, card, folder / "preview")
    exact = made(flown, card, folder / "exact", write_odm(flown, folder / "odm"))
    lights, off_m = lights_of(preview, flown), places_off_m(preview, flown)
    exact_m = places_off_m(exact, flown)
    figures.flights += 1
    figures.photos += count
    figures.lights += lights
    figures.preview_m += off_m
    figures.exact_m += exact_m
    for off_deg in OFF_DEG:
        turned = folder / f"off-{off_deg:g}"
        figures.headings[off_deg].append(headings_off(flown, card, turned, off_deg))
    return f"{count} photos, {lights}, places {_metres(off_m)}, {_metres(exact_m)} m off"


def made(flown: SurveyFlown, card: Path, out: Path, odm: Path | None = None) -> Path:
    """Make the mosaic of a card's photos by the command; return its folder."""
    with redirect_stdout(StringIO()):
        mosaic_command(flight=flown.record, photos=[card], out=out, odm=odm)
    return out


def table(figures: MosaicFigures) -> str:
    """Return the figures as a table."""
    lights = figures.lights
    rows = [
        ("flights, photos", f"{figures.flights}, {figures.photos}"),
        ("pixels truly in shade, %", f"{lights.shaded_percent:.3f}"),
        ("- of the mosaic without regard to light", f"{lights.plain_percent:.2f}"),
        ("pixels at most a quarter lit, %", f"{lights.dark_percent:.3f}"),
        ("ground photographed in sun and left empty, %", f"{lights.empty_percent:.2f}"),
        ("preview, error of places: median, 95 %, m", _metres(figures.preview_m)),
        ("by true cameras and ground: the same", _metres(figures.exact_m)),
        *(
            (
                f"gimbal yaw {off_deg:g} degrees off: cameras, warned of; 95 %, largest error",
                _headings(found),
            )
            for off_deg, found in figures.headings.items()
        ),
    ]
    lines = ["| figure | |", "|---|---|", *(f"| {what} | {value} |" for what, value in rows)]
    return "\n" + "\n".join(lines) + "\n"


def _headings(found: Sequence[Sequence[float]]) -> str:
    errors = [error_deg for each in found for error_deg in each] or [np.nan]
    warned = sum(not each for each in found)
    return f"{len(found)}, {warned}; {np.quantile(errors, 0.95):.1f}, {max(errors):.1f}"


def _metres(errors_m: Sequence[float]) -> str:
    found = np.array(errors_m or [np.nan])
    return f"{np.median(found):.3f}, {np.quantile(found, 0.95):.3f}"


if __name__ == "__main__":
    main()
