"""Importing polygons and points of a KML, KMZ, Shapefile (zip), GeoPackage or GeoJSON file.

The file may come from anywhere. It is recognised by its first bytes, not by its name; archives are
unpacked within limits of size and number, under names of our own; XML that is no KML or has a
document type (the way to entities) is refused. What is left is read by GDAL in a process of its own
with limits of memory and time: whatever a file does to a parser, the station flies on.
"""

import io
import json
import signal
import subprocess
import sys
import zipfile
import zlib
from codecs import BOM_UTF8
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path, PurePosixPath
from tempfile import TemporaryDirectory
from typing import Any, NoReturn
from xml.parsers import expat

from recon.model.errors import SiteError
from recon.site.geojson import MOST_CORNERS, MOST_FEATURES, is_json

LARGEST_IMPORT_BYTES = 8 * 1024 * 1024
LARGEST_UNPACKED_BYTES = 32 * 1024 * 1024
MOST_MEMBERS = 200
MOST_IMPORTED_CORNERS = 20_000
"""Most corners of all features: about what one save may send."""
LONGEST_WAIT_S = 120.0
"""Longest wait for a file's process on a computer busy with a flight; it ends far sooner."""
FORMATS = "KML, KMZ, Shapefile (zip), GeoPackage or GeoJSON"

_SHAPEFILE_PARTS = (".shp", ".shx", ".dbf", ".prj", ".cpg")
_SHP_MAGIC = b"\x00\x00\x27\x0a"
_SQLITE_MAGIC = b"SQLite format 3\x00"
_ZIP_MAGIC = b"PK\x03\x04"
_ZIP_ENTRY = b"PK\x01\x02"
_PACKINGS = (zipfile.ZIP_STORED, zipfile.ZIP_DEFLATED)
"""Python unpacks the others without a limit of size."""

_UNREADABLE = (
    zipfile.BadZipFile,
    zlib.error,
    NotImplementedError,
    RuntimeError,
    ValueError,
    EOFError,
    OSError,
)
"""Raised for an archive that is damaged, encrypted, or packed in an unusual way."""
_PROCESS = Path(__file__).with_name("import_process.py")


@dataclass(frozen=True, slots=True, eq=False)
class ImportedFeature:
    """A polygon with holes or a point, longitude first, degrees of WGS84."""

    name: str
    geometry: Mapping[str, Any]


@dataclass(frozen=True, slots=True, eq=False)
class Imported:
    """What a file holds; `excluded` counts features that are neither polygons nor points."""

    features: tuple[ImportedFeature, ...]
    excluded: int


def read_import(name: str, data: bytes) -> Imported:
    """Return the polygons and points of a file; `name` appears in errors. Raises `SiteError`."""
    shown = ascii(PurePosixPath(name).name)[1:-1][:80] or "the file"
    if len(data) > LARGEST_IMPORT_BYTES:
        raise SiteError(f"{shown}: expected at most {LARGEST_IMPORT_BYTES} bytes, got {len(data)}")
    with TemporaryDirectory(prefix="recon-import-") as folder:
        path = _put_safely(shown, data, Path(folder))
        answer = _read_in_process(shown, path)
    features = tuple(ImportedFeature(each["name"], each["geometry"]) for each in answer["features"])
    if not features:
        raise SiteError(f"{shown}: expected polygons or points, got none")
    return Imported(features, answer["excluded"])


def _put_safely(shown: str, data: bytes, folder: Path) -> Path:
    """Write the file, or what its archive holds, under a name of our own; return its path."""
    if data.startswith(_ZIP_MAGIC):
        return _unpack(shown, data, folder)
    if data.startswith(_SQLITE_MAGIC):
        return _written(folder / "import.gpkg", data)
    if data.startswith(_SHP_MAGIC):
        raise SiteError(
            f"{shown}: expected a Shapefile as a zip with its .shp, .shx, .dbf and .prj, got the "
            ".shp alone"
        )
    if data.removeprefix(BOM_UTF8).lstrip().startswith(b"<"):
        return _written(folder / "import.kml", _plain_kml(shown, data))
    if is_json(data):
        return _written(folder / "import.geojson", data)
    raise SiteError(f"{shown}: expected {FORMATS}, got another kind of file")


def _plain_kml(shown: str, data: bytes) -> bytes:
    """Refuse XML whose root is another one, and a document type.

    Entities are a way to other files, and to any size.
    """

    def doctype(*_: object) -> NoReturn:
        raise SiteError(f"{shown}: expected KML without a document type, got one; export it again")

    def element(name: str, _attributes: object) -> None:
        if name.rpartition(":")[2] != "kml":
            raise SiteError(f"{shown}: expected KML, got other XML")
        parser.StartElementHandler = None

    parser = expat.ParserCreate()
    parser.StartDoctypeDeclHandler, parser.StartElementHandler = doctype, element
    try:
        parser.Parse(data, True)
    except (expat.ExpatError, ValueError, LookupError) as problem:
        raise SiteError(f"{shown}: expected KML, got invalid XML: {problem}") from problem
    return data


