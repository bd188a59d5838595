"""A flight in the formats of other programs: surveys as KML, the sun by cell, figures as JSON."""

import json
from collections.abc import Callable, Mapping
from typing import Any

import numpy as np

from recon.model.units import NS_PER_S
from recon.product.charts import coverage_png
from recon.product.flight import FlightData, FlownSurvey, RecordedTrack
from recon.product.flight_log import FlightLog, read_log
from recon.product.report import Covered, FlightReport, flight_report
from recon.product.shadow_record import sun_by_cell, sun_cog
from recon.product.tag import sun_history
from recon.record.mcap.tracks import xml_text

TRACK_EVERY_NS = NS_PER_S


def kml(flight: FlightData) -> bytes:
    """Return the surveys' regions and the vehicles' tracks, on the ground.

    Heights are excluded: no app states their datum.
    """
    surveys = "".join(_survey_placemark(flight, each) for each in flight.surveys)
    tracks = "".join(
        _track_placemark(flight, flight.names.get(serial, serial), track)
        for serial, track in flight.tracks.items()
    )
    return (
        '<?xml version="1.0" encoding="UTF-8"?>\n'
        '<kml xmlns="http://www.opengis.net/kml/2.2"><Document>'
        f"<name>{xml_text(flight.path.stem)}</name>"
        f"<Folder><name>Surveys</name>{surveys}</Folder>"
        f"<Folder><name>Tracks</name>{tracks}</Folder>"
        "</Document></kml>\n"
    ).encode()


def _survey_placemark(flight: FlightData, survey: FlownSurvey) -> str:
    about = f"{survey.request().height_text}, {survey.speed_mps:g} m/s"
    outer, *holes = (
        _coordinates(flight, np.array([*ring, ring[0]]))
        for ring in (survey.outline_m, *survey.holes_m)
    )
    inner = "".join(
        f"<innerBoundaryIs><LinearRing>{hole}</LinearRing></innerBoundaryIs>" for hole in holes
    )
    return (
        f"<Placemark><name>{xml_text(survey.name or 'survey')}</name>"
        f"<description>{about}</description>"
        f"<Polygon><outerBoundaryIs><LinearRing>{outer}</LinearRing></outerBoundaryIs>{inner}"
        "</Polygon></Placemark>"
    )


def _track_placemark(flight: FlightData, name: str, track: RecordedTrack) -> str:
    seconds, first = np.unique(track.at_ns // TRACK_EVERY_NS, return_index=True)
    if len(seconds) < 2:
        return ""
    points = np.column_stack([track.east_m, track.north_m])[first]
    return (
        f"<Placemark><name>{xml_text(name)}</name><LineString><tessellate>1</tessellate>"
        f"{_coordinates(flight, points)}</LineString></Placemark>"
    )


def _coordinates(flight: FlightData, points: Any) -> str:
    places = " ".join(f"{x:.8f},{y:.8f}" for x, y in flight.lon_lat(points))
    return f"<coordinates>{places}</coordinates>"


def sun_tiff(flight: FlightData) -> bytes:
    """Return the sun by cell as GeoTIFF; raises `RecordError` without shade maps."""
    return sun_cog(flight, sun_by_cell(sun_history(flight)), None)


def coverage_picture(flight: FlightData) -> bytes:
    """Return the report's map of coverage as PNG; raises `RecordError` without shade maps."""
    sun_history(flight)
    covered = flight_report(flight, FlightLog(), None).covered
    assert covered is not None
    return coverage_png(covered)


def figures_json(flight: FlightData) -> bytes:
    """Return the report's figures; raises `RecordError` and OSError."""
    report = flight_report(flight, read_log(flight.path, flight), None)
    return json.dumps(figures(report), indent=2).encode() + b"\n"


def figures(report: FlightReport) -> dict[str, Any]:
    """Return the figures of a report; shares are 0 to 1, None where nothing is known."""
    flight = report.flight
    return {
        "record": flight.path.name,
        "site": str(report.log.about.get("site") or ""),
        "begin_utc": flight.utc(report.begin_ns),
        "end_utc": flight.utc(report.end_ns),
        "vehicles": [report.name_of(serial) for serial in flight.tracks],
        "surveys": [each.name for each in flight.surveys],
        "airborne_s": round(report.airborne_s, 1),
        **_coverage(report.covered),
        "mean_sun_share": report.mean_sun,
        "shade_maps": len(flight.maps),
        "shade_maps_of_the_region": len(report.cover),
        "alarms": len(report.alarms),
        "trouble": flight.trouble,
    }


def _coverage(covered: Covered | None) -> dict[str, float | None]:
    if covered is None or not covered.region.any():
        return dict.fromkeys(
            ("region_m2", "photographed_share", "sunlit_share", "well_sunlit_share")
        )
    return {
        "region_m2": round(covered.area_m2, 1),
        "photographed_share": covered.share(0),
        "sunlit_share": covered.share(1),
        "well_sunlit_share": covered.enough,
    }


FLIGHT_FORMATS: Mapping[str, Callable[[FlightData], bytes]] = {
    ".kml": kml,
    ".tif": sun_tiff,
    ".png": coverage_picture,
    ".json": figures_json,
}
"""Formats by the extension of the file to write."""
