"""Areas on the ground and what holds in them: regions, zones, landing pads."""

from dataclasses import dataclass
from enum import Enum

import numpy as np
import numpy.typing as npt

from recon.model.geo import GeoPoint

FloatArray = npt.NDArray[np.float64]


@dataclass(frozen=True, slots=True, eq=False)
class Region:
    """A polygon with holes, in east-north metres of the site's local frame.

    `outline_m` is (N, 2), N >= 3, its last point joined to the first and not repeated; each of
    `holes_m` likewise. Edges are straight in the local frame. The edge belongs to the region.
    """

    outline_m: FloatArray
    holes_m: tuple[FloatArray, ...] = ()


class ZoneKind(Enum):
    """Kind of restriction over a zone's region."""

    KEEP_OUT = "keep_out"
    """Stay out between floor and ceiling; without either, at every height."""
    HEIGHT = "height"
    """Fly no lower than the floor and no higher than the ceiling."""


class HeightDatum(Enum):
    """Reference of a zone's floor and ceiling."""

    GROUND = "ground"
    """Height above ground."""
    WGS84 = "wgs84"
    """Height above the WGS84 ellipsoid."""


@dataclass(frozen=True, slots=True, eq=False)
class Zone:
    """A region with a restriction on height or entry.

    `floor_m` and `ceiling_m` are heights above `datum`, None where open-ended;
    `datum` is None when it has neither.
    """

    name: str
    kind: ZoneKind
    region: Region
    floor_m: float | None = None
    ceiling_m: float | None = None
    datum: HeightDatum | None = None


@dataclass(frozen=True, slots=True)
class LandingPad:
    """A place to land; `serial` is the vehicle it belongs to, None for a shared pad."""

    name: str
    serial: str | None
    place: GeoPoint
