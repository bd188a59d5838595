"""Procedural farmland seen from above: plots with crop rows, roads, tracks, water, trees, farms.

The land is described once (rectangles, lines, points in east-north metres) and drawn at any
resolution, so that coarse rasters of the distance agree with the fine ones below the camera.
"""

from dataclasses import dataclass, replace
from functools import lru_cache
from itertools import pairwise

import numpy as np

from recon.model.arrays import FloatArray

Colour = tuple[float, float, float]
Box = tuple[float, float, float, float]
"""West, south, east, north in metres."""

SECTION_M = 805.0
"""Half a mile between roads, as in the corn belt's survey grid."""
ROAD_EAST_M, ROAD_NORTH_M = 236.0, -287.0
"""Position of one crossing: roads pass the origin at a distance."""
LARGEST_PLOT_M = 240.0
SMALLEST_PLOT_M = 80.0

CROPS: tuple[tuple[str, Colour, float], ...] = (
    ("maize", (79, 99, 55), 0.26),
    ("soybean", (104, 121, 67), 0.24),
    ("hay", (128, 137, 86), 0.14),
    ("wheat", (181, 164, 112), 0.12),
    ("stubble", (166, 148, 110), 0.08),
    ("soil", (127, 108, 86), 0.07),
    ("pasture", (112, 126, 76), 0.09),
)
"""Name, colour (RGB, muted as seen from 100 m), share of plots; the rest is meadow."""
MEADOW: Colour = (120, 130, 84)
CROP_BRIGHTNESS, CROP_HUE = 0.10, 0.05
"""Deviation of a year's crop colours: in brightness, and in red and blue, as shares. Stage and
variety differ; the plots of a year have it in common."""
PALETTE_STREAM = 9
BARENESS = {"soil": 1.0, "stubble": 0.6, "maize": 0.25, "soybean": 0.25, "wheat": 0.3}
"""Share of bare soil visible between plants; 0.1 for crops not listed."""
ROOFS: tuple[Colour, ...] = ((176, 178, 180), (134, 66, 54), (92, 94, 98), (188, 180, 164))
"""Sheet metal, red barn, slate, old metal."""

FIRST_FARM_M = (154.0, 66.0)
"""South-west corner of a farm near the origin: the keep-out zone of the demonstration site."""
YARD_M = 50.0
CREEK_FROM_FARM_M = 95.0
CREEK_BEND_M = 160.0
"""Length along the creek of its bend around the farm (Gaussian)."""
FARMS_PER_CROSSING = 0.4
PONDS = 60
POND_EDGE_M = 5.0
"""Width of grass around water."""
NO_POND_WITHIN_M = 500.0
"""No ponds in the fields that are surveyed, around the origin."""
HEIGHT_PER_RADIUS = 2.6


@dataclass(frozen=True, slots=True)
class Plot:
    """A field: rectangle in metres, colour, and crop rows."""

    west_m: float
    south_m: float
    east_m: float
    north_m: float
    colour: Colour
    row_spacing_m: float
    row_contrast: float
    rows_run_north: bool
    patchiness: float
    bareness: float
    """Share of bare soil, 0 to 1: wet ground darkens by this share, as soil darkens most."""
    crop: str

    @property
    def box_m(self) -> Box:
        """West, south, east, north."""
        return self.west_m, self.south_m, self.east_m, self.north_m


@dataclass(frozen=True, slots=True)
class Tree:
    """A tree's crown."""

    east_m: float
    north_m: float
    radius_m: float
    shade: float

    @property
    def height_m(self) -> float:
        """Height of the top, in proportion to the crown."""
        return HEIGHT_PER_RADIUS * self.radius_m


@dataclass(frozen=True, slots=True)
class Building:
    """A building: roof ridge along the longer side; shadows are those of a box of `height_m`."""

    west_m: float
    south_m: float
    east_m: float
    north_m: float
    height_m: float
    colour: Colour

    @property
    def box_m(self) -> Box:
        """West, south, east, north."""
        return self.west_m, self.south_m, self.east_m, self.north_m


@dataclass(frozen=True, slots=True)
class Pond:
    """An ellipse of water."""

    east_m: float
    north_m: float
    across_m: float
    along_m: float
    turned_deg: float
    """Clockwise from east."""

    @property
    def box_m(self) -> Box:
        """A box that holds it, grass edge included, at any rotation."""
        reach_m = max(self.across_m, self.along_m) + POND_EDGE_M
        east, north = self.east_m, self.north_m
        return east - reach_m, north - reach_m, east + reach_m, north + reach_m


@dataclass(frozen=True, slots=True, eq=False)
class Farmland:
    """Everything on the land within `half_width_m` of the origin."""

    plots: tuple[Plot, ...]
    tracks: tuple[Box, ...]
    """Rectangles west, south, east, north of dirt tracks."""
    trees: tuple[Tree, ...]
    creek_m: FloatArray
    """(N, 2) east, north."""
    roads_east_m: tuple[float, ...]
    roads_north_m: tuple[float, ...]
    half_width_m: float
    yards: tuple[Box, ...] = ()
    """Gravel yards of farms."""
    buildings: tuple[Building, ...] = ()
    ponds: tuple[Pond, ...] = ()


