"""A site's airspace: limits, boundary, zones, landing pads and elevation."""

from collections.abc import Iterable
from dataclasses import dataclass
from enum import Enum, StrEnum

from recon.model.arrays import FloatArray
from recon.model.geo import GeoPoint, GroundGrid, LocalFrame
from recon.model.mission import DJI


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


class SiteLayer(StrEnum):
    """A layer of a site, by its key in site.toml."""

    BOUNDARY = "boundary"
    KEEP_OUT = "keep_out"
    HEIGHT_ZONES = "height_zones"
    LANDING_PADS = "landing_pads"
    SURVEY_REGIONS = "survey_regions"


def layers_text(layers: Iterable[SiteLayer]) -> str:
    """Return the names of layers for readers."""
    words = ("keep-out" if layer is SiteLayer.KEEP_OUT else layer.value for layer in layers)
    return ", ".join(words).replace("_", " ")


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


LAYER_SPACING_M = 10.0
"""Vertical spacing of vehicles above each other: in a fleet return, on the way to rows, over the
field. The gate keeps 7.5 m at first, and the watchdog holds below 7 m: two barometers may drift
apart by a metre or two within a flight."""

HOVER_DRIFT_M = 2.0
"""What vehicles side by side keep beyond the gate's minimum: one that hovers drifts by a metre or
two, and telemetry of one at 8 m/s is a few tenths of a second old."""


@dataclass(frozen=True, slots=True)
class FlightLimits:
    """Limits for every vehicle of a site, each optional in site.toml."""

    max_height_above_ground_m: float = 120.0
    """The open category's ceiling in Europe, 400 ft (122 m) in the United States."""

    min_height_above_ground_m: float = 5.0
    """Least height above crops, sprinklers and persons; not for takeoff and landing."""

    max_distance_from_home_m: float = 1_000.0
    """A small drone is visible unaided to about half of this; controllers reach farther."""

    max_speed_mps: float = DJI.max_speed_mps
    """DJI's own limit for missions and sticks."""

    min_separation_horizontal_m: float = 15.0
    """Three times the combined error of two GNSS positions (2 x 2.5 m)."""

    min_separation_vertical_m: float = 6.0
    """Two barometers drift apart by a few metres in an hour; layers are `LAYER_SPACING_M` apart."""

    boundary_margin_m: float = 5.0
    """Margin to the boundary and to keep-out zones: GNSS error and a gust."""

    battery_reserve_fraction: float = 0.25
    """Battery fraction that must remain after the return home."""


@dataclass(frozen=True, slots=True, eq=False)
class ElevationModel:
    """The ground's ellipsoidal heights at the centre of each cell of a grid, (rows, cols).

    NaN where the file has no data. Between the centres the ground is bilinear.
    """

    grid: GroundGrid
    ellipsoid_height_m: FloatArray


@dataclass(frozen=True, slots=True, eq=False)
class Airspace:
    """The airspace of a site; without a site only the limits apply.

    `frame` has its origin on the ground; without `elevation` the ground is assumed to be flat at
    that height.
    """

    limits: FlightLimits = FlightLimits()
    frame: LocalFrame | None = None
    boundary: Region | None = None
    zones: tuple[Zone, ...] = ()
    landing_pads: tuple[LandingPad, ...] = ()
    elevation: ElevationModel | None = None
