"""`recon detect`: shade maps of a recorded flight."""

import csv
import shutil
from dataclasses import dataclass
from datetime import UTC, datetime, timedelta
from enum import Enum
from pathlib import Path
from typing import Annotated

import numpy as np
import typer

from recon.camera import (
    FrameSizeError,
    GroundProjector,
    OmnidirectionalCamera,
    PoseError,
    TelemetryReference,
    load_camera,
    load_control_points,
    mounted_pose,
    pose_from_points,
)
from recon.camera.image_circle import find_image_circle
from recon.camera.photo_files import read_photo
from recon.camera.registration import RegistrationSettings, RegistrationState, step, view_of
from recon.cli.contact_sheet import MOST_TILES, sheet_png, tile
from recon.cli.output import print_line
from recon.cli.progress import progress_over
from recon.cli.recorded_frames import RecordedFrame, Recording, open_recording
from recon.cli.recorded_maps import refuse_used
from recon.detection import DETECTORS, DetectionSettings, DetectionState, RejectedFrame
from recon.geo import enu_from_points
from recon.geo.sun import sun_position
from recon.model.errors import RecordError
from recon.model.geo import GeoPoint, GroundGrid, LatLon, LocalFrame
from recon.model.imagery import CameraPose, GroundImage, RgbImage
from recon.model.shade import ShadeMap
from recon.model.units import seconds_to_ns
from recon.record.raster.shade_geotiff import shade_cog_bytes

GROUND_PER_HEIGHT = 2.75
"""Side of the ground image by the camera's height: 330 m at 120 m, the real lens's field."""
COLUMNS = ("frame", "time_s", "in_sun", "in_shade", "unknown", "registration", "residual_m", "note")


class ExposureLock(Enum):
    """Whether the camera's exposure was locked."""

    AUTO = "auto"
    LOCKED = "locked"


@dataclass(frozen=True, slots=True, eq=False)
class Start:
    """The local frame, the first pose, and the frame it belongs to (None: the first recorded)."""

    frame: LocalFrame
    pose: CameraPose
    marked: RgbImage | None


@dataclass(frozen=True, slots=True)
class Options:
    """What the user asked for."""

    method: str
    exposure: ExposureLock
    cell_m: float
    start_utc: datetime | None
    every: int


def detect_command(
    source: Annotated[Path, typer.Argument(help="Folder of JPEG or PNG frames, or a video.")],
    camera: Annotated[Path, typer.Option(help="File of the lens.")],
    out: Annotated[Path, typer.Option(help="Folder to write; new or empty.")],
    gcps: Annotated[Path | None, typer.Option(help="Control points of the marked frame.")] = None,
    marked: Annotated[
        Path | None, typer.Option(help="The marked frame; default: the first frame.")
    ] = None,
    height_m: Annotated[
        float | None, typer.Option(help="Without control points: height above ground, level mount.")
    ] = None,
    latitude_deg: Annotated[float | None, typer.Option(help="With --height-m.")] = None,
    longitude_deg: Annotated[float | None, typer.Option(help="With --height-m.")] = None,
    yaw_deg: Annotated[float, typer.Option(help="With --height-m: heading of the top.")] = 0.0,
    method: Annotated[str, typer.Option(help="Detection method.")] = DetectionSettings().method,
    step_s: Annotated[
        float, typer.Option(min=0.01, max=3600.0, help="Seconds between the frames used.")
    ] = 1.0,
    exposure: Annotated[
        ExposureLock, typer.Option(help="Was the camera's exposure locked?")
    ] = ExposureLock.AUTO,
    start_utc: Annotated[
        datetime | None, typer.Option(help="Time of the first frame, for the sun.")
    ] = None,
    cell_m: Annotated[
        float, typer.Option(min=0.25, max=10.0, help="Cell of the ground image.")
    ] = 1.0,
    every: Annotated[int, typer.Option(min=1, help="A GeoTIFF of every Nth frame.")] = 1,
) -> None:
    """Find shade in a recorded flight: GeoTIFFs, a contact sheet, cover over time."""
    options = Options(method, exposure, cell_m, start_utc, every)
    if method not in DETECTORS:
        raise RecordError(f"--method: expected {' or '.join(DETECTORS)}, got {method!a}")
    refuse_used(out)
    lens = load_camera(camera)
    recording = open_recording(source, step_s)
    if gcps is not None:
        start = _start_by_points(lens, gcps, marked, recording)
    else:
        start = _start_by_height(height_m, latitude_deg, longitude_deg, yaw_deg)
    _write_all(out, lens, recording, start, options)


