"""Elevation tiles of one degree: which of them a site needs, and what they are called."""

import re
from dataclasses import dataclass
from math import floor

from recon.model.errors import SiteError
from recon.model.foreign_text import one_line

MOST_TILES = 16
"""A site is 100 km wide at most: 2 x 2 tiles, and more columns only near the poles."""
OVERLAP_DEG = 0.001
"""Pixels of GLO-30 lie half a pixel beyond their degree, at one edge or the other."""
_PLACE = re.compile(r"\{([^{}]*)\}")
_FIELD = re.compile(r"(?P<name>NS|ns|EW|ew|lat|north|lon)(?::0(?P<digits>[1-4]))?")
LATITUDES, LONGITUDES = {"lat", "north"}, {"lon"}


@dataclass(frozen=True, slots=True)
class DegreeTile:
    """The tile from a whole degree of latitude and longitude to the next ones."""

    south_deg: int
    west_deg: int

    def __str__(self) -> str:
        return tile_address("{NS}{lat:02}{EW}{lon:03}", self)


def tiles_over(bounds_deg: tuple[float, float, float, float]) -> tuple[DegreeTile, ...]:
    """Return the tiles over west, south, east and north, degrees. Raises `SiteError` for many."""
    west, south, east, north = bounds_deg
    souths = range(floor(south - OVERLAP_DEG), floor(north + OVERLAP_DEG) + 1)
    wests = range(floor(west - OVERLAP_DEG), floor(east + OVERLAP_DEG) + 1)
    count = len(souths) * len(wests)
    if count > MOST_TILES:
        raise SiteError(
            f"expected at most {MOST_TILES} tiles of a degree over the site, got {count}; set a "
            "smaller limits.max_distance_from_home_m"
        )
    return tuple(DegreeTile(s, w) for s in souths if -90 <= s < 90 for w in wests)


def has_places(template: str) -> bool:
    """Return whether an address names tiles by their degrees; False: it is one file.

    Raises `SiteError` for placeholders that are not known, or not enough to tell tiles apart.
    """
    fields = [_field(place) for place in _PLACE.findall(template)]
    names = {field["name"] for field in fields}
    is_whole = bool(names & LATITUDES) and bool(names & LONGITUDES)
    if fields and not is_whole:
        raise SiteError(
            "expected an address with {lat} or {north}, and {lon}, got "
            f"{one_line(template)!a}: it would be the same for different tiles"
        )
    return bool(fields)


def tile_address(template: str, tile: DegreeTile) -> str:
    """Return a template's address of a tile."""
    return _PLACE.sub(lambda found: _value(_field(found[1]), tile), template)


def _field(text: str) -> re.Match[str]:
    found = _FIELD.fullmatch(text)
    if found is None:
        raise SiteError(
            "expected the placeholders {NS}, {ns}, {EW}, {ew}, {lat}, {north} and {lon}, numbers "
            f"with digits like {{lat:02}}, got {{{one_line(text, 40)}}}"
        )
    return found


def _value(field: re.Match[str], tile: DegreeTile) -> str:
    letters = "NS"[tile.south_deg < 0], "EW"[tile.west_deg < 0]
    values: dict[str, str | int] = {
        "NS": letters[0],
        "ns": letters[0].lower(),
        "EW": letters[1],
        "ew": letters[1].lower(),
        "lat": abs(tile.south_deg),
        "north": abs(tile.south_deg + 1),
        "lon": abs(tile.west_deg),
    }
    value = values[field["name"]]
    return str(value).zfill(int(field["digits"] or 1))
