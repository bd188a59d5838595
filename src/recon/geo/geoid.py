"""Sea level above the WGS84 ellipsoid: EGM96 at whole degrees, interpolated.

Maps, farmers and authorities give heights above sea level; the ICD and GNSS give them above the
ellipsoid. `tools/geoid_table.py` makes the table from EGM96's grid of 15 minutes and prints how far
the interpolation is from it.
"""

from functools import cache
from math import floor
from pathlib import Path
from struct import iter_unpack

TABLE = Path(__file__).with_name("egm96_1_degree.bin")
ROWS, COLS = 181, 360
ERROR_95_M, ERROR_99_M, LARGEST_ERROR_M = 0.9, 2.0, 12.0
"""Of the interpolation at 95 % and 99 % of places, and the largest, as the tool prints them."""


def geoid_height_m(latitude_deg: float, longitude_deg: float) -> float:
    """Return sea level above the WGS84 ellipsoid at a place, in metres (-107 to 86)."""
    down, right = 90.0 - latitude_deg, longitude_deg % 360.0
    row, col = min(floor(down), ROWS - 2), floor(right) % COLS
    south, east = down - row, right - floor(right)
    table = _table_m()

    def along(of_row: int) -> float:
        first, second = (table[of_row * COLS + each % COLS] for each in (col, col + 1))
        return first + (second - first) * east

    north_m = along(row)
    return north_m + (along(row + 1) - north_m) * south


@cache
def _table_m() -> tuple[float, ...]:
    return tuple(value / 100.0 for (value,) in iter_unpack(">h", TABLE.read_bytes()))