def _start_by_points(
    lens: OmnidirectionalCamera, gcps: Path, marked: Path | None, recording: Recording
) -> Start:
    points = load_control_points(gcps)
    picture = None if marked is None else read_photo(marked)
    shown = next(recording.frames()).rgb if picture is None else picture
    places = [point.place for point in points]
    middle = np.mean(
        [(p.latitude_deg, p.longitude_deg, p.ellipsoid_height_m) for p in places], axis=0
    )
    frame = LocalFrame(GeoPoint(*(float(value) for value in middle)))
    size = (shown.shape[1], shown.shape[0])
    try:
        solution = pose_from_points(lens, points, size, enu_from_points(frame, places))
    except (PoseError, FrameSizeError) as problem:
        raise type(problem)(f"{gcps}: {problem}") from problem
    return Start(frame, solution.pose, picture)


def _start_by_height(
    height_m: float | None,
    latitude_deg: float | None,
    longitude_deg: float | None,
    yaw_deg: float,
) -> Start:
    missing = PoseError(
        "expected --gcps FILE, or --height-m of 1 to 1000 with --latitude-deg and "
        "--longitude-deg of the camera"
    )
    if height_m is None or latitude_deg is None or longitude_deg is None:
        raise missing
    if not 1.0 <= height_m <= 1000.0 or not LatLon(latitude_deg, longitude_deg).is_valid():
        raise missing
    telemetry = TelemetryReference(latitude_deg, longitude_deg, height_m, yaw_deg)
    frame = LocalFrame(GeoPoint(latitude_deg, longitude_deg, 0.0))
    return Start(frame, mounted_pose(telemetry, np.array([0.0, 0.0, height_m])), None)


def _write_all(
    out: Path, lens: OmnidirectionalCamera, recording: Recording, start: Start, options: Options
) -> None:
    """Write into a folder beside `out` that gets its name when all is done."""
    part = out.with_name(f".{out.name}.part")
    try:
        shutil.rmtree(part, ignore_errors=True)
        part.mkdir()
        _run(part, lens, recording, start, options)
        part.replace(out)
    except OSError as problem:
        raise RecordError(
            f"{out}: expected to write a folder, got: {problem.strerror or problem}"
        ) from problem
    finally:
        shutil.rmtree(part, ignore_errors=True)
    print_line(f"wrote {out}: cover.csv, contact-sheet.png and shade maps")


