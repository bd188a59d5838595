"""What kind of file begins with some bytes, in words: for errors about a wrong file."""

from types import MappingProxyType

KINDS = MappingProxyType(
    {
        b"\x89MCAP": "a flight record (MCAP)",
        b"\xff\xd8\xff": "a JPEG file",
        b"\x89PNG": "a PNG file",
        b"<?xml": "an XML file, such as KML or GPX",
        b"\xef\xbb\xbf<?x": "an XML file, such as KML or GPX",
        b"<kml": "a KML file",
        b"PK\x03\x04": "a ZIP file, such as KMZ",
        b"II*\x00": "a TIFF file",
        b"MM\x00*": "a TIFF file",
        b"SQLite": "an SQLite file, such as MBTiles or GeoPackage",
        b"PMTiles": "a PMTiles file",
        b"%PDF": "a PDF file",
        b"<!DOCTYPE": "an HTML file",
        b"<html": "an HTML file",
        b"{": "a JSON file",
        b"[": "a JSON file",
    }
)


def file_kind(start: bytes) -> str:
    """Return the kind of a file by its first eight bytes; their values for an unknown one."""
    if not start:
        return "an empty file"
    known = (kind for head, kind in KINDS.items() if start.startswith(head[:8]))
    return next(known, f"one that begins with {start[:8]!a}")
