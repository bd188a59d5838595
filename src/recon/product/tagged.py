"""What `recon tag` has written, read back: a photo's time, state and footprint.

The table may have been edited, or be another program's: each value is checked.
"""

import csv
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from datetime import datetime
from pathlib import Path

import numpy as np
import shapely  # type: ignore[import-untyped, unused-ignore]

from recon.geo import enu_from_geo
from recon.model.errors import RecordError
from recon.model.units import unix_ns
from recon.product.flight import FlightData

TABLE = "tags.csv"
NEEDED = ("name", "utc", "state", "footprint_wkt")
MOST_CORNERS = 16


@dataclass(frozen=True, slots=True, eq=False)
class TaggedPhoto:
    """A photo of the table; its footprint in east-north metres."""

    name: str
    at_ns: int
    """Station time."""
    state: str
    footprint: shapely.Polygon
    sun_by_maps_and_sensor: tuple[float, float] | None = None
    """Direct sun by the shade maps, NaN where unknown, and by its own sensor, if that states it."""


def tagged_photos(folder: Path, flight: FlightData) -> list[TaggedPhoto]:
    """Return the photos of a folder that `recon tag` has written, without those that it refused,
    and one of each shot.

    Raises `RecordError` for another file, or for photos that are not of the flight.
    """
    path = folder / TABLE
    try:
        with path.open(encoding="utf-8", newline="") as file:
            found = list(_photos(path, csv.DictReader(file), flight))
    except OSError as problem:
        raise RecordError(f"{path}: {problem.strerror}: run recon tag first") from problem
    except (csv.Error, UnicodeDecodeError) as problem:
        raise RecordError(f"{path}: expected the table of recon tag, got: {problem}") from problem
    begin_ns, end_ns = flight.span_ns
    if not any(begin_ns <= each.at_ns <= end_ns for each in found):
        raise RecordError(f"{path}: expected photos of {flight.path.name}, got none of its time")
    return found


def _photos(path: Path, rows: "csv.DictReader[str]", flight: FlightData) -> Iterator[TaggedPhoto]:
    missing = set(NEEDED) - set(rows.fieldnames or ())
    if missing:
        raise RecordError(f"{path}: expected the table of recon tag, got one without {missing}")
    for row in rows:
        is_beside = row.get("shot", row["name"]) != row["name"]
        if is_beside or not row["utc"]:
            continue
        try:
            yield _photo(row, flight)
        except (ValueError, TypeError, shapely.errors.ShapelyError) as problem:
            raise RecordError(f"{path}: line {rows.line_num} is damaged: {problem}") from problem


def _photo(row: Mapping[str, str], flight: FlightData) -> TaggedPhoto:
    moment = datetime.fromisoformat(row["utc"])
    if moment.tzinfo is None:
        raise ValueError(f"expected a time in UTC, got {row['utc']!a:.40}")
    at_ns = unix_ns(moment.timestamp()) - flight.utc_ahead_ns
    shape = shapely.from_wkt(row["footprint_wkt"])
    if shape.geom_type != "Polygon" or not 4 <= len(shape.exterior.coords) <= MOST_CORNERS:
        raise ValueError("expected a footprint of a few corners")
    longitude_deg, latitude_deg = np.asarray(shape.exterior.coords)[:, :2].T
    ground_m = np.full(len(latitude_deg), flight.frame.origin.ellipsoid_height_m)
    enu_m = enu_from_geo(flight.frame, latitude_deg, longitude_deg, ground_m)
    if not np.isfinite(enu_m).all():
        raise ValueError("expected a footprint on earth")
    footprint = shapely.Polygon(enu_m[:, :2]).buffer(0.0)
    sensor, there = row.get("sun_by_sensor") or "", row.get("sun_by_maps_there") or "nan"
    both = (float(there), float(sensor)) if sensor else None
    return TaggedPhoto(row["name"], at_ns, row["state"], footprint, both)
