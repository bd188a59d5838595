"""Cameras and surface of a finished run of OpenDroneMap, from the files that it leaves.

    cameras.json                            lenses
    odm_report/shots.geojson                poses in the surface model's projection
    opensfm/reconstruction[.topocentric].json   poses about a reference place, if there is no report
    odm_dem/dsm.tif                         the surface model

Its heights have a datum of their own, the same for poses and surface, so it does not matter here.
Files are hostile: sizes are bounded, and each number is checked.
"""

from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, TypeVar

import cv2
import msgspec
import numpy as np
from msgspec import Meta, Struct

from recon.geo import enu_from_geo, geo_from_enu, tangent_plane
from recon.model.arrays import FloatArray
from recon.model.errors import RecordError
from recon.model.geo import GeoPoint, LocalFrame
from recon.product.mosaic.cameras import Camera, PhotoLens
from recon.product.mosaic.surface_model import SurfaceModel, opened_surface_model
from recon.product.timing import TimedPhoto

CAMERAS, SHOTS, SURFACE = "cameras.json", "odm_report/shots.geojson", "odm_dem/dsm.tif"
RECONSTRUCTIONS = ("opensfm/reconstruction.topocentric.json", "opensfm/reconstruction.json")
REFERENCE = "opensfm/reference_lla.json"
LARGEST_BYTES = {CAMERAS: 16_000_000, SHOTS: 256_000_000, REFERENCE: 4096}
LARGEST_RECONSTRUCTION_BYTES = 1_000_000_000
"""With the points of its cloud."""
MOST_SHOTS = 100_000
FARTHEST_M = 100_000.0
"""From the site's origin: any farther, the run is of another site."""
VERSION_BEFORE_ID = "v2 "
"""What OpenSfM writes before a camera's id and cameras.json leaves out."""
SUPPORTED = ("perspective", "brown", "radial", "simple_radial")
SCALES_WITHIN = 0.002

Coefficient = Annotated[float, Meta(ge=-10.0, le=10.0)]
Focal = Annotated[float, Meta(ge=0.1, le=100.0)]
Coordinate = Annotated[float, Meta(ge=-1e8, le=1e8)]
Angle = Annotated[float, Meta(ge=-10.0, le=10.0)]
Side = Annotated[int, Meta(ge=16, le=100_000)]
Three = tuple[Coordinate, Coordinate, Coordinate]


class _Camera(Struct, frozen=True):
    """Lengths are in the longer side of the picture."""

    width: Side
    height: Side
    projection_type: str = "perspective"
    focal: Focal | None = None
    focal_x: Focal | None = None
    focal_y: Focal | None = None
    c_x: Coefficient = 0.0
    c_y: Coefficient = 0.0
    k1: Coefficient = 0.0
    k2: Coefficient = 0.0
    k3: Coefficient = 0.0
    p1: Coefficient = 0.0
    p2: Coefficient = 0.0


class _Properties(Struct, frozen=True):
    filename: Annotated[str, Meta(max_length=1024)]
    camera: Annotated[str, Meta(max_length=1024)]
    translation: Three
    """The camera's place, east, north and up in the surface model's projection."""
    rotation: tuple[Angle, Angle, Angle]


class _Feature(Struct, frozen=True):
    properties: _Properties


class _Shots(Struct, frozen=True):
    features: Annotated[list[_Feature], Meta(max_length=MOST_SHOTS)]


class _Shot(Struct, frozen=True):
    camera: Annotated[str, Meta(max_length=1024)]
    rotation: tuple[Angle, Angle, Angle]
    translation: Three


class _Reference(Struct, frozen=True):
    latitude: Annotated[float, Meta(ge=-90.0, le=90.0)]
    longitude: Annotated[float, Meta(ge=-180.0, le=180.0)]
    altitude: Annotated[float, Meta(ge=-1_000.0, le=10_000.0)]


class _Reconstruction(Struct, frozen=True):
    shots: dict[str, _Shot]
    reference_lla: _Reference | None = None


@dataclass(frozen=True, slots=True, eq=False)
class _Pose:
    camera: str
    place_m: FloatArray
    """(3,): east, north, up in the site's frame."""
    rotation: FloatArray
    """(3, 3): from the camera's axes to the site's frame."""


