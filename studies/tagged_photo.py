"""The picture of docs/how-to/after-the-flight.md: photos of a simulated survey beside their masks.

python -m studies.tagged_photo docs/images/tagged-photos.png
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
from studies.survey_photos import SIZE_PX, Card, fly
from studies.tagging import PLANNER, SCENARIO

SEED, MINUTES, SHOWN, GAP_PX = 7, 10.0, 3, 6


def main() -> None:
    """Fly, tag, and write the picture."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("out", type=Path)
    out = parser.parse_args().out
    with TemporaryDirectory() as name:
        folder = Path(name)
        scenario = with_methods(load_scenario(SCENARIO), PLANNER, "ideal", "none")
        flown = fly(scenario, SEED, folder / "record", 60.0 * MINUTES)
        Card(flown, folder / "card").write(every=4)
        tag_command([folder / "card"], flown.record, folder / "tagged")
        with (folder / "tagged" / "tags.csv").open(encoding="utf-8", newline="") as file:
            rows = [row for row in csv.DictReader(file) if row["state"] == "mixed"]
        pairs = [_pair(folder, row["name"]) for row in rows if 0.3 < float(row["sunlit"]) < 0.7]
        columns = sorted(pairs, key=_contrast)[-SHOWN:]
    gap = np.full((columns[0].shape[0], GAP_PX, 3), 255, dtype=np.uint8)
    joined = [part for column in columns for part in (gap, column)][1:]
    cv2.imwrite(str(out), np.concatenate(joined, axis=1))


def _contrast(pair: np.ndarray) -> float:
    """Return how much brighter the photo is where its mask is white: edges may be soft."""
    photo, mask = pair[: SIZE_PX[1]], pair[-SIZE_PX[1] :, :, 0] > 127
    return float(photo[mask].mean() / max(photo[~mask].mean(), 1.0))


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
