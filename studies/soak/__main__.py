"""Run the station for hours, or kill its processes; exits with 1 for a figure over its limit.

    python -m studies.soak --minutes 60 --vehicles 32
    python -m studies.soak --kill
    python -m studies.soak --virtual-hours 24 --vehicles 8

The figures of an hour are to be taken on a quiet machine: all stop waits for a processor too.
"""

import argparse
import sys
import tempfile
from pathlib import Path


def main() -> int:
    """Run what was asked for."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0] if __doc__ else "")
    parser.add_argument("--minutes", type=float, default=60.0)
    parser.add_argument("--vehicles", type=int, default=32)
    parser.add_argument("--stop-every", type=float, default=60.0, help="seconds")
    parser.add_argument("--kill", action="store_true", help="kill each process in turn")
    parser.add_argument("--virtual-hours", type=float, help="hours in virtual time")
    parser.add_argument("--folder", type=Path, help="where the files of the run stay")
    asked = parser.parse_args()
    if asked.virtual_hours is not None:
        from studies.soak.virtual_days import fly_days

        return fly_days(asked.virtual_hours, asked.vehicles)
    with tempfile.TemporaryDirectory() as scratch:
        folder = asked.folder or Path(scratch) / "soak"
        if asked.kill:
            from studies.soak.power_cut import cut_power

            return cut_power(folder, asked.vehicles)
        from studies.soak.hour import soak_for

        return soak_for(folder, asked.minutes, asked.vehicles, asked.stop_every)


if __name__ == "__main__":
    sys.exit(main())
