"""CPU seconds of commands that an operator waits for, beside a bare Python.

    python -m benches.cli.bench_startup [--repeats 5] [--against PATH/src]

Measured is the user and system time of a whole process, the least of all repeats: other programs on
the machine change the elapsed time far more than that. With another checkout's source, a plan and
an import are run by both in turn, and the ratio is that of their elapsed times.
"""

import argparse
import os
import resource
import subprocess
import sys
import time
from pathlib import Path
from statistics import median
from tempfile import TemporaryDirectory

from recon import wire

LIMITS_S = {
    ("--help",): 0.3,
    ("hold", "--help"): 0.3,
    ("all-stop", "--help"): 0.3,
    ("inspect", "-"): 1.0,
}
SOURCES = Path(__file__).parents[2]
OWN_SOURCE = SOURCES / "src"
MOST_RATIO = 0.6
INSPECTED = wire.encode(wire.Acknowledgment(positive=1, source_pid=253))


def cpu_s(command: list[str]) -> float:
    """Run a command to its end; return its user and system time."""
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    subprocess.run(command, input=INSPECTED, stdout=subprocess.DEVNULL, check=True)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return (after.ru_utime - before.ru_utime) + (after.ru_stime - before.ru_stime)


def beside(other: Path, repeats: range) -> bool:
    """Print how long a plan and an import take beside another checkout's; return whether well."""
    is_good = True
    for name in ("plan", "site import"):
        took = [[elapsed_s(name, source) for source in (OWN_SOURCE, other)] for _ in repeats]
        own_s, other_s = (median(times) for times in zip(*took, strict=True))
        is_good = is_good and own_s / other_s < MOST_RATIO
        print(
            f"recon {name:<18} {own_s:.3f} s, {own_s / other_s:.2f} of the other's {other_s:.3f} s"
        )
    return is_good


def elapsed_s(name: str, source: Path) -> float:
    """Run a command of a checkout on the example's field; return how long it took."""
    field = str(SOURCES / "examples" / "river-field.geojson")
    environment = {**os.environ, "PYTHONPATH": str(source)}
    with TemporaryDirectory() as folder:
        site = str(Path(folder) / "site")
        new = ["site", "new", site, "--at", "41.9012,-93.6034", "--ground-altitude-m", "275"]
        words = {
            "plan": ["plan", field, "--gsd", "2cm", "--drones", "2"],
            "site import": ["site", "import", site, field, "--as", "survey_regions"],
        }[name]
        for each in (new, words):
            began_s = time.monotonic()
            command = [sys.executable, "-m", "recon", *each]
            subprocess.run(command, stdout=subprocess.DEVNULL, env=environment, check=True)
        return time.monotonic() - began_s


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--repeats", type=int, default=5)
    parser.add_argument("--against", type=Path, help="Folder src of another checkout.")
    options = parser.parse_args()
    repeats = range(options.repeats)
    bare_s = min(cpu_s([sys.executable, "-c", "pass"]) for _ in repeats)
    print(f"{'bare Python':<24} {bare_s:.3f} s of CPU")
    is_good = True
    for words, limit_s in LIMITS_S.items():
        took_s = min(cpu_s([sys.executable, "-m", "recon", *words]) for _ in repeats)
        is_good = is_good and took_s < limit_s
        print(f"{'recon ' + ' '.join(words):<24} {took_s:.3f} s of CPU, limit {limit_s:g} s")
    if options.against is not None:
        is_good = beside(options.against, repeats) and is_good
    print("good" if is_good else "FAILED: a command starts too slowly")
    return 0 if is_good else 1


if __name__ == "__main__":
    sys.exit(main())
