"""What an archive holds, unpacked within limits of size and number, under names of our own."""

import io
import re
import zipfile
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path, PurePosixPath

from recon.fields.limits import LARGEST_UNPACKED_BYTES, MOST_MEMBERS
from recon.fields.shape import FieldFileError
from recon.model.array_archive import DAMAGE, PACKINGS

SHAPEFILE_PARTS = (".shp", ".shx", ".dbf", ".prj", ".cpg")
NEEDED_PARTS = (".shx", ".dbf", ".prj")
SHP_MAGIC = b"\x00\x00\x27\x0a"
MOST_SHAPEFILES = 200
_ENTRY = b"PK\x01\x02"
_ISOXML = re.compile(r"(TASKDATA|PFD\d+)\.XML", re.IGNORECASE)
_NOT_THE_USERS = re.compile(r"(^|/)(__MACOSX/|\._|\.DS_Store$|Thumbs\.db$|desktop\.ini$)")
"""What systems put beside a user's files."""

Members = Mapping[str, zipfile.ZipInfo]


def unpacked(data: bytes, folder: Path) -> dict[str, str]:
    """Write an archive's documents into a folder; return their names there, with their own.

    Raises `FieldFileError`.
    """
    count = data.count(_ENTRY)
    if count > MOST_MEMBERS:
        raise FieldFileError(f"expected at most {MOST_MEMBERS} files, got {count}")
    try:
        with zipfile.ZipFile(io.BytesIO(data)) as archive:
            return _Unpacking(archive, folder).documents()
    except (*DAMAGE, OSError) as problem:
        raise FieldFileError(f"expected a zip archive that can be read, got: {problem}") from None


class _Unpacking:
    def __init__(self, archive: zipfile.ZipFile, folder: Path) -> None:
        self._archive, self._folder = archive, folder
        self._left = LARGEST_UNPACKED_BYTES
        self._members = dict(_of_the_user(archive.infolist()))

    def documents(self) -> dict[str, str]:
        tables = self._named(".shp")
        if tables:
            return self._shapefiles(tables)
        documents = self._named(".kml") or [
            name for name in self._members if _ISOXML.fullmatch(PurePosixPath(name).name)
        ]
        documents = documents or self._named(".geojson", ".json", ".gpx", ".gpkg")
        if not documents:
            shown = ", ".join(sorted({PurePosixPath(n).suffix or n for n in self._members})[:5])
            raise FieldFileError(
                "expected an archive with Shapefiles, KML, ISOXML, GPX, GeoJSON or a GeoPackage, "
                f"got neither, but {shown or 'nothing'}"
            )
        documents.sort(key=lambda name: (PurePosixPath(name).name.lower() != "doc.kml", name))
        return {
            self._write(f"{number}{_kind(name)}", name): name
            for number, name in enumerate(documents)
        }

    def _named(self, *suffixes: str) -> list[str]:
        return [name for name in self._members if name.lower().endswith(suffixes)]

    def _shapefiles(self, tables: Sequence[str]) -> dict[str, str]:
        if len(tables) > MOST_SHAPEFILES:
            raise FieldFileError(
                f"expected at most {MOST_SHAPEFILES} Shapefiles, got {len(tables)}"
            )
        found: dict[str, str] = {}
        by_lower = {name.lower(): name for name in self._members}
        for number, table in enumerate(tables):
            stem = table[: -len(".shp")].lower()
            parts = {p: by_lower[stem + p] for p in SHAPEFILE_PARTS if stem + p in by_lower}
            for needed in NEEDED_PARTS:
                if needed not in parts:
                    raise FieldFileError(
                        f"expected the Shapefile's {needed} in the zip beside "
                        f"{ascii(PurePosixPath(table).name)[:80]}, got none"
                    )
            for part, name in parts.items():
                written = self._write(f"{number}{part}", name)
                if part == ".shp":
                    self._refuse_another_kind(self._folder / written)
            found[f"{number}.shp"] = table
        return found

    def _refuse_another_kind(self, path: Path) -> None:
        with path.open("rb") as file:
            if file.read(4) != SHP_MAGIC:
                raise FieldFileError("expected a Shapefile, got another kind of file named .shp")

    def _write(self, target: str, name: str) -> str:
        """Write a member; the size that its header claims is not trusted."""
        member = self._members[name]
        if member.compress_type not in PACKINGS:
            raise FieldFileError("expected files stored or deflated, got another compression")
        with self._archive.open(member) as file:
            content = file.read(self._left + 1)
        if len(content) > self._left:
            raise FieldFileError(
                f"expected at most {LARGEST_UNPACKED_BYTES} bytes when unpacked, got more"
            )
        self._left -= len(content)
        (self._folder / target).write_bytes(content)
        return target


def _of_the_user(members: Sequence[zipfile.ZipInfo]) -> Iterator[tuple[str, zipfile.ZipInfo]]:
    for each in members:
        name = each.filename.replace("\\", "/")
        # `is_dir` of Python 3.11 fails on an empty name.
        if name.endswith("/") or _NOT_THE_USERS.search(name):
            continue
        path = PurePosixPath(name)
        if path.is_absolute() or not path.name or ".." in path.parts or ":" in path.parts[0]:
            raise FieldFileError(
                f"expected names inside the archive, got {ascii(each.filename)[:80]}"
            )
        yield name, each


def _kind(name: str) -> str:
    """Return the suffix under which the process reads a document."""
    suffix = PurePosixPath(name).suffix.lower()
    return {".geojson": ".json", ".kml": ".xml", ".gpx": ".xml"}.get(suffix, suffix)
