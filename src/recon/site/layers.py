"""A site's GeoJSON layers: their features and what they are read as."""

from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any, Literal

import msgspec
from msgspec import Struct

from recon.model.airspace import HeightDatum, LandingPad, Region, Zone, ZoneKind
from recon.model.errors import SiteError
from recon.model.geo import GeoPoint, LocalFrame
from recon.site.geojson import Feature, point_of, read_features, regions_of
from recon.site.reading import convert, file_inside
from recon.site.schema import Altitude, LayersTable, Serial, Text
from recon.site.site import Layers

MOST_PADS = 64
UNUSED_PROPERTIES = frozenset({"fid", "id", "notes"})
"""Attributes of QGIS and users' notes; no other is ignored."""


class _Named(Struct, frozen=True, forbid_unknown_fields=True):
    name: Text | None = None


class _ZoneProperties(_Named, frozen=True):
    floor_m: Altitude | None = None
    ceiling_m: Altitude | None = None
    datum: Literal["ground", "wgs84"] | None = None


class _PadProperties(_Named, frozen=True, kw_only=True):
    serial: Serial | None = None
    altitude_m: Altitude


def read_layers(site_file: Path, table: LayersTable, frame: LocalFrame) -> Layers:
    """Return the layers that site.toml names, each feature checked. Raises `SiteError`."""
    files = {key: name for key, name in msgspec.structs.asdict(table).items() if name is not None}
    paths = {key: file_inside(site_file, name, f"layers.{key}") for key, name in files.items()}
    zones: list[Zone] = []
    for key, kind in (("keep_out", ZoneKind.KEEP_OUT), ("height_zones", ZoneKind.HEIGHT)):
        if key in paths:
            zones += _zones(paths[key], kind, frame)
    return Layers(
        files=files,
        boundary=_if_named(paths, "boundary", lambda path: _boundary(path, frame), None),
        zones=tuple(zones),
        landing_pads=_if_named(paths, "landing_pads", lambda path: _pads(path, frame), ()),
        survey_regions=_if_named(paths, "survey_regions", lambda path: _survey(path, frame), {}),
    )


def _if_named(
    paths: Mapping[str, Path], key: str, read: Callable[[Path], Any], otherwise: object
) -> Any:
    return read(paths[key]) if key in paths else otherwise


def _boundary(path: Path, frame: LocalFrame) -> Region:
    regions: list[Region] = []
    for feature in read_features(path):
        _properties(feature, _Named)
        regions += regions_of(feature, frame)
    if len(regions) != 1:
        raise SiteError(f"{path}: expected one polygon, the site's boundary, got {len(regions)}")
    return regions[0]


def _zones(path: Path, kind: ZoneKind, frame: LocalFrame) -> list[Zone]:
    zones: list[Zone] = []
    for feature in read_features(path):
        table = _properties(feature, _ZoneProperties)
        _refuse_unclear_heights(feature.place, kind, table)
        name = table.name or f"{kind.value} {feature.number}"
        datum = None if table.datum is None else HeightDatum(table.datum)
        zones += [
            Zone(name, kind, region, table.floor_m, table.ceiling_m, datum)
            for region in regions_of(feature, frame)
        ]
    return zones


def _refuse_unclear_heights(place: str, kind: ZoneKind, table: _ZoneProperties) -> None:
    floor_m, ceiling_m = table.floor_m, table.ceiling_m
    has_heights = floor_m is not None or ceiling_m is not None
    if kind is ZoneKind.HEIGHT and not has_heights:
        raise SiteError(f"{place}: expected floor_m, ceiling_m or both, got neither")
    if has_heights != (table.datum is not None):
        got = "heights and no datum" if has_heights else "a datum and no heights"
        raise SiteError(
            f"{place}: expected floor_m or ceiling_m with the datum they count from, 'ground' or "
            f"'wgs84', got {got}"
        )
    if floor_m is not None and ceiling_m is not None and floor_m >= ceiling_m:
        raise SiteError(
            f"{place}: expected floor_m under ceiling_m, got {floor_m:g} m and {ceiling_m:g} m"
        )


def _pads(path: Path, frame: LocalFrame) -> tuple[LandingPad, ...]:
    features = read_features(path)
    if len(features) > MOST_PADS:
        raise SiteError(f"{path}: expected at most {MOST_PADS} landing pads, got {len(features)}")
    pads: dict[str, LandingPad] = {}
    for feature in features:
        pad = _pad(feature, frame)
        if pad.name in pads:
            raise SiteError(f"{feature.place}: expected each pad once, got {pad.name!a} again")
        pads[pad.name] = pad
    return tuple(pads.values())


def _pad(feature: Feature, frame: LocalFrame) -> LandingPad:
    table = _properties(feature, _PadProperties)
    name = table.name or table.serial
    if name is None:
        raise SiteError(
            f"{feature.place}: expected the serial of the pad's vehicle, a name, or both, got "
            "neither"
        )
    point = point_of(feature, frame)
    place = GeoPoint(point.latitude_deg, point.longitude_deg, table.altitude_m)
    return LandingPad(name, table.serial, place)


def _survey(path: Path, frame: LocalFrame) -> dict[str, Region]:
    survey: dict[str, Region] = {}
    for feature in read_features(path):
        name = _properties(feature, _Named).name or f"region {feature.number}"
        regions = regions_of(feature, frame)
        for part, region in enumerate(regions, start=1):
            part_name = name if len(regions) == 1 else f"{name}, part {part}"
            if part_name in survey:
                raise SiteError(
                    f"{feature.place}: expected each name once, got {part_name!a} again"
                )
            survey[part_name] = region
    return survey


def _properties(feature: Feature, kind: type[Any]) -> Any:
    ours = {key: value for key, value in feature.properties.items() if key not in UNUSED_PROPERTIES}
    return convert(feature.place, ours, kind, "properties")
