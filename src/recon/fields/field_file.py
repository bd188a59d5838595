"""The one door for files with fields: site import, console, `recon plan`, `recon survey create`.

The file may come from anywhere. It is recognised by its first bytes, not by its name; archives are
unpacked within limits. What is left is read in a process of its own with limits of memory and time:
whatever a file does to a parser, the station flies on.
"""

import json
import signal
import subprocess
import sys
from codecs import BOM_UTF8, BOM_UTF16_BE, BOM_UTF16_LE
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path, PurePosixPath
from tempfile import TemporaryDirectory
from typing import Any

from recon.fields.archive import SHP_MAGIC, unpacked
from recon.fields.limits import LARGEST_FILE_BYTES
from recon.fields.shape import FieldFileError
from recon.model.errors import SiteError

LONGEST_WAIT_S = 120.0
"""Longest wait for a file's process on a computer busy with a flight; it ends far sooner."""
PROCESS = ("-m", "recon.fields.process")
FORMATS = (
    "KML, KMZ, Shapefile (zip), GeoPackage, GeoJSON, ISOXML (TASKDATA), GPX, zones of ED-269 or "
    "ED-318, or a plan of DJI Pilot 2 or QGroundControl"
)
_SQLITE_MAGIC, _ZIP_MAGIC = b"SQLite format 3\x00", b"PK\x03\x04"


@dataclass(frozen=True, slots=True, eq=False)
class ImportedFeature:
    """A polygon with holes or a point, longitude first, degrees of WGS84."""

    name: str
    geometry: Mapping[str, Any]
    layer: str | None = None
    """The site's layer that it is by its file, where that says so: a zone of an authority."""
    attributes: Mapping[str, str | float] = field(default_factory=dict)
    """Of that layer: heights with their datum, notes."""


@dataclass(frozen=True, slots=True)
class Excluded:
    """A shape that is left out, and why."""

    name: str
    reason: str

    def __str__(self) -> str:
        return f"{self.name}: {self.reason}" if self.name else self.reason


@dataclass(frozen=True, slots=True, eq=False)
class Imported:
    """What a file holds, and everything of it that is left out."""

    features: tuple[ImportedFeature, ...]
    excluded: tuple[Excluded, ...]
    warnings: tuple[str, ...]
    is_fit_for_fences: bool
    """False where nobody knows how far from their true place the shapes are."""
    has_open_paths: bool
    """Whether `close_paths` would take more of it."""


class OnlyPathsError(SiteError):
    """A file with paths alone, which `close_paths` takes as areas."""


def read_import(name: str, data: bytes, *, close_paths: bool = False) -> Imported:
    """Return the polygons and points of a file; `name` appears in errors. Raises `SiteError`.

    `close_paths` takes paths as areas; without it only those that end where they begin.
    """
    shown = ascii(PurePosixPath(name).name)[1:-1][:80] or "the file"
    if len(data) > LARGEST_FILE_BYTES:
        raise SiteError(f"{shown}: expected at most {LARGEST_FILE_BYTES} bytes, got {len(data)}")
    try:
        with TemporaryDirectory(prefix="recon-import-") as folder:
            documents = _put_safely(data, Path(folder))
            answer = _read_in_process(documents, Path(folder), close_paths=close_paths)
    except FieldFileError as problem:
        raise SiteError(f"{shown}: {problem}") from problem
    return _imported(shown, answer)


def _imported(shown: str, answer: Mapping[str, Any]) -> Imported:
    from recon.fields.soundness import fault_of

    features: list[ImportedFeature] = []
    excluded = [Excluded(each["name"], each["reason"]) for each in answer["excluded"]]
    for number, each in enumerate(answer["features"], start=1):
        fault = fault_of(each["geometry"])
        if fault is None:
            features.append(
                ImportedFeature(each["name"], each["geometry"], each["layer"], each["attributes"])
            )
        else:
            excluded.append(Excluded(each["name"] or f"shape {number}", fault))
    if not features:
        why = "; ".join(map(str, excluded[:5])) or "an empty file"
        kind = OnlyPathsError if answer["has_open_paths"] else SiteError
        raise kind(f"{shown}: expected polygons or points, got none: {why}")
    return Imported(
        tuple(features),
        tuple(excluded),
        tuple(answer["warnings"]),
        answer["is_fit_for_fences"],
        answer["has_open_paths"],
    )


def _put_safely(data: bytes, folder: Path) -> dict[str, str]:
    """Write the file, or what its archive holds, under names of our own; return both names."""
    if data.startswith(_ZIP_MAGIC):
        return unpacked(data, folder)
    if data.startswith(SHP_MAGIC):
        raise FieldFileError(
            "expected a Shapefile as a zip with its .shp, .shx, .dbf and .prj, got the .shp alone"
        )
    suffix = _suffix(data)
    if suffix is None:
        raise FieldFileError(f"expected {FORMATS}, got another kind of file")
    (folder / f"0{suffix}").write_bytes(data)
    return {f"0{suffix}": ""}


def _suffix(data: bytes) -> str | None:
    """Return under which suffix the process reads a file: by its first bytes."""
    if data.startswith(_SQLITE_MAGIC):
        return ".gpkg"
    if data.startswith((BOM_UTF16_BE, BOM_UTF16_LE)):
        return ".xml"
    begin = data[:1000].removeprefix(BOM_UTF8).lstrip()[:1]
    return {b"<": ".xml", b"{": ".json"}.get(begin)


def _read_in_process(documents: Mapping[str, str], folder: Path, *, close_paths: bool) -> Any:
    task = json.dumps({"documents": documents, "close_paths": close_paths})
    try:
        ended = subprocess.run(
            [sys.executable, "-I", *PROCESS, task],
            cwd=folder,
            env={"PATH": ""},
            stdin=subprocess.DEVNULL,
            capture_output=True,
            timeout=LONGEST_WAIT_S,
            check=False,
        )
    except subprocess.TimeoutExpired:
        raise _slow() from None
    if sys.platform != "win32" and ended.returncode == -signal.SIGXCPU:
        raise _slow()
    if ended.returncode != 0:
        raise FieldFileError(f"expected {FORMATS}, got a file that cannot be read")
    answer = json.loads(ended.stdout)
    if "problem" in answer:
        raise FieldFileError(answer["problem"])
    return answer


def _slow() -> FieldFileError:
    return FieldFileError(
        "expected a file that is read in a few seconds, got a slower one; simplify its shapes"
    )
