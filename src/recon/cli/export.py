"""`recon export`: the tracks of a flight record as GPX, GeoJSON or CSV."""

from pathlib import Path
from typing import Annotated

import typer

from recon.model.errors import RecordError
from recon.record.atomic_file import replace_file
from recon.record.audit import shown
from recon.record.tracks import FORMATS, read_tracks


def export_command(
    file: Annotated[Path, typer.Argument(metavar="FILE", help="A flight record (MCAP).")],
    out: Annotated[
        Path, typer.Argument(metavar="OUT", help="File to write: .gpx, .geojson or .csv.")
    ],
) -> None:
    """Write the tracks of a flight record's vehicles.

    WGS84; an existing file is not replaced.
    """
    make = FORMATS.get(out.suffix.lower())
    if make is None:
        raise typer.BadParameter(f"OUT: expected {', '.join(FORMATS)}, got {out.suffix!r}")
    if out.exists():
        raise RecordError(f"{out} exists: choose another name, or remove it")
    try:
        tracks = read_tracks(file)
        replace_file(out, make(tracks.points).encode(), 0o644)
    except OSError as problem:
        name = problem.filename or file
        raise RecordError(f"{name}: {problem.strerror}") from problem
    for name, track in tracks.points.items():
        typer.echo(f"{shown(name)}: {len(track)} positions")
    if tracks.trouble:
        typer.echo(f"the record ends early: {shown(tracks.trouble)}", err=True)
