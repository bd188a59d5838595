"""CPU seconds of commands that an operator waits for, beside a bare Python.

    python -m benches.cli.bench_startup [--repeats 5]

Measured is the user and system time of a whole process, the least of all repeats: other programs on
the machine change the elapsed time far more than that.
"""

import argparse
import resource
import subprocess
import sys

from recon import wire

LIMITS_S = {
    ("--help",): 0.3,
    ("hold", "--help"): 0.3,
    ("all-stop", "--help"): 0.3,
    ("inspect", "-"): 1.0,
}
INSPECTED = wire.encode(wire.Acknowledgment(positive=1, source_pid=253))


def cpu_s(command: list[str]) -> float:
    """Run a command to its end; return its user and system time."""
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    subprocess.run(command, input=INSPECTED, stdout=subprocess.DEVNULL, check=True)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return (after.ru_utime - before.ru_utime) + (after.ru_stime - before.ru_stime)


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--repeats", type=int, default=5)
    repeats = range(parser.parse_args().repeats)
    bare_s = min(cpu_s([sys.executable, "-c", "pass"]) for _ in repeats)
    print(f"{'bare Python':<24} {bare_s:.3f} s of CPU")
    is_good = True
    for words, limit_s in LIMITS_S.items():
        took_s = min(cpu_s([sys.executable, "-m", "recon", *words]) for _ in repeats)
        is_good = is_good and took_s < limit_s
        print(f"{'recon ' + ' '.join(words):<24} {took_s:.3f} s of CPU, limit {limit_s:g} s")
    print("good" if is_good else "FAILED: a command starts too slowly")
    return 0 if is_good else 1


if __name__ == "__main__":
    sys.exit(main())
