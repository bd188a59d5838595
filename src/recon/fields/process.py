"""The process that reads a file's documents: `python -I -m recon.fields.process TASK`, as JSON.

It limits itself before anything else is loaded. It prints one JSON object: what `tidied` returns,
or the problem. GDAL and PROJ are loaded where a file needs them.
"""

import json
import os
import sys
from pathlib import Path
from typing import Any

from recon.processes.limits import limit_itself

MOST_CPU_S = 15
MOST_MEMORY_BYTES = {False: 768 * 1024**2, True: 2 * 1024**3}
"""Limits of address space; GDAL, PROJ and numpy (True) map 1 GiB before a file is read."""
TABLES = (".shp", ".gpkg")


def main() -> None:
    """Read what the command line names in the working folder."""
    task = json.loads(sys.argv[1])
    documents: dict[str, str] = task["documents"]
    needs_libraries = any(name.endswith((*TABLES, ".json")) for name in documents)
    # A GeoPackage's own SQL functions and extensions stay off.
    os.environ.update(OGR_SQLITE_LOAD_EXTENSIONS="", OGR_GPKG_FOREIGN_KEY_CHECK="NO")
    limit_itself(MOST_MEMORY_BYTES[needs_libraries], MOST_CPU_S)
    from recon.fields.shape import FieldFileError

    answer: dict[str, Any]
    try:
        answer = read_documents(documents, close_paths=task["close_paths"])
    except FieldFileError as problem:
        answer = {"problem": str(problem)}
    except MemoryError:
        answer = {"problem": "expected a file that fits into memory, got a larger one"}
    json.dump(answer, sys.stdout)


def read_documents(documents: dict[str, str], *, close_paths: bool) -> dict[str, Any]:
    """Return the tidied shapes of documents in the working folder, by name and own name.

    Raises `FieldFileError`.
    """
    from recon.fields.shape import Found
    from recon.fields.tidy import tidied

    found = Found()
    for name in documents:
        found.extend(_read(name, documents))
    return tidied(found, close_paths=close_paths)


def _read(name: str, documents: dict[str, str]) -> Any:
    """Return what one document holds; `documents` are their own names by those given here."""
    from recon.fields.limits import MOST_FEATURES

    if name.endswith(TABLES):
        from recon.fields.tables import read_tables

        return read_tables(name, MOST_FEATURES)
    data = Path(name).read_bytes()
    if name.endswith(".json"):
        from recon.fields.json_file import read_json
        from recon.fields.projection import to_globe

        found, crs = read_json(data)
        return found if crs is None else to_globe(found, crs)
    return _read_xml(data, documents)


def _read_xml(data: bytes, documents: dict[str, str]) -> Any:
    from recon.fields.kml import read_kml
    from recon.fields.other_xml import read_gpx, read_isoxml
    from recon.fields.shape import FieldFileError
    from recon.fields.xml_tree import local, xml_tree

    root = xml_tree(data)
    match local(root):
        case "kml" | "Document" | "Folder" | "Placemark":
            return read_kml(root, documents.values())
        case "gpx":
            return read_gpx(root)
        case "ISO11783_TaskData" | "XFC":
            return read_isoxml(root)
    raise FieldFileError("expected KML, GPX or ISOXML, got other XML")


if __name__ == "__main__":
    main()
