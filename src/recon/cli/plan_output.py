"""A survey plan's figures as a table and JSON, and its rows and flights as GeoJSON."""

import json
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from typing import Any

import shapely  # type: ignore[import-untyped, unused-ignore]

from recon.geo import geojson_geometry, shape_of
from recon.guidance.survey import Surveyor, SurveyPlan
from recon.guidance.survey.estimate import PlannedFlight, SurveyEstimate, plan_figures
from recon.guidance.survey.imaging import SpeedLimit, exposure_text
from recon.guidance.survey.lattice import EastNorth
from recon.guidance.survey.missions import NADIR_DEG
from recon.model.survey import SurveyCamera, height_text
from recon.model.survey_camera import CameraModel
from recon.model.units import HECTARE_M2


@dataclass(frozen=True, slots=True)
class ImagingFigures:
    """The camera, what limits its speed (the lowest first), and the exposure that was assumed."""

    model: CameraModel
    lens: SurveyCamera
    """The camera at the timer's interval."""
    limits: tuple[SpeedLimit, ...]
    exposure_s: float


def figures_of(
    plan: SurveyPlan,
    fleet: Sequence[Surveyor],
    needs: SurveyEstimate,
    imaging: ImagingFigures,
    endurance_s: float,
    cost_per_hour: float | None,
) -> dict[str, Any]:
    """Return everything that a plan states, in SI units; `warnings` are sentences."""
    survey, lens = plan.survey, plan.survey.camera
    height_m = survey.height_m
    return {
        **asdict(plan_figures(plan, fleet, needs, imaging.limits[0], imaging.exposure_s)),
        "title": survey.name,
        "camera": imaging.model.title,
        "camera_source": imaging.model.source,
        "shutter": imaging.model.shutter,
        "height_above_takeoff_m": survey.height_above_takeoff_m,
        "height_above_ground_m": survey.height_above_ground_m,
        "footprint_m": [lens.across_m(height_m), lens.along_m(height_m)],
        "front_overlap": 1.0 - plan.swath.photo_m / lens.along_m(height_m),
        "side_overlap": 1.0 - plan.lattice.spacing_m / lens.across_m(height_m),
        "gimbal_pitch_deg": NADIR_DEG,
        "speed_mps": survey.speed_mps,
        "speed_limits": [[each.speed_mps, each.reason] for each in imaging.limits],
        "interval_s": lens.interval_s,
        "exposure_s": imaging.exposure_s,
        "row_parts": len(plan.pieces),
        "row_spacing_m": plan.lattice.spacing_m,
        "row_bearing_deg": plan.lattice.bearing_deg,
        "lead_in_m": plan.swath.lead_m,
        "rows_m": sum(flight.rows_m for d in needs.drones for flight in d.flights),
        "endurance_s": endurance_s,
        "cost": None if cost_per_hour is None else cost_per_hour * needs.flown_s / 3600.0,
        "drones": [
            {
                "vehicle_name": drone.serial,
                "time_s": drone.time_s,
                "flights": len(drone.flights),
                "flights_s": [flight.time_s for flight in drone.flights],
            }
            for drone in needs.drones
        ],
        "drones_without_rows": len(fleet) - len(needs.drones),
    }


def rows_of(
    figures: dict[str, Any], flown: Sequence[tuple[str, str]] = ()
) -> list[tuple[str, str]]:
    """Return a plan's figures, or those of a station's estimate, as rows of a table.

    `flown`: more rows, of how it is flown.
    """
    gsd = "unknown" if figures["gsd_m"] is None else f"{100.0 * figures['gsd_m']:.2f} cm"
    batteries = "unknown: no endurance"
    if figures["batteries"] is not None:
        batteries = f"{figures['batteries']}, full"
    if "endurance_s" in figures:
        batteries += f", of {figures['endurance_s'] / 60.0:g} min hovering each"
    return [
        ("area", f"{figures['region_m2'] / HECTARE_M2:.2f} ha"),
        ("pixel on the ground", gsd),
        ("speed limit", f"{figures['speed_limit_mps']:.2f} m/s: {figures['speed_limited_by']}"),
        ("rows", f"{figures['rows']}"),
        *flown,
        *_above_ground(figures),
        (
            "photos",
            f"{figures['photos']} on rows, {figures['photos_in_all']} in total by the timer",
        ),
        ("time", minutes(figures["time_s"])),
        ("in the air", f"{minutes(figures['flown_s'])}, all drones together"),
        ("batteries", batteries),
        *(() if figures.get("cost") is None else [("cost", f"{figures['cost']:.2f}")]),
        *(
            (
                drone["vehicle_name"],
                f"{minutes(drone['time_s'])} in {counted(drone['flights'], 'flight')}",
            )
            for drone in figures["drones"]
        ),
        *_without_rows(figures.get("drones_without_rows", 0)),
        *(("warning", text) for text in figures["warnings"]),
    ]


