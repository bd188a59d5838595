"""How long `recon tag` takes with photos of 20 megapixels.

    python -m benches.product.bench_tag --photos 2000

Baseline: the same files are only read, which no program can avoid. The flight is made by
construction; the photos differ in their EXIF only, each is a whole JPEG of 5472 x 3648.
"""

import argparse
import contextlib
import io
import time
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

from recon.cli.tag import tag_command
from recon.model.units import NS_PER_S

COLS, ROWS = 5472, 3648
WANTED, BUDGET_S = 2000, 600.0


def main() -> None:
    """Make a card, tag it, and print the times."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--photos", type=int, default=400)
    count = parser.parse_args().photos
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
        read_s = time.perf_counter() - began_s
        began_s = time.perf_counter()
        with contextlib.redirect_stdout(io.StringIO()) as printed:
            tag_command([card], record, folder / "tagged")
        took_s = time.perf_counter() - began_s
        print(printed.getvalue())
    print(f"only read: {read_s:.1f} s")
    print(f"tagged: {took_s:.1f} s, {1000.0 * took_s / count:.1f} ms a photo")
    whole_s = took_s * WANTED / count
    how = "measured" if count == WANTED else "extrapolated"
    print(f"{WANTED} photos: {whole_s:.0f} s ({how}; budget {BUDGET_S:.0f} s)")


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