class RecordedFlight:
    """Registers, projects and reads one frame after the other."""

    def __init__(
        self, lens: OmnidirectionalCamera, start: Start, options: Options, first: RgbImage
    ) -> None:
        self._start, self._options = start, options
        scaled = lens.scaled_to(first.shape[0], first.shape[1])
        circle = find_image_circle(first, scaled)
        at_lens = None if circle is None else circle.scaled(lens.cols / scaled.cols)
        self._projector = GroundProjector(_grid(start, options.cell_m), lens, at_lens)
        self._view = view_of(lens, at_lens, RegistrationSettings())
        self._registration = RegistrationState()
        self._shade = DetectionState()
        self._settings = DetectionSettings(
            method=options.method, follows_exposure=options.exposure is ExposureLock.AUTO
        )
        # Twice: a reference is taken at a hover, which takes two frames to see.
        for at_s in (-2.0, -1.0):
            self._registration, _ = step(self._view, self._registration, first, start.pose, at_s)

    def read(
        self, frame: RecordedFrame, number: int
    ) -> tuple[GroundImage, ShadeMap | RejectedFrame, str]:
        """Return a frame's ground image, its shade map, and why it was not registered."""
        self._registration, found = step(
            self._view, self._registration, frame.rgb, self._start.pose, frame.at_s
        )
        rgb, valid = self._projector.project_pixels(frame.rgb, found.pose)
        image = GroundImage(
            grid=self._projector.grid,
            frame_id=number,
            captured_at_ns=seconds_to_ns(frame.at_s),
            rgb=rgb,
            valid=valid,
            pose=found.pose,
            registration=found.registration,
            registration_residual_m=found.residual_m,
            toward_sun_enu=_toward_sun(self._start, self._options, frame.at_s),
            exposure_locked=self._options.exposure is ExposureLock.LOCKED,
            pixels_per_radian=self._projector.camera.pixels_per_radian,
        )
        detect = DETECTORS[self._options.method]
        self._shade, shade = detect(self._shade, image, self._settings)
        return image, shade, found.problem


def _grid(start: Start, cell_m: float) -> GroundGrid:
    east_m, north_m, height_m = (float(value) for value in start.pose.position_enu_m)
    cells = max(1, round(GROUND_PER_HEIGHT * height_m / cell_m))
    half_m = cells * cell_m / 2.0
    return GroundGrid(start.frame, east_m - half_m, north_m + half_m, cell_m, cells, cells)


def _utc(options: Options, at_s: float) -> datetime | None:
    if options.start_utc is None:
        return None
    return options.start_utc.replace(tzinfo=UTC) + timedelta(seconds=at_s)


def _toward_sun(start: Start, options: Options, at_s: float) -> np.ndarray | None:
    utc, origin = _utc(options, at_s), start.frame.origin
    if utc is None:
        return None
    sun = sun_position(LatLon(origin.latitude_deg, origin.longitude_deg), utc.timestamp())
    return sun.toward_enu if sun.elevation_deg > 0.0 else None


def _run(
    part: Path, lens: OmnidirectionalCamera, recording: Recording, start: Start, options: Options
) -> None:
    first = next(recording.frames()).rgb if start.marked is None else start.marked
    flight = RecordedFlight(lens, start, options, first)
    shown_every = -(-recording.count // MOST_TILES)
    tiles: list[RgbImage] = []
    with (part / "cover.csv").open("w", newline="", encoding="utf-8") as file:
        rows = csv.writer(file)
        rows.writerow(COLUMNS)
        frames = progress_over(recording.frames(), "finding shade", recording.count)
        for number, frame in enumerate(frames):
            image, found, problem = flight.read(frame, number)
            shade = None if isinstance(found, RejectedFrame) else found
            note = found.reason if isinstance(found, RejectedFrame) else problem
            rows.writerow(_row(frame, image, shade, note))
            if shade is not None and number % options.every == 0:
                utc = _utc(options, frame.at_s)
                data = shade_cog_bytes(shade, None if utc is None else utc.isoformat())
                (part / f"shade-{number:05d}.tif").write_bytes(data)
            if number % shown_every == 0 and len(tiles) < MOST_TILES:
                tiles.append(tile(image, shade, f"{frame.at_s:.0f} s"))
    (part / "contact-sheet.png").write_bytes(sheet_png(tiles))


def _row(
    frame: RecordedFrame, image: GroundImage, shade: ShadeMap | None, note: str
) -> tuple[str, ...]:
    known = 0.0 if shade is None else float(shade.valid.mean())
    in_sun = 0.0 if shade is None else float(shade.is_sunlit.mean())
    residual_m = image.registration_residual_m
    return (
        frame.name,
        f"{frame.at_s:.2f}",
        f"{in_sun:.4f}",
        f"{known - in_sun:.4f}",
        f"{1.0 - known:.4f}",
        image.registration.value,
        "" if residual_m is None else f"{residual_m:.2f}",
        note,
    )