def _without_rows(drones: int) -> list[tuple[str, str]]:
    return [("not needed", f"{counted(drones, 'drone')}: no rows are left")] if drones else []


def _above_ground(figures: dict[str, Any]) -> list[tuple[str, str]]:
    """How high rows are above the ground over the region, where that is known."""
    least_m, most_m = (figures[f"{which}_height_above_ground_m"] for which in ("least", "most"))
    if least_m is None or most_m is None:
        return []
    least, most = f"{least_m:.0f}", f"{most_m:.0f}"
    range_m = least if least == most else f"{least} to {most}"
    return [("height above ground", f"{range_m} m over the region")]


def plan_rows_of(figures: dict[str, Any]) -> list[tuple[str, str]]:
    """Return everything that a plan states as rows of a table."""
    across_m, along_m = figures["footprint_m"]
    flown = [
        (
            "row spacing",
            f"{figures['row_spacing_m']:.1f} m, bearing {figures['row_bearing_deg']:.0f} deg, "
            f"lead-in {figures['lead_in_m']:.0f} m",
        ),
        ("length of rows", f"{figures['rows_m'] / 1000.0:.2f} km"),
        ("camera", f"{figures['camera']}, {figures['shutter']} shutter"),
        (
            "height",
            height_text(figures["height_above_takeoff_m"], figures["height_above_ground_m"]),
        ),
        ("speed", f"{figures['speed_mps']:.1f} m/s"),
        ("photo", f"{across_m:.1f} x {along_m:.1f} m, straight down"),
        ("photo every", f"{figures['interval_s']:g} s (set the camera's timer)"),
        ("overlap", f"front {figures['front_overlap']:.0%}, side {figures['side_overlap']:.0%}"),
        ("blur", f"{figures['blur_px']:.2f} pixel at {exposure_text(figures['exposure_s'])}"),
    ]
    return rows_of(figures, flown)


def counted(number: int, noun: str) -> str:
    """Return "1 flight", "2 flights"."""
    return f"{number} {noun}{'s'[: number != 1]}"


def minutes(seconds: float | None) -> str:
    """Return a duration in whole minutes, rounded up."""
    return "unknown" if seconds is None else f"{-int(-seconds // 60)} min"


def geojson_of(plan: SurveyPlan, needs: SurveyEstimate) -> bytes:
    """Return a FeatureCollection: the region, what the photos cover, each row in its order."""
    survey = plan.survey
    features = [
        _feature(plan, shape_of(survey.region), {"kind": "region", "name": survey.name}),
        _feature(plan, footprints_m(plan), {"kind": "photos"}),
    ]
    for drone in needs.drones:
        for number, flight in enumerate(drone.flights, start=1):
            known = {"drone": drone.serial, "flight": number}
            for track in flight.tracks_m:
                track_line = shapely.LineString(track)
                features.append(_feature(plan, track_line, {"kind": "flight", **known}))
            for order, ends in enumerate(row_ends_m(plan, flight), start=1):
                line = shapely.LineString(ends)
                features.append(_feature(plan, line, {"kind": "row", **known, "order": order}))
    collection = {"type": "FeatureCollection", "features": features}
    return json.dumps(collection, indent=1).encode()


def row_ends_m(plan: SurveyPlan, flight: PlannedFlight) -> list[tuple[EastNorth, ...]]:
    """Return where each row of a flight begins and ends, lead-in and all, east-north metres."""
    legs = [leg.ends_m(plan.lattice, plan.swath.lead_m) for leg in flight.route]
    return [tuple(map(tuple, plan.lattice.east_north_m(ends).tolist())) for ends in legs]


def footprints_m(plan: SurveyPlan) -> shapely.Geometry:
    """Return the ground that is on photos of the rows, at the least."""
    lattice, lens = plan.lattice, plan.survey.camera
    height_m = plan.survey.height_m
    half_across_m, half_along_m = lens.across_m(height_m) / 2.0, lens.along_m(height_m) / 2.0
    # The first and the last photo may lie a whole photo distance inside a row's ends.
    beyond_m = plan.swath.lead_m - plan.swath.photo_m + half_along_m
    boxes = [
        shapely.box(
            piece.start_m - beyond_m,
            lattice.row_across_m(piece.row) - half_across_m,
            piece.end_m + beyond_m,
            lattice.row_across_m(piece.row) + half_across_m,
        )
        for piece in plan.pieces
    ]
    return shapely.transform(shapely.union_all(boxes), lattice.east_north_m)


def _feature(plan: SurveyPlan, shape_m: shapely.Geometry, known: dict[str, Any]) -> dict[str, Any]:
    geometry = geojson_geometry(plan.frame, shape_m)
    return {"type": "Feature", "properties": known, "geometry": geometry}


def flights_in_order(needs: SurveyEstimate) -> Sequence[tuple[int, PlannedFlight]]:
    """Return all flights, each with the number of its drone from 0."""
    return [(i, flight) for i, drone in enumerate(needs.drones) for flight in drone.flights]
