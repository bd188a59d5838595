"""Where a site's elevation model is from: kept in the GeoTIFF itself, as a tag.

So it goes with the file, and is gone with it when another file takes its place.
"""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Annotated

import msgspec
from msgspec import Meta

from recon.model.foreign_text import one_line

TAG = "RECON_FETCHED"
LONGEST_TAG = 8_000


@dataclass(frozen=True, slots=True)
class KnownElevation:
    """A public elevation model: what its heights are, and the notice that its licence asks for."""

    marks: tuple[str, ...]
    """Any of these in an address or a file's name is this model."""
    title: str
    zero: str
    """What its heights count from; all of them are above sea level."""
    is_surface: bool
    """Whether trees and buildings are part of it."""
    notice: str


KNOWN = (
    KnownElevation(
        ("Copernicus_DSM_COG_10_", "Copernicus_DSM_10_"),
        "Copernicus GLO-30",
        "EGM2008",
        True,
        "© DLR e.V. 2010-2014 and © Airbus Defence and Space GmbH 2014-2018 provided under "
        "COPERNICUS by the European Union and ESA; all rights reserved",
    ),
    KnownElevation(
        ("Copernicus_DSM_COG_30_", "Copernicus_DSM_30_"),
        "Copernicus GLO-90",
        "EGM2008",
        True,
        "© DLR e.V. 2010-2014 and © Airbus Defence and Space GmbH 2014-2018 provided under "
        "COPERNICUS by the European Union and ESA; all rights reserved",
    ),
    KnownElevation(
        ("USGS_1_", "USGS_13_", "USGS_1M_", "USGS_one_meter_"),
        "USGS 3DEP",
        "NAVD88",
        False,
        "U.S. Geological Survey, 3D Elevation Program; public domain",
    ),
)


@dataclass(frozen=True, slots=True)
class TerrainSource:
    """What was fetched, when and where from."""

    title: Annotated[str, Meta(max_length=200)]
    fetched_utc_s: Annotated[int, Meta(ge=0, le=10**11)]
    zero: Annotated[str, Meta(max_length=40)]
    is_surface: bool | None = None
    """None: not known."""
    notice: Annotated[str, Meta(max_length=400)] = ""
    missing: Annotated[tuple[Annotated[str, Meta(max_length=40)], ...], Meta(max_length=100)] = ()
    """Tiles that the source does not have."""


def known_elevation(address: str) -> KnownElevation | None:
    """Return the public model that an address or a file's name is of."""
    return next((each for each in KNOWN if any(mark in address for mark in each.marks)), None)


def tag_of(source: TerrainSource) -> dict[str, str]:
    """Return the tag that a GeoTIFF keeps."""
    return {TAG: msgspec.json.encode(source).decode()}


def source_of(tags: Mapping[str, str]) -> TerrainSource | None:
    """Return what a GeoTIFF's tags tell; None without, and for a damaged one."""
    text = tags.get(TAG, "")
    if not text or len(text) > LONGEST_TAG:
        return None
    try:
        found = msgspec.json.decode(text, type=TerrainSource)
    except (msgspec.DecodeError, RecursionError):
        return None
    return replace(
        found,
        title=one_line(found.title, 400),
        zero=one_line(found.zero, 400),
        notice=one_line(found.notice, 400),
        missing=tuple(one_line(each, 40) for each in found.missing),
    )
