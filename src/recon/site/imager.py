"""The imaging drone from its table in site.toml: files read, pose solved, both checked."""

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import msgspec
import numpy as np

from recon.camera import (
    CameraError,
    ControlPoint,
    ImageCircle,
    OmnidirectionalCamera,
    TelemetryReference,
    load_camera,
    load_control_points,
    mounted_pose,
    pose_from_points,
)
from recon.geo import enu_from_geo, enu_from_points
from recon.model.errors import SiteError
from recon.model.geo import LocalFrame
from recon.site.reading import file_inside
from recon.site.schema import ImagerTable
from recon.site.site import Imager

USUAL_POINTS = "GCPs.txt"
LARGEST_ALTITUDE_GAP_M = 15.0
"""Largest gap between control points and the site's ground: more is a missing geoid height."""
LARGEST_DISTANCE_M = 5_000.0
"""Farthest control point from the origin: more is another field, or swapped coordinates."""
LARGEST_MARKED_GAP_M = 100.0
"""Largest gap between the marked frame's telemetry and its solved pose: both err by metres."""


def imager_from_table(site_file: Path, table: ImagerTable, frame: LocalFrame) -> Imager:
    """Return the imaging drone with its files read and its pose solved.

    Files lie in the site file's folder. Raises `SiteError` naming file, line or key.
    """
    camera_file = file_inside(site_file, table.camera, "imager.camera")
    try:
        camera = load_camera(camera_file)
    except CameraError as problem:
        raise SiteError(str(problem)) from problem
    if table.placed_by == "telemetry":
        placed = _placed_by_telemetry(site_file, table, camera, frame)
    else:
        placed = _placed_by_points(site_file, table, camera, frame)
    return replace(placed, image_circle=_circle(table), exposure_locked=table.exposure == "locked")


def _placed_by_telemetry(
    path: Path, table: ImagerTable, camera: OmnidirectionalCamera, frame: LocalFrame
) -> Imager:
    """Return an imaging drone whose camera points down or is tilted to the front, where its top
    is."""
    marks = {
        "control_points": table.control_points,
        "control_points_image_size_px": table.control_points_image_size_px,
        "marked_frame": table.marked_frame,
    }
    for key, value in marks.items():
        if value is not None:
            raise SiteError(
                f"{path}: imager.{key} belongs to control points: remove it, or remove placed_by = "
                '"telemetry"'
            )
    origin = frame.origin
    marked = TelemetryReference(origin.latitude_deg, origin.longitude_deg, 0.0, 0.0)
    pose = mounted_pose(marked, np.zeros(3), table.tilt_deg or 0.0)
    return Imager(table.serial, camera, pose, marked)


def _placed_by_points(
    site_file: Path, table: ImagerTable, camera: OmnidirectionalCamera, frame: LocalFrame
) -> Imager:
    """Return an imaging drone whose camera's pose its control points give."""
    if table.tilt_deg is not None:
        raise SiteError(
            f"{site_file}: imager.tilt_deg belongs to a camera that telemetry places: remove it, "
            "for the control points measure the tilt"
        )
    name, size_px = table.control_points or USUAL_POINTS, table.control_points_image_size_px
    points_file = file_inside(site_file, name, "imager.control_points")
    if size_px is None:
        raise SiteError(
            f"{site_file}: imager.control_points_image_size_px is missing: expected columns and "
            "rows of the frame on which the points were marked; a site without control points "
            'has imager.placed_by = "telemetry"'
        )
    try:
        points = load_control_points(points_file)
    except CameraError as problem:
        raise SiteError(str(problem)) from problem
    points_enu_m = enu_from_points(frame, [point.place for point in points])
    try:
        solution = pose_from_points(camera, points, size_px, points_enu_m)
    except CameraError as problem:
        raise SiteError(f"{points_file}: {problem}") from problem
    imager = Imager(table.serial, camera, solution.pose, _reference(table), solution)
    _refuse_other_place(points_file, points, frame)
    _refuse_other_marked_frame(site_file, imager, frame)
    return imager


def _reference(table: ImagerTable) -> TelemetryReference | None:
    marked = table.marked_frame
    return None if marked is None else TelemetryReference(**msgspec.structs.asdict(marked))


def _circle(table: ImagerTable) -> ImageCircle | None:
    circle = table.image_circle
    return None if circle is None else ImageCircle(circle.col_px, circle.row_px, circle.radius_px)


def _refuse_other_marked_frame(path: Path, imager: Imager, frame: LocalFrame) -> None:
    """Raise `SiteError` for telemetry far from the camera position that the points give."""
    marked = imager.marked_frame
    if marked is None:
        return
    enu = enu_from_geo(
        frame, marked.latitude_deg, marked.longitude_deg, frame.origin.ellipsoid_height_m
    )[0]
    apart_m = float(np.hypot(*(enu - imager.marked_pose.position_enu_m)[:2]))
    if apart_m > LARGEST_MARKED_GAP_M:
        raise SiteError(
            f"{path}: imager.marked_frame: expected telemetry within {LARGEST_MARKED_GAP_M:g} m of "
            f"where the control points put the camera, got {apart_m:.0f} m; is it of that frame?"
        )


def _refuse_other_place(
    points_file: Path, points: Sequence[ControlPoint], frame: LocalFrame
) -> None:
    for point in points:
        enu = enu_from_geo(
            frame, point.latitude_deg, point.longitude_deg, point.ellipsoid_height_m
        )[0]
        distance_m = float(np.hypot(enu[0], enu[1]))
        if distance_m > LARGEST_DISTANCE_M:
            raise SiteError(
                f"{points_file}: control point {point.name}: expected within "
                f"{LARGEST_DISTANCE_M:g} m of the site's origin, got {distance_m:.0f} m; is the "
                "origin right, and the latitude before the longitude?"
            )
    gap_m = float(np.mean([p.ellipsoid_height_m for p in points]))
    gap_m -= frame.origin.ellipsoid_height_m
    if abs(gap_m) > LARGEST_ALTITUDE_GAP_M:
        raise SiteError(
            f"{points_file}: expected altitudes within {LARGEST_ALTITUDE_GAP_M:g} m of "
            f"origin.ground_altitude_m in site.toml, got {gap_m:+.1f} m; both are heights above "
            "the WGS84 ellipsoid, not above sea level"
        )
