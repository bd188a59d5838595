"""The process that reads a NetCDF file: `python -I -m recon.light.netcdf_process FILE`.

NetCDF's library allocates what a header claims, and some damage ends the process that reads it. So
this one limits itself, and prints the variables with numbers as an .npz of `names` and of arrays
`0`, `1` and so on, times in seconds since 1970. Else it ends with 1 and prints a sentence.
"""

import sys
from collections.abc import Iterator
from math import prod
from typing import Any

import numpy as np

from recon.light.rows import key_of
from recon.processes.limits import limit_itself

MOST_CPU_S = 60
MOST_MEMORY_BYTES = 2 * 1024**3
"""Limit of address space: the libraries map half of it before a file is read."""
MOST_VALUES = 16_000_000
"""Eight hours of 500 sensors, each second."""
UNIX_TIME = "seconds since 1970-01-01"


def main() -> None:
    """Read what the command line names."""
    limit_itself(MOST_MEMORY_BYTES, MOST_CPU_S)
    try:
        found = dict(variables(sys.argv[1]))
    except (ValueError, OSError, RuntimeError, MemoryError) as problem:
        print(f"{problem!s:.200}" or "a file too large for memory")
        sys.exit(1)
    arrays = {str(number): each for number, each in enumerate(found.values())}
    np.savez(sys.stdout.buffer, allow_pickle=False, names=np.array([*found]), **arrays)


def variables(path: str) -> Iterator[tuple[str, Any]]:
    """Yield names and values of a file; raises `ValueError`, OSError, RuntimeError, MemoryError."""
    import netCDF4

    with netCDF4.Dataset(path) as file:
        # Text has Python's type for one.
        found = {
            name: each
            for name, each in file.variables.items()
            if getattr(each.dtype, "kind", "") in ("f", "i", "u")
        }
        if sum(prod(each.shape) for each in found.values()) > MOST_VALUES:
            raise ValueError(f"more than {MOST_VALUES} values")
        for name, each in found.items():
            values = np.ma.filled(np.ma.asarray(each[...], np.float64), np.nan)
            yield name, _unix_s(each, values) if key_of(name) == "time" else values


def _unix_s(variable: Any, values: Any) -> Any:
    import netCDF4

    units, calendar = (getattr(variable, what, "") for what in ("units", "calendar"))
    try:
        at = netCDF4.num2date(values, units, calendar or "standard")
        return np.asarray(netCDF4.date2num(at, UNIX_TIME), np.float64)
    except (ValueError, TypeError, AttributeError, OverflowError):
        raise ValueError(f"time in units {units!a:.80}, not 'seconds since ...'") from None


if __name__ == "__main__":
    main()
