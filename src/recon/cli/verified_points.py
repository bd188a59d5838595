"""`recon verify` on light sensors: forecasts at their places, and maps against them."""

from collections.abc import Iterator
from pathlib import Path

import numpy as np

from recon.cli.opened_flight import opened_flight
from recon.cli.output import print_line
from recon.cli.progress import progress_over
from recon.forecast import FORECASTERS
from recon.geo import cells_of, enu_from_geo, geo_from_enu, read_at
from recon.light.agreement import SAYS, SHOWN
from recon.light.files import FEWEST_SENSORS, points_of, read_points
from recon.light.points import LightPoints
from recon.light.tables import long_table
from recon.model.arrays import FloatArray
from recon.model.errors import RecordError
from recon.model.units import unix_ns
from recon.product.flight import FlightData
from recon.product.sun_at import shade_map
from recon.record.raster.map_sequence import captured_utc, cells_at, map_files, read_map
from recon.score.forecast_figures import Calibration, LeadScore, SeenCells
from recon.score.forecast_tables import leads_table
from recon.score.map_verification import MapAtPlaces, MapScore, score_maps
from recon.score.point_verification import PointScores, verified_at_points
from recon.score.table_rows import finest, percent, plain, table

BASELINES = ("persistence", "climatology")
"""Forecasts are held against both in the same run."""


def verify_points(
    path: Path, places: Path | None, maps: Path | None
) -> tuple[str, dict[str, Calibration]]:
    """Print how right forecasts, and maps if given, are at sensors; return a title and the curves
    of reliability. Raises `RecordError`."""
    points = read_points(path, places, FEWEST_SENSORS if maps is None else 1)
    if maps is not None:
        return _verify_maps_at(points, _maps_at(points, maps))
    _print_points(points)
    scores = verified_at_points(points, FORECASTERS)
    for line in forecast_lines(scores).splitlines():
        print_line(line)
    lead_s = scores.leads_s[1]
    curves = {
        name: scores.sums.get((name, lead_s, SeenCells.ALL), LeadScore()).calibration
        for name in FORECASTERS
    }
    return f"{lead_s:g} s ahead", curves


def verify_flight(path: Path) -> tuple[str, dict[str, Calibration]]:
    """Print how right a flight's maps were at the sensors that it recorded; raises
    `RecordError`."""
    flight = opened_flight(path)
    if not flight.light:
        raise RecordError(
            f"{path}: expected a flight with light sensors (recon run --light-sensors), got none; "
            f"with a file of them: recon verify sensors.csv --maps {path}"
        )
    places = {
        each.sensor: (each.place.latitude_deg, each.place.longitude_deg)
        for each in flight.light
        if each.place is not None
    }
    names = [each.sensor for each in flight.light]
    times_ns = np.array([each.at_ns for each in flight.light], dtype=np.int64)
    light = np.array([each.value for each in flight.light])
    points = points_of(path, long_table(names, times_ns, light, places, True), fewest=1)
    return _verify_maps_at(points, _of_flight(points, flight))


def _verify_maps_at(
    points: LightPoints, maps: Iterator[MapAtPlaces]
) -> tuple[str, dict[str, Calibration]]:
    _print_points(points)
    found = score_maps(points, maps)
    for line in _hits(found).splitlines():
        print_line(line)
    return "maps at the sensors", {"maps": found.score.calibration}


def _print_points(points: LightPoints) -> None:
    print_line(
        f"{len(points.names)} sensors, {len(points.times_ns)} times, {points.step_s:g} s apart"
    )
    for note in points.notes:
        print_line(f"  {note}")


