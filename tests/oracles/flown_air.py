"""What must never be so in a site's air, told from true positions alone.

Uses nothing of `recon.safety` or `recon.geo`: plain geometry on the simulator's truth, in metres
east, north and up of the site's origin. The ground is a function, not the station's raster.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from itertools import combinations
from math import cos, hypot, sin

EastNorth = tuple[float, float]

NEAR_HOME_M = 15.0
"""Round its home a vehicle is low by nature."""


@dataclass(frozen=True, slots=True)
class TrueGround:
    """A plane that rises to the east and north, with waves; without any of it flat at 0."""

    rise_east: float = 0.0
    rise_north: float = 0.0
    wave_m: float = 0.0
    wave_length_m: float = 600.0

    @property
    def is_flat(self) -> bool:
        """Whether it is flat at the origin's height."""
        return self.rise_east == self.rise_north == self.wave_m == 0.0

    def height_m(self, east_m: float, north_m: float) -> float:
        """Return the ground's height at a place."""
        turn = 6.283185 / self.wave_length_m
        waves = self.wave_m * sin(east_m * turn) * cos(north_m * turn)
        return self.rise_east * east_m + self.rise_north * north_m + waves


@dataclass(frozen=True, slots=True)
class TrueZone:
    """A polygon with heights above ground, or above the origin (`over_ground` False)."""

    name: str
    corners_m: tuple[EastNorth, ...]
    is_keep_out: bool
    floor_m: float | None = None
    ceiling_m: float | None = None
    over_ground: bool = True


@dataclass(frozen=True, slots=True)
class TrueSite:
    """A site's limits; `error_*_m` are what sensors may hide of a true place."""

    boundary_m: tuple[EastNorth, ...]
    zones: tuple[TrueZone, ...] = ()
    ground: TrueGround = field(default_factory=TrueGround)
    least_height_m: float = 5.0
    most_height_m: float = 120.0
    most_distance_m: float = 1_000.0
    apart_level_m: float = 15.0
    apart_up_m: float = 6.0
    error_level_m: float = 0.5
    error_up_m: float = 0.5


@dataclass(frozen=True, slots=True)
class TruePlace:
    """Where a vehicle in the air truly is. `may_be_low`: it takes off, lands, or was stopped so."""

    east_m: float
    north_m: float
    up_m: float
    home_m: EastNorth = (0.0, 0.0)
    may_be_low: bool = False


@dataclass(frozen=True, slots=True)
class Breach:
    """One thing that is not as it must be, now. `size` is comparable within a kind: larger is
    worse."""

    kind: str
    serials: tuple[str, ...]
    about: str
    size: float
    text: str

    @property
    def key(self) -> tuple[str, tuple[str, ...], str]:
        """What makes it the same breach a moment later."""
        return self.kind, self.serials, self.about


def breaches(site: TrueSite, places: Mapping[str, TruePlace]) -> Iterator[Breach]:
    """Yield what is broken now by these vehicles, all in the air."""
    for (one, a), (other, b) in combinations(sorted(places.items()), 2):
        found = _pair(site, (one, other), a, b)
        if found is not None:
            yield found
    for serial, place in places.items():
        yield from _fence(site, serial, place)
        yield from _zones(site, serial, place)
        yield from _heights(site, serial, place)


def _pair(site: TrueSite, serials: tuple[str, str], a: TruePlace, b: TruePlace) -> Breach | None:
    up_m = abs(a.up_m - b.up_m)
    if up_m >= site.apart_up_m - site.error_up_m:
        return None
    level_m = hypot(a.east_m - b.east_m, a.north_m - b.north_m)
    need_m = site.apart_level_m - site.error_level_m
    if level_m >= need_m:
        return None
    text = f"{level_m:.1f} m apart, {up_m:.1f} m in height"
    return Breach("separation", serials, "", need_m - level_m, text)


def _fence(site: TrueSite, serial: str, place: TruePlace) -> Iterator[Breach]:
    inside_m = depth_m(site.boundary_m, (place.east_m, place.north_m))
    if inside_m < -site.error_level_m:
        text = f"{-inside_m:.1f} m outside the boundary"
        yield Breach("fence", (serial,), "", -inside_m, text)
    far_m = hypot(place.east_m - place.home_m[0], place.north_m - place.home_m[1])
    over_m = far_m - site.most_distance_m
    if over_m > site.error_level_m:
        yield Breach("home distance", (serial,), "", over_m, f"{far_m:.0f} m from home")


def _zones(site: TrueSite, serial: str, place: TruePlace) -> Iterator[Breach]:
    here_m = place.east_m, place.north_m
    for zone in site.zones:
        inside_m = depth_m(zone.corners_m, here_m)
        if inside_m <= site.error_level_m:
            continue
        under_m = site.ground.height_m(*here_m) if zone.over_ground else 0.0
        height_m = place.up_m - under_m
        above_m = -1e9 if zone.ceiling_m is None else height_m - zone.ceiling_m
        below_m = -1e9 if zone.floor_m is None else zone.floor_m - height_m
        if zone.is_keep_out:
            size_m = min(inside_m, -above_m, -below_m)
            if size_m > max(site.error_level_m, site.error_up_m):
                text = f"{inside_m:.1f} m inside keep-out zone {zone.name}, {height_m:.1f} m high"
                yield Breach("keep-out zone", (serial,), zone.name, size_m, text)
            continue
        if _is_low(place):
            below_m = -1e9
        if (size_m := max(above_m, below_m)) > site.error_up_m:
            text = f"{height_m:.1f} m high in height zone {zone.name}"
            yield Breach("height zone", (serial,), zone.name, size_m, text)


def _heights(site: TrueSite, serial: str, place: TruePlace) -> Iterator[Breach]:
    height_m = place.up_m - site.ground.height_m(place.east_m, place.north_m)
    text = f"{height_m:.1f} m above ground"
    if (over_m := height_m - site.most_height_m) > site.error_up_m:
        yield Breach("too high", (serial,), "", over_m, text)
    under_m = site.least_height_m - height_m
    if under_m > site.error_up_m and not _is_low(place):
        yield Breach("too low", (serial,), "", under_m, text)


def _is_low(place: TruePlace) -> bool:
    away_m = hypot(place.east_m - place.home_m[0], place.north_m - place.home_m[1])
    return place.may_be_low or away_m <= NEAR_HOME_M


def depth_m(corners_m: Sequence[EastNorth], point_m: EastNorth) -> float:
    """Return how far inside a polygon a point is; negative outside."""
    east_m, north_m = point_m
    nearest, is_inside = 1e18, False
    x0, y0 = corners_m[-1]
    for x1, y1 in corners_m:
        dx, dy = x1 - x0, y1 - y0
        share = ((east_m - x0) * dx + (north_m - y0) * dy) / max(dx * dx + dy * dy, 1e-18)
        share = min(1.0, max(0.0, share))
        away = (east_m - x0 - share * dx) ** 2 + (north_m - y0 - share * dy) ** 2
        nearest = min(nearest, away)
        if (y0 > north_m) != (y1 > north_m) and east_m < x0 + (north_m - y0) / dy * dx:
            is_inside = not is_inside
        x0, y0 = x1, y1
    return nearest**0.5 if is_inside else -(nearest**0.5)
