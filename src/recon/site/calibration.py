"""An imaging drone's pose from control points marked in the console; the files to save."""

import tomllib
from collections.abc import Mapping
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

from recon.camera import (
    CameraError,
    ControlPoint,
    ControlPointsError,
    PoseSolution,
    TelemetryReference,
    format_control_points,
    load_control_points,
    parse_control_points,
    pose_from_points,
)
from recon.geo import enu_from_points
from recon.model.errors import SiteError
from recon.site import toml_lines
from recon.site.drawing import StagedSite, stage_files
from recon.site.imager import USUAL_POINTS
from recon.site.load import LARGEST_FILE_BYTES, SITE_FILE
from recon.site.reading import file_inside, read_bounded
from recon.site.site import Site

TABLE = "imager"
KEYS = (
    "placed_by",
    "tilt_deg",
    "control_points",
    "control_points_image_size_px",
    "marked_frame",
)
"""What a calibration sets or removes; lens, image circle and exposure stay."""


@dataclass(frozen=True, slots=True)
class MarkedPoints:
    """Control points on one frame of an imaging drone, and the telemetry of that frame."""

    serial: str
    points: tuple[ControlPoint, ...]
    image_size_px: tuple[int, int]
    """Columns and rows of the frame."""
    telemetry: TelemetryReference


def solved(site: Site, marked: MarkedPoints) -> PoseSolution:
    """Return the camera's pose by these points. Raises `CameraError` for points that give none."""
    imager, frame = site.imagers[marked.serial], site.frame
    assert frame is not None, "a site with an imaging drone has an origin"
    # As the file of points is read again: names that it cannot hold are refused here.
    points = parse_control_points(format_control_points(marked.points), "control points")
    if len(points) != len(marked.points):
        raise ControlPointsError("a control point's name cannot begin with #: rename it")
    points_enu_m = enu_from_points(frame, [point.place for point in points])
    return pose_from_points(imager.camera, points, marked.image_size_px, points_enu_m)


def surveyed_points(folder: Path, serial: str) -> tuple[ControlPoint, ...]:
    """Return the control points that the folder has for an imaging drone; none without a file."""
    text = _text(folder)
    table = _tables(tomllib.loads(text)).get(serial, {})
    name = table.get("control_points", USUAL_POINTS)
    if not (folder / name).is_file():
        return ()
    try:
        return load_control_points(file_inside(folder / SITE_FILE, name, "imager.control_points"))
    except CameraError as problem:
        raise SiteError(str(problem)) from problem


def stage_calibration(folder: Path, marked: MarkedPoints) -> StagedSite:
    """Return the site with these control points, and its files. Raises `SiteError` as a start."""
    text = _text(folder)
    before = tomllib.loads(text)
    tables = _tables(before)
    name = tables[marked.serial].get("control_points") or _free_name(tables)
    values = {
        "control_points": name,
        "control_points_image_size_px": list(marked.image_size_px),
        "marked_frame": asdict(marked.telemetry),
    }
    changed = "".join(
        line
        for block in toml_lines.blocks(text, TABLE)
        for line in (
            toml_lines.with_keys(block, TABLE, KEYS, values)
            if _is_of(block, marked.serial)
            else block
        )
    )
    if not toml_lines.is_read_as(changed, _wanted(before, marked.serial, values)):
        raise SiteError(
            f"{folder / SITE_FILE}: expected [imager] as a section with one key a line, got "
            "another form; edit it by hand while the station is stopped"
        )
    points = format_control_points(marked.points).encode()
    return stage_files(folder, {SITE_FILE: changed.encode(), name: points})


def _text(folder: Path) -> str:
    return read_bounded(folder / SITE_FILE, LARGEST_FILE_BYTES, "a site file").decode()


def _tables(values: Mapping[str, Any]) -> dict[str, dict[str, Any]]:
    """Return the tables of [imager] or [[imager]] by serial."""
    found = values.get(TABLE, [])
    return {each["serial"]: each for each in (found if isinstance(found, list) else [found])}


def _free_name(tables: Mapping[str, Mapping[str, Any]]) -> str:
    """Return a name for the points that no other imaging drone's file has."""
    taken = {table.get("control_points", USUAL_POINTS) for table in tables.values()}
    if len(tables) == 1 or USUAL_POINTS not in taken:
        return USUAL_POINTS
    return next(name for n in range(2, 100) if (name := f"GCPs-{n}.txt") not in taken)


def _is_of(block: list[str], serial: str) -> bool:
    is_imager = toml_lines.is_section(block, TABLE)
    return is_imager and toml_lines.values_of(block, TABLE).get("serial") == serial


def _wanted(before: Mapping[str, Any], serial: str, values: Mapping[str, Any]) -> dict[str, Any]:
    def changed(table: Mapping[str, Any]) -> dict[str, Any]:
        if table["serial"] != serial:
            return dict(table)
        return {**{key: value for key, value in table.items() if key not in KEYS}, **values}

    found = before[TABLE]
    imagers = [changed(each) for each in found] if isinstance(found, list) else changed(found)
    return {**before, TABLE: imagers}
