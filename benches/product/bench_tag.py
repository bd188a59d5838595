"""How long `recon tag` takes with photos of 20 megapixels, beside another checkout's.

    python -m benches.product.bench_tag --photos 2000 [--against PATH/src] [--rounds 1]

The two tag in turn, each in a process of its own. Baseline: the same files are only read, which no
program can avoid. The flight is made by construction; the photos differ in their EXIF only, each is
a whole JPEG of 5472 x 3648. So neighbours show the same picture and are refused by the place they
state; to find that out takes as long as to register them.
"""

import argparse
import io
import os
import resource
import statistics
import subprocess
import sys
import time
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
from PIL import Image
from tests.product.made_flight import (
    ONE,
    START_NS,
    UTC_AHEAD_NS,
    flight,
    write_photo,
    write_record,
)

from recon.model.units import NS_PER_S

OWN_SOURCE = Path(__file__).parents[2] / "src"
COLS, ROWS = 5472, 3648
WANTED, BUDGET_S = 2000, 600.0


@dataclass(frozen=True, slots=True)
class Tagged:
    """What one run of the command took."""

    elapsed_s: float
    processor_s: float
    printed: str


def main() -> None:
    """Make a card, tag it, and print the times."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--photos", type=int, default=400)
    parser.add_argument("--against", type=Path, help="Folder src of another checkout.")
    parser.add_argument("--rounds", type=int, default=1)
    options = parser.parse_args()
    count: int = options.photos
    sources = [OWN_SOURCE] + ([options.against] if options.against else [])
    with TemporaryDirectory() as name:
        folder = Path(name)
        card = folder / "card"
        card.mkdir()
        size = _write_card(card, count)
        record = write_record(flight(maps_every_s=2.5), folder / "flight.mcap")
        print(f"{count} photos of {size / 1e6:.1f} MB; {COLS} x {ROWS}")
        began_s = time.perf_counter()
        for path in sorted(card.iterdir()):
            path.read_bytes()
        print(f"only read: {time.perf_counter() - began_s:.1f} s")
        rounds = [[_tagged(each, card, record) for each in sources] for _ in range(options.rounds)]
    print(rounds[0][0].printed)
    own = _shown("tagged", [runs[0] for runs in rounds], count)
    if options.against:
        other = _shown("the other", [runs[1] for runs in rounds], count)
        print(
            f"ratio: {own.elapsed_s / other.elapsed_s:.2f} of the time, "
            f"{own.processor_s / other.processor_s:.2f} of the processor time"
        )
    whole_s = own.elapsed_s * WANTED / count
    how = "measured" if count == WANTED else "extrapolated"
    print(f"{WANTED} photos: {whole_s:.0f} s ({how}; budget {BUDGET_S:.0f} s)")


def _tagged(source: Path, card: Path, record: Path) -> Tagged:
    """Tag the photos by a checkout's source into a new folder."""
    with TemporaryDirectory(dir=card.parent) as out:
        before = resource.getrusage(resource.RUSAGE_CHILDREN)
        began_s = time.perf_counter()
        words = ["tag", str(card), "--flight", str(record), "--out", f"{out}/tagged"]
        run = subprocess.run(
            [sys.executable, "-m", "recon", *words],
            env={**os.environ, "PYTHONPATH": str(source)},
            stdout=subprocess.PIPE,
            check=True,
            text=True,
        )
        elapsed_s = time.perf_counter() - began_s
        after = resource.getrusage(resource.RUSAGE_CHILDREN)
    used_s = (after.ru_utime - before.ru_utime) + (after.ru_stime - before.ru_stime)
    return Tagged(elapsed_s, used_s, run.stdout)


def _shown(name: str, runs: list[Tagged], count: int) -> Tagged:
    """Print and return the medians of a checkout's runs."""
    median = Tagged(
        statistics.median(run.elapsed_s for run in runs),
        statistics.median(run.processor_s for run in runs),
        "",
    )
    print(
        f"{name}: {median.elapsed_s:.1f} s, {median.processor_s:.1f} s of processor, "
        f"{1000.0 * median.elapsed_s / count:.1f} ms a photo"
    )
    return median


def _write_card(card: Path, count: int) -> int:
    """Write photos along the way; return the size of one."""
    random = np.random.default_rng(1)
    # Noise of a few levels on larger structures: about the size that a survey camera's photos have.
    coarse = random.integers(60, 170, (ROWS // 32, COLS // 32, 3), dtype=np.uint8)
    pixels = np.asarray(Image.fromarray(coarse).resize((COLS, ROWS), Image.Resampling.BICUBIC))
    noisy = pixels.astype(np.int16) + random.normal(0.0, 7.0, pixels.shape).astype(np.int16)
    whole = io.BytesIO()
    Image.fromarray(np.clip(noisy, 0, 255).astype(np.uint8)).save(whole, "JPEG", quality=90)
    body = whole.getvalue()[2:]
    moments_s = np.linspace(ONE.starts_s + 0.7, ONE.starts_s + ONE.lasts_s - 2.0, count)
    for number, at_s in enumerate(moments_s.tolist()):
        east, north, _yaw = ONE.place(at_s)
        clock_ns = UTC_AHEAD_NS + START_NS + round((at_s + 3_600.0) * NS_PER_S)
        path = card / f"DJI_{number:04d}.JPG"
        write_photo(path, place_m=(float(east), float(north)), clock_ns=clock_ns, size=(COLS, 8))
        head = _exif_segment(path.read_bytes())
        path.write_bytes(b"\xff\xd8" + head + body)
    return len(body)


def _exif_segment(data: bytes) -> bytes:
    at = data.index(b"\xff\xe1")
    return data[at : at + 2 + int.from_bytes(data[at + 2 : at + 4])]


if __name__ == "__main__":
    main()
