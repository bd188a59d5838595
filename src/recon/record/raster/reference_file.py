"""The files of sunlit references: what one flight learned of the land, for the flights after it.

    {"format":"recon-sunlit-reference","version":1,"bytes":53792,"sha256":"9f86...", ...}
    <light and then colour: float32, little-endian, row by row from north-west, NaN where unknown>

One file for each camera and ten degrees of the sun's direction: a later flight replaces it.
"""

import re
from collections.abc import Iterator
from hashlib import sha256
from math import atan2, degrees
from pathlib import Path
from typing import Annotated

import msgspec
import numpy as np

from recon.model.errors import RecordError
from recon.model.geo import GeoPoint, GroundGrid, LocalFrame
from recon.model.shade import FloatMap, SunlitReference
from recon.record.files.atomic_file import replace_file

FOLDER = "references"
"""Name of the folder in the site's folder."""
SUFFIX = ".reference"
FORMAT = "recon-sunlit-reference"
VERSION = 1
MOST_FILES = 200
"""Six sun heights by 36 azimuths are never all flown; a folder of more is not this station's."""
MOST_CELLS = 4_000_000
_MOST_HEADER_BYTES = 4096

Share = Annotated[float, msgspec.Meta(ge=-1.0, le=1.0)]
Metres = Annotated[float, msgspec.Meta(ge=-1e5, le=1e5)]
Log = Annotated[float, msgspec.Meta(ge=-20.0, le=20.0)]
Size = Annotated[int, msgspec.Meta(ge=1, le=4096)]


