"""Points on the earth and grids on the ground."""

from dataclasses import dataclass

from recon.model.units import is_finite


@dataclass(frozen=True, slots=True)
class LatLon:
    """A horizontal WGS84 position, for where no height can be trusted."""

    latitude_deg: float
    longitude_deg: float

    def is_valid(self) -> bool:
        """Return whether the numbers are finite and on the globe."""
        # NaN compares as false.
        return abs(self.latitude_deg) <= 90.0 and abs(self.longitude_deg) <= 180.0


@dataclass(frozen=True, slots=True)
class GeoPoint:
    """A WGS84 position; the height is above the ellipsoid."""

    latitude_deg: float
    longitude_deg: float
    ellipsoid_height_m: float

    def is_valid(self) -> bool:
        """Return whether the numbers are finite and on the globe."""
        return (
            is_finite(self.latitude_deg, self.longitude_deg, self.ellipsoid_height_m)
            and abs(self.latitude_deg) <= 90.0
            and abs(self.longitude_deg) <= 180.0
        )


@dataclass(frozen=True, slots=True)
class LocalFrame:
    """The site's east-north-up frame: tangent to the ellipsoid at `origin`."""

    origin: GeoPoint


@dataclass(frozen=True, slots=True)
class GroundGrid:
    """A raster on the ground, in east-north metres of `frame`.

    `west_m` and `north_m` are the outer edges of the upper-left cell, not its centre;
    row 0 is north.
    """

    frame: LocalFrame
    west_m: float
    north_m: float
    cell_m: float
    rows: int
    cols: int

    @property
    def east_m(self) -> float:
        """East edge."""
        return self.west_m + self.cols * self.cell_m

    @property
    def south_m(self) -> float:
        """South edge."""
        return self.north_m - self.rows * self.cell_m
