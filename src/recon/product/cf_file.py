"""Variables of a NetCDF-4 file as CF-1.11 wants them: grids of bytes, axes, times, texts."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt

from recon.model.geo import GroundGrid
from recon.model.units import NS_PER_S

if TYPE_CHECKING:
    import netCDF4

Array = npt.NDArray[Any]

PACKED: Mapping[str, Any] = {"compression": "zlib", "complevel": 4, "shuffle": False}
"""Bytes, which are not shuffled; higher levels take twice the time for two per cent."""
CRS = "crs"
GRID = ("y", "x")
LONGEST_NAME = 64


@dataclass(frozen=True, slots=True)
class CfFile:
    """A file being written, with one grid and one epoch; a `group` of it has no grid."""

    file: "netCDF4.Dataset"
    grid: GroundGrid
    epoch_ns: int
    epoch_utc: str
    """The same as CF writes it: date, space, time of day."""

    def cells(
        self,
        name: str,
        over: tuple[str, ...],
        long_name: str,
        fill: int | None = None,
        **about: Any,
    ) -> "netCDF4.Variable[Any]":
        """Declare bytes on the grid; values are written packed as they are."""
        rows, cols = self.grid.rows, self.grid.cols
        leads = [len(self.file.dimensions[each]) if each == "lead" else 1 for each in over]
        found = self.file.createVariable(
            name,
            "u1",
            (*over, *GRID),
            chunksizes=(*leads, rows, cols),
            fill_value=False if fill is None else fill,
            **PACKED,
        )
        found.set_auto_maskandscale(False)
        units = {} if "flag_values" in about else {"units": "1"}
        found.setncatts({"long_name": long_name, **units, "grid_mapping": CRS, **about})
        return found

    def axis(self, name: str, values: Array, units: str, standard: str, **about: str) -> None:
        """Write a coordinate with a dimension of its own."""
        self.file.createDimension(name, len(values))
        found = self.file.createVariable(name, "f8", (name,))
        found.setncatts({"standard_name": standard, "units": units, **about})
        found[:] = values

    def times(
        self,
        name: str,
        at_ns: Sequence[int] | Array | None,
        group: Any = None,
        over: str | None = None,
        standard_name: str = "time",
    ) -> None:
        """Declare times, with a dimension of their own unless they are over another; without
        values it grows."""
        where = self.file if group is None else group
        if over is None:
            where.createDimension(name, None if at_ns is None else len(at_ns))
        found = where.createVariable(name, "f8", (over or name,), **PACKED)
        found.setncatts(self.time_attributes(standard_name))
        if over is None and standard_name == "time":
            found.axis = "T"
        if at_ns is not None:
            found[:] = self.seconds(np.asarray(at_ns))

    def time_attributes(self, standard_name: str) -> dict[str, str]:
        """Return what a variable of times states of itself."""
        return {
            "standard_name": standard_name,
            "units": f"seconds since {self.epoch_utc}",
            "calendar": "standard",
            "units_metadata": "leap_seconds: none",
        }

    def seconds(self, at_ns: Any) -> Any:
        """Return times as the file has them."""
        return (at_ns - self.epoch_ns) / NS_PER_S

    def numbers(
        self, name: str, over: tuple[str, ...], units: str, group: Any = None, **about: str
    ) -> "netCDF4.Variable[Any]":
        """Declare numbers; NaN where there is none."""
        where = self.file if group is None else group
        found: netCDF4.Variable[Any] = where.createVariable(
            name, "f8", over, compression="zlib", fill_value=np.nan
        )
        found.setncatts({"units": units, **about})
        return found

    def texts(
        self, name: str, over: str, long_name: str, group: Any = None
    ) -> "netCDF4.Variable[Any]":
        """Declare texts as characters: not every program reads strings."""
        where = self.file if group is None else group
        if "name_length" not in where.dimensions:
            where.createDimension("name_length", LONGEST_NAME)
        found: netCDF4.Variable[Any] = where.createVariable(name, "S1", (over, "name_length"))
        found.setncatts({"long_name": long_name, "_Encoding": "utf-8"})
        found.set_auto_chartostring(False)
        return found


def characters(texts: Sequence[str]) -> Array:
    """Return texts as characters (N, LONGEST_NAME), in UTF-8."""
    cut = [
        each.encode("utf-8", "replace")[:LONGEST_NAME].ljust(LONGEST_NAME, b"\0") for each in texts
    ]
    return np.frombuffer(b"".join(cut), "S1").reshape(len(texts), LONGEST_NAME)