def forecast_lines(scores: PointScores) -> str:
    """Return the tables of forecasts at sensors; raises `RecordError` where no lead was reached."""
    found = leads_table(scores.sums, tuple(FORECASTERS))
    if found is None:
        raise RecordError(f"expected values over more than {scores.leads_s[0]:g} s")
    parts = ["", found, ""]
    for base in BASELINES:
        rows = [
            (name, *(_ratio(scores, name, base, lead_s) for lead_s in scores.leads_s))
            for name in FORECASTERS
            if name != base
        ]
        head = (f"Brier over that of {base}", *(f"{each:g} s" for each in scores.leads_s))
        parts += [table(head, rows), ""]
    claimed = [each for each in scores.velocities_mps["advection"] if each is not None]
    total = len(scores.velocities_mps["advection"])
    east, north = np.median(claimed, axis=0) if claimed else (0.0, 0.0)
    moves = f"{plain(east)} m/s east, {plain(north)} north (median)" if claimed else "none"
    parts.append(f"shade moves: {moves}; in {len(claimed)} of {total} forecasts a velocity")
    return "\n".join(parts)


def _ratio(scores: PointScores, name: str, base: str, lead_s: float) -> str:
    ours, other = (
        scores.sums.get((each, lead_s, SeenCells.ALL), LeadScore()).brier for each in (name, base)
    )
    return "-" if ours is None or not other else f"{ours / other:.2f}"


def _hits(found: MapScore) -> str:
    counted = found.agreement
    rows = [(said, *(str(counted.count(said, shown)) for shown in SHOWN)) for said in SAYS]
    brier, lit = found.score.brier, counted.sunlit_share
    if brier is None:
        raise RecordError(
            f"expected maps that show the sensors at times they have values, got {found.maps} "
            f"maps: {found.alone} at other times, the rest of other places"
        )
    return "\n".join(
        (
            "",
            table(("map says", "sensor in sun", "sensor in shade"), rows),
            "",
            f"{found.maps} maps, {found.alone} of them without values near their time",
            f"right in {percent(counted.right / counted.known)} % of what the maps know; "
            f"unknown {percent(counted.unknown_share)} %",
            f"Brier {finest(brier)}; {finest(lit * (1.0 - lit))} by the share in sun alone",
        )
    )


def _maps_at(points: LightPoints, maps: Path) -> Iterator[MapAtPlaces]:
    if maps.is_dir():
        return _of_folder(points, maps)
    return _of_flight(points, opened_flight(maps))


def _of_folder(points: LightPoints, folder: Path) -> Iterator[MapAtPlaces]:
    """Yield georeferenced maps; metres of places are those of the maps' own projection."""
    is_geographic = points.frame is not None
    places = np.column_stack([points.east_m, points.north_m])
    if is_geographic:
        places = _geographic(points)
    files = map_files(folder)
    for file in progress_over(files, "maps", len(files)):
        utc = captured_utc(file)
        if utc is None:
            raise RecordError(f"{file}: expected a map that states its time, as Recon's do")
        found = read_map(file, 1.0, 0.0)
        cells = cells_at(file, places, is_geographic=is_geographic)
        yield MapAtPlaces(unix_ns(utc.timestamp()), read_at(found.transmittance, cells))


def _of_flight(points: LightPoints, flight: FlightData) -> Iterator[MapAtPlaces]:
    """Yield the maps of a flight record; metres of places are from the site's origin."""
    if flight.grid is None:
        raise RecordError(f"{flight.path}: expected a flight with shade maps, got none")
    east_m, north_m = points.east_m, points.north_m
    if points.frame is not None:
        latitude, longitude = _geographic(points).T
        height_m = np.full(len(latitude), flight.frame.origin.ellipsoid_height_m)
        east_m, north_m = enu_from_geo(flight.frame, latitude, longitude, height_m).T[:2]
    cells = cells_of(flight.grid, east_m, north_m)
    for kept in progress_over(flight.maps, "maps", len(flight.maps)):
        shade = shade_map(kept, flight.grid)
        yield MapAtPlaces(kept.at_ns + flight.utc_ahead_ns, read_at(shade.transmittance, cells))


def _geographic(points: LightPoints) -> FloatArray:
    """Return latitude and longitude (N, 2) of sensors that were placed by them."""
    assert points.frame is not None
    level = np.column_stack([points.east_m, points.north_m, np.zeros(len(points.names))])
    latitude_deg, longitude_deg, _height = geo_from_enu(points.frame, level)
    return np.column_stack([latitude_deg, longitude_deg])