@dataclass(frozen=True, slots=True, eq=False)
class OdmRun:
    """A finished run in the site's frame."""

    folder: Path
    surface: SurfaceModel
    _lenses: Mapping[str, _Camera]
    _poses: Mapping[str, _Pose]
    """By the photo's name."""

    def cameras(self, photos: Sequence[TimedPhoto]) -> dict[int, Camera]:
        """Return the cameras of photos that the run has, by index; raises `RecordError`."""
        found = {}
        for index, timed in enumerate(photos):
            pose = self._poses.get(timed.photo.name) or self._poses.get(timed.photo.path.name)
            if pose is not None:
                found[index] = self._camera(timed, pose)
        if not found:
            raise RecordError(
                f"{self.folder}: expected a run of OpenDroneMap with these photos, got one with "
                f"{len(self._poses)} others"
            )
        return found

    def _camera(self, timed: TimedPhoto, pose: _Pose) -> Camera:
        stated = self._lenses.get(pose.camera.removeprefix(VERSION_BEFORE_ID))
        if stated is None:
            raise RecordError(f"{self.folder / CAMERAS}: expected {pose.camera!a:.100}, got none")
        cols, rows = timed.photo.cols, timed.photo.rows
        scale = cols / stated.width
        if abs(scale / (rows / stated.height) - 1.0) > SCALES_WITHIN:
            raise RecordError(
                f"{timed.photo.name}: expected {stated.width} x {stated.height} pixels as in "
                f"{self.folder / CAMERAS}, got {cols} x {rows}: is it the photo that was "
                "processed, not turned?"
            )
        return Camera(pose.place_m, pose.rotation, _lens(stated, cols, rows), cols, rows)


@contextmanager
def opened_odm(folder: Path, frame: LocalFrame) -> Iterator[OdmRun]:
    """Open a run's folder; raises `RecordError` for one that is not finished, or damaged."""
    lenses = _read(folder / CAMERAS, dict[str, _Camera], LARGEST_BYTES[CAMERAS])
    for name, camera in lenses.items():
        _refuse_other_lens(folder / CAMERAS, name, camera)
    surface = folder / SURFACE
    if not surface.is_file():
        raise RecordError(f"{surface}: expected a surface model: run OpenDroneMap with --dsm")
    with opened_surface_model(surface, frame) as model:
        if (folder / SHOTS).is_file():
            poses = _poses_of_report(folder / SHOTS, model)
        else:
            poses = _poses_of_reconstruction(folder, frame)
        for name, pose in poses.items():
            if not np.linalg.norm(pose.place_m) <= FARTHEST_M:
                raise RecordError(
                    f"{folder}: expected photos near the site, got {name!a:.100} "
                    f"{np.linalg.norm(pose.place_m) / 1000.0:.0f} km from its origin"
                )
        stripped = {name.removeprefix(VERSION_BEFORE_ID): each for name, each in lenses.items()}
        yield OdmRun(folder, model, stripped, poses)


Value = TypeVar("Value")


def _read(path: Path, kind: type[Value], largest_bytes: int) -> Value:
    """Return a JSON file's value; raises `RecordError`."""
    try:
        with path.open("rb") as file:
            data = file.read(largest_bytes + 1)
    except OSError as problem:
        raise RecordError(
            f"{path}: expected a file of a finished run of OpenDroneMap, got: {problem.strerror}"
        ) from problem
    if len(data) > largest_bytes:
        raise RecordError(f"{path}: expected at most {largest_bytes} bytes, got more")
    try:
        return msgspec.json.decode(data, type=kind)
    except (msgspec.MsgspecError, UnicodeError, RecursionError) as problem:
        raise RecordError(f"{path}: expected a file of OpenDroneMap, got: {problem}") from problem


def _refuse_other_lens(path: Path, name: str, camera: _Camera) -> None:
    if camera.projection_type not in SUPPORTED:
        raise RecordError(
            f"{path}: expected lenses of {', '.join(SUPPORTED)}, got "
            f"{camera.projection_type!a:.40} of {name!a:.100}: run OpenDroneMap with "
            "--camera-lens brown"
        )
    needed = ("focal",) if camera.projection_type == "perspective" else ("focal_x", "focal_y")
    if any(getattr(camera, each) is None for each in needed):
        raise RecordError(f"{path}: expected {' and '.join(needed)} of {name!a:.100}, got none")