def _unpack(shown: str, data: bytes, folder: Path) -> Path:
    """Unpack a KMZ's first KML, or a Shapefile's parts."""
    count = data.count(_ZIP_ENTRY)
    if count > MOST_MEMBERS:
        raise SiteError(f"{shown}: expected at most {MOST_MEMBERS} files, got {count}")
    try:
        with zipfile.ZipFile(io.BytesIO(data)) as archive:
            return _members(shown, archive, folder)
    except _UNREADABLE as problem:
        raise SiteError(
            f"{shown}: expected a zip archive that can be read, got: {problem}"
        ) from None


def _members(shown: str, archive: zipfile.ZipFile, folder: Path) -> Path:
    members = [each for each in archive.infolist() if not each.is_dir()]
    for each in members:
        path = PurePosixPath(each.filename.replace("\\", "/"))
        if path.is_absolute() or not path.name or ".." in path.parts or ":" in path.parts[0]:
            raise SiteError(
                f"{shown}: expected names inside the archive, got {ascii(each.filename)[:80]}"
            )
    shapes = [each for each in members if each.filename.lower().endswith(".shp")]
    documents = [each for each in members if each.filename.lower().endswith(".kml")]
    if len(shapes) == 1:
        stem = shapes[0].filename[: -len(".shp")]
        wanted = {stem.lower() + part: part for part in _SHAPEFILE_PARTS}
        parts = [each for each in members if each.filename.lower() in wanted]
        suffixes = {wanted[each.filename.lower()] for each in parts}
        for needed in (".shx", ".dbf", ".prj"):
            if needed not in suffixes:
                raise SiteError(f"{shown}: expected the Shapefile's {needed} in the zip, got none")
        return _shapefile(shown, archive, parts, wanted, folder)
    if not shapes and documents:
        first = min(documents, key=lambda each: (each.filename.lower() != "doc.kml", each.filename))
        content = _content(shown, archive, first, LARGEST_UNPACKED_BYTES)
        return _written(folder / "import.kml", _plain_kml(shown, content))
    got = f"{len(shapes)} of them" if shapes else "neither"
    raise SiteError(f"{shown}: expected a zip with one Shapefile, or a KMZ with KML, got {got}")


def _shapefile(
    shown: str,
    archive: zipfile.ZipFile,
    parts: Iterable[zipfile.ZipInfo],
    wanted: Mapping[str, str],
    folder: Path,
) -> Path:
    left = LARGEST_UNPACKED_BYTES
    for each in parts:
        content = _content(shown, archive, each, left)
        left -= len(content)
        suffix = wanted[each.filename.lower()]
        if suffix == ".shp" and not content.startswith(_SHP_MAGIC):
            raise SiteError(f"{shown}: expected a Shapefile, got another kind of file named .shp")
        _written(folder / f"import{suffix}", content)
    return folder / "import.shp"


def _content(shown: str, archive: zipfile.ZipFile, member: zipfile.ZipInfo, most: int) -> bytes:
    """Return a member's bytes; the size that its header claims is not trusted."""
    if member.compress_type not in _PACKINGS:
        raise SiteError(f"{shown}: expected files stored or deflated, got another compression")
    with archive.open(member) as file:
        content = file.read(most + 1)
    if len(content) > most:
        raise SiteError(
            f"{shown}: expected at most {LARGEST_UNPACKED_BYTES} bytes when unpacked, got more"
        )
    return content


def _written(path: Path, data: bytes) -> Path:
    path.write_bytes(data)
    return path


def _read_in_process(shown: str, path: Path) -> Any:
    limits = (str(MOST_FEATURES), str(MOST_CORNERS), str(MOST_IMPORTED_CORNERS))
    words = [sys.executable, "-I", str(_PROCESS), path.name, *limits]
    try:
        ended = subprocess.run(
            words,
            cwd=path.parent,
            env={"PATH": ""},
            stdin=subprocess.DEVNULL,
            capture_output=True,
            timeout=LONGEST_WAIT_S,
            check=False,
        )
    except subprocess.TimeoutExpired:
        raise _slow(shown) from None
    if sys.platform != "win32" and ended.returncode == -signal.SIGXCPU:
        raise _slow(shown)
    if ended.returncode != 0:
        raise SiteError(f"{shown}: expected {FORMATS}, got a file that cannot be read")
    answer = json.loads(ended.stdout)
    if "problem" in answer:
        raise SiteError(f"{shown}: {answer['problem']}")
    return answer


def _slow(shown: str) -> SiteError:
    return SiteError(
        f"{shown}: expected a file that is read in a few seconds, got a slower one; "
        "simplify its shapes"
    )
