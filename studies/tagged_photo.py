"""The picture of docs/how-to/after-the-flight.md: photos of a simulated survey beside their masks.

    python -m studies.tagged_photo docs/images/tagged-photos.png

Edges of cloud shade are often wider than a photo shows. So the sky is one of broken cloud, and the
photos are those in which the true transmittance differs most.
"""

import argparse
import csv
from pathlib import Path
from tempfile import TemporaryDirectory

import cv2
import numpy as np

from recon.cli.score import with_methods
from recon.cli.tag import tag_command
from recon.product.write import masked_name
from recon.score import load_scenario
from studies.survey_photos import SIZE_PX, Card, SurveyFlown, fly, true_sunlit
from studies.tagging import PLANNER

SCENARIO = Path(__file__).parents[1] / "scenarios" / "stress" / "cumulus-40.toml"
SEED, MINUTES, SHOWN, GAP_PX = 7, 10.0, 3, 6
DARK_AND_BRIGHT = (15.0, 85.0)
"""Percentiles of a photo's pixels that are compared."""
APART = 15
"""Photos of a row look alike: of so many in the order of time one is shown."""


def main() -> None:
    """Fly, tag, and write the picture."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("out", type=Path)
    out = parser.parse_args().out
    with TemporaryDirectory() as name:
        folder = Path(name)
        scenario = with_methods(load_scenario(SCENARIO), PLANNER, "ideal", "none")
        flown = fly(scenario, SEED, folder / "record", 60.0 * MINUTES)
        Card(flown, folder / "card").write(every=3)
        tag_command([folder / "card"], flown.record, folder / "tagged")
        with (folder / "tagged" / "tags.csv").open(encoding="utf-8", newline="") as file:
            rows = [row for row in csv.DictReader(file) if row["state"] == "mixed"]
        mixed = {row["name"] for row in rows if 0.3 < float(row["sunlit"]) < 0.7}
        columns = [_pair(folder, name) for name in _clearest(flown, mixed)]
    gap = np.full((columns[0].shape[0], GAP_PX, 3), 255, dtype=np.uint8)
    joined = [part for column in columns for part in (gap, column)][1:]
    cv2.imwrite(str(out), np.concatenate(joined, axis=1))


def _clearest(flown: SurveyFlown, names: set[str]) -> list[str]:
    """Return the photos with the darkest shade beside the brightest sun, the clearest first."""
    contrasts = []
    for number, photo in enumerate(flown.photos):
        if photo.name in names:
            dark, bright = np.percentile(true_sunlit(flown, photo), DARK_AND_BRIGHT)
            contrasts.append((float(bright - dark), number, photo.name))
    shown: list[tuple[int, str]] = []
    for _contrast, number, name in sorted(contrasts, reverse=True):
        if len(shown) < SHOWN and all(abs(number - other) >= APART for other, _name in shown):
            shown.append((number, name))
    return [name for _number, name in shown]


def _pair(folder: Path, name: str) -> np.ndarray:
    photo = cv2.imread(str(folder / "card" / name))
    mask = cv2.imread(str(folder / "tagged" / "masks" / masked_name(name)))
    assert photo is not None
    assert mask is not None
    wide = cv2.resize(mask, SIZE_PX, interpolation=cv2.INTER_NEAREST)
    gap = np.full((GAP_PX, SIZE_PX[0], 3), 255, dtype=np.uint8)
    return np.concatenate([photo, gap, wide])


if __name__ == "__main__":
    main()