@lru_cache(maxsize=4)
def lay_out(seed: int, half_width_m: float = 6_200.0) -> Farmland:
    """Return the land of a seed."""
    # Order of drawing is part of the seed's meaning: adding a draw in between changes all land.
    random = np.random.default_rng(seed)
    roads_east = _road_lines(ROAD_EAST_M, half_width_m)
    roads_north = _road_lines(ROAD_NORTH_M, half_width_m)
    plots: list[Plot] = []
    tracks: list[Box] = []
    for west, east in pairwise(roads_east):
        for south, north in pairwise(roads_north):
            _divide(random, (west + 9, south + 9, east - 9, north - 9), plots, tracks)
    creek = _creek(random, half_width_m)
    grown = (*_creek_trees(random, creek), *_hedges(random, plots), *_groves(random))
    # A random generator of their own: changing farms or ponds must not change the fields.
    farms = np.random.default_rng((seed, 1))
    yards, buildings = _farms(farms, roads_east, roads_north)
    trees = _beside(yards, grown)
    return Farmland(
        _in_season(seed, plots),
        tuple(tracks),
        trees,
        creek,
        roads_east,
        roads_north,
        half_width_m,
        yards,
        buildings,
        _ponds(farms, half_width_m),
    )


def _farms(
    random: np.random.Generator, roads_east: tuple[float, ...], roads_north: tuple[float, ...]
) -> tuple[tuple[Box, ...], tuple[Building, ...]]:
    """Return gravel yards and buildings of farms: one by the origin, others at crossings."""
    corners = [FIRST_FARM_M] + [
        (east + 16.0, north + 16.0)
        for east in roads_east
        for north in roads_north
        if random.random() < FARMS_PER_CROSSING
    ]
    yards = tuple((e - 3.0, n - 3.0, e + YARD_M, n + YARD_M) for e, n in corners)
    return yards, tuple(b for east, north in corners for b in _farm(random, east, north))


def _farm(random: np.random.Generator, east_m: float, north_m: float) -> list[Building]:
    """Return a barn, a shed and a house around a yard with this south-west corner."""
    roofs = [ROOFS[int(k)] for k in random.integers(0, len(ROOFS), 3)]
    barn = (east_m + 2.0, north_m + 2.0, east_m + 18.0, north_m + 40.0, 9.0)
    shed = (east_m + 26.0, north_m + 34.0, east_m + 46.0, north_m + 46.0, 6.0)
    house = (east_m + 32.0, north_m + 4.0, east_m + 45.0, north_m + 15.0, 7.0)
    return [Building(*box, roof) for box, roof in zip((barn, shed, house), roofs, strict=True)]


def _ponds(random: np.random.Generator, half_width_m: float) -> tuple[Pond, ...]:
    places = random.uniform(-half_width_m, half_width_m, (PONDS, 2))
    sizes = random.uniform((16.0, 10.0, 0.0), (45.0, 24.0, 180.0), (PONDS, 3))
    return tuple(
        Pond(*map(float, (*place, *size)))
        for place, size in zip(places, sizes, strict=True)
        if float(np.hypot(*place)) > NO_POND_WITHIN_M
    )


