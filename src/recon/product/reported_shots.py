"""The photos that an app has reported one by one, as a record has them."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from recon.model.arrays import FloatArray, IntArray

ByIndex = Mapping[int, tuple[int, float, float]]
"""Station time, east and north of a series' photos, by index."""


@dataclass(frozen=True, slots=True, eq=False)
class ReportedShots:
    """The reported photos of one vehicle and series: index (N,) rising, station time, east, north
    (N,); NaN where the place is not known."""

    serial: str
    index: IntArray
    at_ns: IntArray
    east_m: FloatArray
    north_m: FloatArray


def shots_of_reports(
    rows: Mapping[tuple[str, int], ByIndex],
) -> tuple[ReportedShots, ...]:
    """Return the series of (time, east, north) by index, of each serial and series."""
    found = []
    for (serial, _series), by_index in rows.items():
        index = np.array(sorted(by_index), dtype=np.int64)
        values = [by_index[each] for each in index.tolist()]
        at_ns = np.array([value[0] for value in values], dtype=np.int64)
        places_m = np.array([value[1:] for value in values], dtype=np.float64).reshape(-1, 2)
        found.append(ReportedShots(serial, index, at_ns, places_m[:, 0], places_m[:, 1]))
    return tuple(found)
