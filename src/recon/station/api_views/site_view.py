"""The site, as the API sends it: facts, limits, and outlines to draw, bounded in number.

The view is part of every state, so outlines of many corners are simplified; the view has the
largest error and the number of areas excluded. Rules use the site's own outlines.
"""

from collections.abc import Iterator
from dataclasses import asdict, dataclass, replace
from functools import lru_cache
from itertools import accumulate
from typing import Literal

import numpy as np

from recon.api import schema
from recon.geo import geo_from_enu, thinned_ring
from recon.guidance.survey import PLANNERS
from recon.model.airspace import LandingPad, Region, Zone
from recon.model.arrays import FloatArray
from recon.model.geo import LocalFrame
from recon.site import Site

AreaKind = Literal["boundary", "keep_out", "height", "survey"]

MAX_CORNERS = 500
"""20 kB of each state: about what the trails of five vehicles take."""
MAX_RINGS = 100
FIRST_THINNING_M = 0.25
COARSEST_THINNING_M = 1_000.0
DECIMALS = 7
"""Decimals of a degree: a centimetre."""


@dataclass(frozen=True, slots=True, eq=False)
class _Area:
    kind: AreaKind
    name: str
    rings_m: tuple[FloatArray, ...]
    zone: Zone | None = None

    @property
    def corner_count(self) -> int:
        return sum(len(ring) for ring in self.rings_m)

    def thinned(self, within_m: float) -> "_Area":
        return replace(self, rings_m=tuple(thinned_ring(r, within_m) for r in self.rings_m))


@lru_cache(maxsize=1)
def site_view(site: Site) -> schema.SiteView:
    """Return what a console shows of a site."""
    origin = None if site.frame is None else site.frame.origin
    solution = None if site.imager is None else site.imager.solution
    areas = list(_areas(site))
    drawn, within_m = _thinned(_few(areas))
    return schema.SiteView(
        name=site.name,
        latitude_deg=None if origin is None else origin.latitude_deg,
        longitude_deg=None if origin is None else origin.longitude_deg,
        ground_altitude_m=None if origin is None else origin.ellipsoid_height_m,
        imager_serials=list(site.imagers),
        pose_rms_px=None if solution is None else solution.rms_px,
        pose_height_m=None if solution is None else solution.height_above_ground_m,
        limits=schema.LimitsView(**asdict(site.limits)),
        terrain="flat assumed" if site.elevation is None else "model",
        layers=_layers(site),
        areas=[] if site.frame is None else [_area(a, site.frame) for a in drawn],
        areas_excluded=len(areas) - len(drawn),
        areas_drawn_within_m=within_m,
        outside_planners=list(PLANNERS.outside),
        pads=[_pad(pad) for pad in site.airspace.landing_pads],
    )


def _layers(site: Site) -> list[schema.LayerView]:
    files = dict(site.layers.files)
    if site.elevation_file is not None:
        files["elevation"] = site.elevation_file
    return [schema.LayerView(name=name, file=file) for name, file in files.items()]


def _areas(site: Site) -> Iterator[_Area]:
    """Yield the areas, restrictions before survey regions."""
    layers = site.layers
    if layers.boundary is not None:
        yield _Area("boundary", "boundary", _rings_m(layers.boundary))
    for zone in layers.zones:
        yield _Area(zone.kind.value, zone.name, _rings_m(zone.region), zone)
    for name, region in layers.survey_regions.items():
        yield _Area("survey", name, _rings_m(region))


def _rings_m(region: Region) -> tuple[FloatArray, ...]:
    return (region.outline_m, *region.holes_m)


def _few(areas: list[_Area]) -> list[_Area]:
    """Return the first areas, as many as have few enough rings together."""
    ring_counts = accumulate(len(area.rings_m) for area in areas)
    return [area for area, rings in zip(areas, ring_counts, strict=True) if rings <= MAX_RINGS]


def _thinned(areas: list[_Area]) -> tuple[list[_Area], float]:
    """Return areas with few enough corners together, and how far off their edges may be.

    The tolerance is doubled until it does. What cannot be thinned so far is excluded, last first.
    """
    thin, within_m = areas, 0.0
    while sum(area.corner_count for area in thin) > MAX_CORNERS:
        if within_m < COARSEST_THINNING_M:
            within_m = max(FIRST_THINNING_M, 2.0 * within_m)
        else:
            areas = areas[:-1]
        thin = [area.thinned(within_m) for area in areas]
    return thin, within_m


def _area(area: _Area, frame: LocalFrame) -> schema.AreaView:
    zone = area.zone
    return schema.AreaView(
        kind=area.kind,
        name=area.name,
        rings=[lon_lat_ring(ring, frame) for ring in area.rings_m],
        floor_m=None if zone is None else zone.floor_m,
        ceiling_m=None if zone is None else zone.ceiling_m,
        datum=None if zone is None or zone.datum is None else zone.datum.value,
    )


def lon_lat_ring(ring_m: FloatArray, frame: LocalFrame) -> list[tuple[float, float]]:
    """Return the ring closed: its first corner again at the end, as GeoJSON has it."""
    closed_m = np.vstack([ring_m, ring_m[:1]])
    latitude_deg, longitude_deg, _ = geo_from_enu(
        frame, np.column_stack([closed_m, np.zeros(len(closed_m))])
    )
    return [
        (round(float(lon), DECIMALS), round(float(lat), DECIMALS))
        for lon, lat in zip(longitude_deg, latitude_deg, strict=True)
    ]


def _pad(pad: LandingPad) -> schema.PadView:
    return schema.PadView(
        name=pad.name,
        serial=pad.serial,
        longitude_deg=pad.place.longitude_deg,
        latitude_deg=pad.place.latitude_deg,
        altitude_m=pad.place.ellipsoid_height_m,
    )
