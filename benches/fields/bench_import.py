"""Time and memory of reading fields: a farm's register, and files made to do harm.

    python -m benches.fields.bench_import [--fields 1000] [--only TEXT]

Each file is read as `recon site import` reads it, in a fresh process that prints its seconds and
the most memory of itself and of the process that it starts.
"""

import argparse
import json
import subprocess
import sys
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from random import Random
from tempfile import TemporaryDirectory

from tests.fields.hostile import HOSTILE, LARGE
from tests.fields.written import drawn, geojson, kml

LIMIT_MB = 300.0
CORNERS = 100
READ = """
import json, resource, sys, time
from pathlib import Path
from recon.fields.field_file import read_import
from recon.model.errors import SiteError
data, began_s = Path(sys.argv[1]).read_bytes(), time.monotonic()
try:
    said = f"{len(read_import('file', data).features)} shapes"
except SiteError as problem:
    said = str(problem)
# Not `ru_maxrss`, which begins with that of the process that started this one.
own_kb = int(Path("/proc/self/status").read_text().partition("VmHWM:")[2].split()[0])
most_kb = max(own_kb, resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss)
print(json.dumps([time.monotonic() - began_s, most_kb / 1024, said]))
"""


@dataclass(frozen=True, slots=True)
class Reading:
    """What one file took, and what was said of it."""

    seconds: float
    most_mb: float
    said: str


def reading_of(data: bytes) -> Reading:
    """Read a file in a fresh process."""
    with TemporaryDirectory() as folder:
        path = Path(folder) / "file"
        path.write_bytes(data)
        words = [sys.executable, "-c", READ, str(path)]
        answer = subprocess.run(words, capture_output=True, check=True).stdout
    return Reading(*json.loads(answer))


def registers(count: int) -> Mapping[str, bytes]:
    """Return a farm's register of fields, about 100 corners each, as GeoJSON and KML."""
    random = Random(1)
    fields = [
        (f"field {n}", drawn(random).segmentize(drawn(random).length / CORNERS))
        for n in range(count)
    ]
    return {"register, GeoJSON": geojson(fields, random), "register, KML": kml(fields, random)}


def is_within(name: str, data: bytes, limit_s: float) -> bool:
    """Read a file and print a line; return whether the limits are kept."""
    read = reading_of(data)
    is_good = read.seconds < limit_s and read.most_mb < LIMIT_MB
    mark = " " if is_good else "!"
    print(f"{mark} {name:<36} {read.seconds:5.2f} s {read.most_mb:5.0f} MB  {read.said[:80]}")
    return is_good


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--fields", type=int, default=1000)
    parser.add_argument("--only", default="", help="Files with this in their name.")
    options = parser.parse_args()
    hostile = {name: make for name, (make, _expected) in HOSTILE.items()}
    files = [
        *((name, lambda data=data: data, 3.0) for name, data in registers(options.fields).items()),
        *((name, make, 2.0) for name, make in {**hostile, **LARGE}.items()),
    ]
    good = [
        is_within(name, make(), limit_s) for name, make, limit_s in files if options.only in name
    ]
    print("good" if all(good) else "FAILED: a file takes more")
    return 0 if all(good) else 1


if __name__ == "__main__":
    sys.exit(main())