def _road_lines(through_m: float, half_width_m: float) -> tuple[float, ...]:
    count = int(half_width_m // SECTION_M) + 1
    return tuple(through_m + SECTION_M * k for k in range(-count, count + 1))


def _divide(
    random: np.random.Generator,
    box: Box,
    plots: list[Plot],
    tracks: list[Box],
) -> None:
    """Split a rectangle until it has a plot's size; some of the splits become dirt tracks."""
    west, south, east, north = box
    width, height = east - west, north - south
    # Cut across the longer side, so that plots stay compact.
    is_wide = width >= height
    longest = max(width, height)
    small_enough = longest < LARGEST_PLOT_M or (longest < 340.0 and random.random() < 0.25)
    if small_enough or longest < 2.0 * SMALLEST_PLOT_M:
        plots.append(_plot(random, box))
        return
    share = random.uniform(0.36, 0.64)
    gap = 2.6 if random.random() < 0.3 else 1.0
    cut = (west + share * width) if is_wide else (south + share * height)
    if gap > 2.0:
        track = (cut - 2.0, south, cut + 2.0, north) if is_wide else (west, cut - 2, east, cut + 2)
        tracks.append(track)
    if is_wide:
        _divide(random, (west, south, cut - gap, north), plots, tracks)
        _divide(random, (cut + gap, south, east, north), plots, tracks)
    else:
        _divide(random, (west, south, east, cut - gap), plots, tracks)
        _divide(random, (west, cut + gap, east, north), plots, tracks)


def _plot(random: np.random.Generator, box: Box) -> Plot:
    west, south, east, north = box
    pick, colour, name = random.random(), MEADOW, "meadow"
    for crop, crop_colour, share in CROPS:
        if pick < share:
            colour, name = crop_colour, crop
            break
        pick -= share
    tint = random.normal(0.0, 4.0) + random.normal(0.0, 1.5, 3)
    runs_north = bool((north - south > east - west) ^ (random.random() < 0.15))
    has_rows = name not in ("pasture", "meadow")
    return Plot(
        west,
        south,
        east,
        north,
        (colour[0] + tint[0], colour[1] + tint[1], colour[2] + tint[2]),
        row_spacing_m=float(random.choice([3.0, 4.5, 6.0])),
        row_contrast=float(random.uniform(3.0, 7.0)) if has_rows else 0.0,
        rows_run_north=runs_north,
        patchiness=float(random.uniform(3.0, 9.0)),
        bareness=BARENESS.get(name, 0.1),
        crop=name,
    )


def _in_season(seed: int, plots: list[Plot]) -> tuple[Plot, ...]:
    """Return the plots with the colours that their crops have in a seed's year."""
    random = np.random.default_rng((seed, PALETTE_STREAM))
    deviations = (CROP_HUE, 0.0, CROP_HUE)
    shares = {
        crop: np.exp(random.normal(0.0, CROP_BRIGHTNESS) + random.normal(0.0, deviations))
        for crop in (*(name for name, _, _ in CROPS), "meadow")
    }
    return tuple(_tinted(plot, shares[plot.crop]) for plot in plots)


def _tinted(plot: Plot, shares: FloatArray) -> Plot:
    red, green, blue = (shares * plot.colour).tolist()
    return replace(plot, colour=(red, green, blue))


def _creek(random: np.random.Generator, half_width_m: float) -> FloatArray:
    along = np.arange(-half_width_m, half_width_m, 12.0)
    bends = sum(
        amplitude * np.sin(along * 2.0 * np.pi / length + random.uniform(0.0, 6.28))
        for amplitude, length in ((170.0, 2900.0), (55.0, 760.0), (16.0, 210.0))
    )
    return _around_the_first_farm(np.stack([along, 0.35 * along + 190.0 + bends], axis=1))


def _around_the_first_farm(creek_m: FloatArray) -> FloatArray:
    """Return the creek, bent away from the farm near the origin if it would cross it."""
    east_m, north_m = (corner + YARD_M / 2.0 for corner in FIRST_FARM_M)
    passes_m = float(np.interp(east_m, creek_m[:, 0], creek_m[:, 1])) - north_m
    if abs(passes_m) >= CREEK_FROM_FARM_M:
        return creek_m
    away_m = (CREEK_FROM_FARM_M if passes_m >= 0.0 else -CREEK_FROM_FARM_M) - passes_m
    bend = away_m * np.exp(-(((creek_m[:, 0] - east_m) / CREEK_BEND_M) ** 2))
    return creek_m + np.stack([np.zeros_like(bend), bend], axis=1)


def _beside(yards: tuple[Box, ...], trees: tuple[Tree, ...]) -> tuple[Tree, ...]:
    """Return the trees outside all yards."""
    places = np.array([(tree.east_m, tree.north_m, tree.radius_m) for tree in trees])
    stands = np.ones(len(trees), dtype=bool)
    for west, south, east, north in yards:
        aside = np.maximum(west - places[:, 0], places[:, 0] - east)
        ahead = np.maximum(south - places[:, 1], places[:, 1] - north)
        stands &= np.maximum(aside, ahead) > places[:, 2]
    return tuple(trees[number] for number in np.flatnonzero(stands).tolist())


def _creek_trees(random: np.random.Generator, creek_m: FloatArray) -> list[Tree]:
    return [
        _tree(random, east + random.normal(0.0, 9.0), north + random.normal(0.0, 9.0))
        for east, north in creek_m
        for _ in range(int(random.integers(0, 4)))
    ]


def _hedges(random: np.random.Generator, plots: list[Plot]) -> list[Tree]:
    trees = []
    for plot in plots:
        if random.random() < 0.14:
            count = int((plot.north_m - plot.south_m) / 8.0)
            for north in np.linspace(plot.south_m, plot.north_m, max(2, count)):
                if random.random() < 0.75:
                    trees.append(_tree(random, plot.west_m + random.normal(0.0, 1.2), north))
        elif random.random() < 0.25:
            east = random.uniform(plot.west_m + 20.0, plot.east_m - 20.0)
            north = random.uniform(plot.south_m + 20.0, plot.north_m - 20.0)
            trees.append(_tree(random, east, north))
    return trees


def _groves(random: np.random.Generator) -> list[Tree]:
    trees = []
    for _ in range(60):
        centre = random.uniform(-5_000.0, 5_000.0, 2)
        for _ in range(int(random.integers(15, 60))):
            east, north = centre + random.normal(0.0, 24.0, 2)
            trees.append(_tree(random, east, north))
    return trees


def _tree(random: np.random.Generator, east_m: float, north_m: float) -> Tree:
    return Tree(
        float(east_m), float(north_m), float(random.uniform(2.6, 5.5)), float(random.normal(0, 7.0))
    )