def _lens(camera: _Camera, cols: int, rows: int) -> PhotoLens:
    """Return a lens in pixels of a photo; OpenSfM's lengths are in the longer side."""
    size = max(cols, rows)
    focal_x, focal_y = camera.focal_x or camera.focal, camera.focal_y or camera.focal
    assert focal_x is not None  # or the file was refused
    assert focal_y is not None
    centre = (cols - 1) / 2.0 + camera.c_x * size, (rows - 1) / 2.0 + camera.c_y * size
    radial = camera.k1, camera.k2, camera.k3
    return PhotoLens((focal_x * size, focal_y * size), centre, radial, (camera.p1, camera.p2))


def _poses_of_report(path: Path, model: SurfaceModel) -> dict[str, _Pose]:
    """Return the poses of shots.geojson, which are in the surface model's projection."""
    shots = _read(path, _Shots, LARGEST_BYTES[SHOTS]).features
    if not shots:
        raise RecordError(f"{path}: expected photos, got none")
    places = np.array([each.properties.translation for each in shots])
    enu_m = model.file.enu_m(model.frame, places)
    if not np.isfinite(enu_m).all():
        raise RecordError(f"{path}: expected places in the projection of {SURFACE}, got others")
    turn = _turn_to_grid(model, enu_m.mean(axis=0))
    return {
        shot.properties.filename: _Pose(
            shot.properties.camera, place, (_matrix(shot.properties.rotation) @ turn).T
        )
        for shot, place in zip(shots, enu_m, strict=True)
    }


def _turn_to_grid(model: SurfaceModel, middle_m: FloatArray) -> FloatArray:
    """Return the rotation (3, 3) from the site's axes to those of the model's projection.

    Grid north is not true north, and up differs from place to place: the poses were turned once
    for all, about the middle of the photos.
    """
    (latitude,), (longitude,), _height = geo_from_enu(model.frame, middle_m)
    there = LocalFrame(GeoPoint(float(latitude), float(longitude), 0.0))
    ends = np.array([[0.0, 0.0], [0.0, 100.0]])
    rows, cols = model.file.pixels(there, ends).T
    transform = model.file.dataset.transform
    x, y = transform @ (cols + 0.5, rows + 0.5)
    bearing = np.arctan2(x[1] - x[0], y[1] - y[0])
    c, s = np.cos(bearing), np.sin(bearing)
    to_grid = np.array([[c, s, 0.0], [-s, c, 0.0], [0.0, 0.0, 1.0]])
    return np.asarray(to_grid @ _turn_between(model.frame, there))


def _turn_between(frame: LocalFrame, there: LocalFrame) -> FloatArray:
    """Return the rotation (3, 3) from one frame's axes to another's."""
    axes = [tangent_plane(each) for each in (there, frame)]
    first, second = (np.array([each.east, each.north, each.up]) for each in axes)
    return np.asarray(first @ second.T)


def _matrix(rotation: tuple[float, float, float]) -> FloatArray:
    """Return the matrix (3, 3) from the world to a camera of an axis times its angle."""
    return cv2.Rodrigues(np.array(rotation))[0].astype(np.float64)


def _poses_of_reconstruction(folder: Path, frame: LocalFrame) -> dict[str, _Pose]:
    """Return the poses of OpenSfM's reconstruction, in the frame of its reference place."""
    path = next((folder / each for each in RECONSTRUCTIONS if (folder / each).is_file()), None)
    if path is None:
        raise RecordError(
            f"{folder}: expected {SHOTS} or {RECONSTRUCTIONS[1]} of a finished run of "
            "OpenDroneMap, got neither"
        )
    parts = _read(path, list[_Reconstruction], LARGEST_RECONSTRUCTION_BYTES)
    poses: dict[str, _Pose] = {}
    for part in parts:
        reference = part.reference_lla
        if reference is None:
            reference = _read(folder / REFERENCE, _Reference, LARGEST_BYTES[REFERENCE])
        there = LocalFrame(GeoPoint(reference.latitude, reference.longitude, reference.altitude))
        turn = _turn_between(frame, there)
        origin_m = enu_from_geo(frame, reference.latitude, reference.longitude, reference.altitude)[
            0
        ]
        for name, shot in part.shots.items():
            to_camera = _matrix(shot.rotation)
            place_m = origin_m + turn.T @ (-to_camera.T @ np.array(shot.translation))
            poses.setdefault(name, _Pose(shot.camera, place_m, (to_camera @ turn).T))
    return poses