class _ReferenceHeader(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    format: str
    version: int
    bytes: Annotated[int, msgspec.Meta(ge=0, le=8 * MOST_CELLS)]
    sha256: str
    serial: Annotated[str, msgspec.Meta(max_length=64)]
    origin_deg_m: tuple[float, float, float]
    west_m: Metres
    north_m: Metres
    cell_m: Annotated[float, msgspec.Meta(ge=0.1, le=1e3)]
    grid_rows: Size
    grid_cols: Size
    rows: Size
    cols: Size
    toward_sun_enu: tuple[Share, Share, Share]
    camera_enu_m: tuple[Metres, Metres, Metres]
    light_contrast: Log
    colour_contrast: Log
    sun_colour: Log
    exposure_locked: bool


class _ReferenceVersion(msgspec.Struct, frozen=True):
    """What every version of the header has."""

    format: str
    version: int


def write_reference(folder: Path, reference: SunlitReference) -> Path:
    """Write a reference into a site's folder and return its file; raises `RecordError`."""
    path = folder / FOLDER / _name(reference)
    payload = np.stack([reference.light, reference.colour]).astype("<f4").tobytes()
    try:
        path.parent.mkdir(exist_ok=True)
        replace_file(path, msgspec.json.encode(_header_of(reference, payload)) + b"\n" + payload)
    except OSError as problem:
        reason = problem.strerror or str(problem)
        raise RecordError(f"{path} cannot be written: {reason}") from problem
    return path


def read_references(folder: Path) -> tuple[tuple[SunlitReference, ...], tuple[str, ...]]:
    """Return the references in a site's folder, and a sentence for each file that is not used."""
    found, troubles = [], []
    for path in _files(folder / FOLDER):
        try:
            found.append(read_reference(path))
        except RecordError as problem:
            troubles.append(str(problem))
    return tuple(found), tuple(troubles)


def read_reference(path: Path) -> SunlitReference:
    """Return the reference in a file; raises `RecordError` with what was expected and found."""
    try:
        with path.open("rb") as file:
            header = _header(file.readline(_MOST_HEADER_BYTES))
            # One byte more than announced, to notice a file that is too long.
            payload = file.read(header.bytes + 1)
        return _reference(header, payload)
    except OSError as problem:
        raise _unused(path, problem.strerror or str(problem)) from problem
    except ValueError as problem:
        raise _unused(path, str(problem)) from problem


def _files(folder: Path) -> Iterator[Path]:
    try:
        names = sorted(path for path in folder.iterdir() if path.suffix == SUFFIX)
    except OSError:
        return
    yield from (path for path in names[:MOST_FILES] if path.is_file())


def _unused(path: Path, reason: str) -> RecordError:
    return RecordError(
        f"the sunlit reference {path} is not used: {reason}; delete it, and the next flight with "
        "the sun in that direction writes a new one"
    )


def _name(reference: SunlitReference) -> str:
    east, north, up = reference.toward_sun_enu
    azimuth_deg = degrees(atan2(east, north))
    height_deg = degrees(atan2(up, (east**2 + north**2) ** 0.5))
    azimuth, height = (10 * round(angle / 10.0) for angle in (azimuth_deg, height_deg))
    # A serial comes from the network: nothing of it may lead to another folder.
    serial = re.sub(r"[^0-9A-Za-z-]", "_", reference.serial)
    return f"{serial[:64]}-sun-{azimuth % 360:03d}-{height:02d}{SUFFIX}"


def _header_of(reference: SunlitReference, payload: bytes) -> _ReferenceHeader:
    grid = reference.grid
    origin = grid.frame.origin
    rows, cols = reference.light.shape
    return _ReferenceHeader(
        FORMAT,
        VERSION,
        len(payload),
        sha256(payload).hexdigest(),
        serial=reference.serial,
        origin_deg_m=(origin.latitude_deg, origin.longitude_deg, origin.ellipsoid_height_m),
        west_m=grid.west_m,
        north_m=grid.north_m,
        cell_m=grid.cell_m,
        grid_rows=grid.rows,
        grid_cols=grid.cols,
        rows=rows,
        cols=cols,
        toward_sun_enu=reference.toward_sun_enu,
        camera_enu_m=reference.camera_enu_m,
        light_contrast=reference.light_contrast,
        colour_contrast=reference.colour_contrast,
        sun_colour=reference.sun_colour,
        exposure_locked=reference.is_exposure_locked,
    )


def _header(line: bytes) -> _ReferenceHeader:
    """Return a file's header; raises ValueError."""
    try:
        common = msgspec.json.decode(line, type=_ReferenceVersion)
        if common.format == FORMAT and common.version != VERSION:
            raise ValueError(f"expected format version {VERSION}, got {common.version}")
        if common.format == FORMAT:
            return msgspec.json.decode(line, type=_ReferenceHeader)
    except (msgspec.DecodeError, UnicodeError, RecursionError) as problem:
        raise ValueError("its header is damaged") from problem
    raise ValueError(f"expected a file of format {FORMAT}, got {common.format[:40]!a}")


def _reference(header: _ReferenceHeader, payload: bytes) -> SunlitReference:
    """Return the reference of a file's parts; raises ValueError."""
    if len(payload) != header.bytes:
        got = "more" if len(payload) > header.bytes else str(len(payload))
        raise ValueError(f"expected {header.bytes} bytes after its header, got {got}")
    if sha256(payload).hexdigest() != header.sha256:
        raise ValueError("its checksum does not match: the file is damaged")
    if header.bytes != 8 * header.rows * header.cols:
        raise ValueError(
            f"expected two maps of {header.rows} x {header.cols} cells, got {header.bytes} bytes"
        )
    origin = GeoPoint(*header.origin_deg_m)
    if not origin.is_valid():
        raise ValueError("expected an origin on the globe")
    light, colour = _maps(header, payload)
    return SunlitReference(
        header.serial,
        _grid(header, origin),
        header.toward_sun_enu,
        header.camera_enu_m,
        light,
        colour,
        header.light_contrast,
        header.colour_contrast,
        header.sun_colour,
        header.exposure_locked,
    )


def _grid(header: _ReferenceHeader, origin: GeoPoint) -> GroundGrid:
    edges = header.west_m, header.north_m, header.cell_m
    return GroundGrid(LocalFrame(origin), *edges, header.grid_rows, header.grid_cols)


def _maps(header: _ReferenceHeader, payload: bytes) -> tuple[FloatMap, FloatMap]:
    maps = np.frombuffer(payload, dtype="<f4").reshape(2, header.rows, header.cols)
    light, colour = (np.asarray(each, dtype=np.float32) for each in maps)
    known = np.isfinite(light)
    if not (np.array_equal(known, np.isfinite(colour)) and known.any()):
        raise ValueError("expected light and colour of the same cells, got maps that differ")
    if np.abs(maps[:, known]).max() > 20.0:
        raise ValueError("expected light and colour as natural logs within 20, got larger ones")
    return light, colour
