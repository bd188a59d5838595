"""`recon export`: a flight record in the formats of other programs."""

from pathlib import Path
from typing import Annotated

import typer

from recon.cli.opened_flight import opened_flight
from recon.cli.output import print_line, printable
from recon.cli.progress import opener
from recon.model.errors import RecordError
from recon.product.exports import FLIGHT_FORMATS
from recon.product.flight_netcdf import write_netcdf
from recon.record.files.atomic_file import replace_file
from recon.record.mcap.tracks import FORMATS, read_tracks

NETCDF = ".nc"


def export_command(
    file: Annotated[Path, typer.Argument(metavar="FILE", help="A flight record (MCAP).")],
    out: Annotated[
        Path,
        typer.Argument(
            metavar="OUT",
            help="File to write: tracks as .gpx, .geojson or .csv; surveys and tracks as .kml; "
            "the sun by cell as .tif (GeoTIFF); the report's coverage as .png, figures as .json; "
            "maps, forecasts and tracks as .nc (NetCDF).",
        ),
    ],
    netcdf: Annotated[
        bool, typer.Option("--netcdf", help="Write NetCDF, whatever the extension of OUT.")
    ] = False,
) -> None:
    """Write a flight's tracks, surveys, maps or figures for other programs.

    Places are WGS84, GeoTIFFs name their projection; an existing file is not replaced.
    """
    ending = NETCDF if netcdf else out.suffix.lower()
    if ending not in (*FORMATS, *FLIGHT_FORMATS, NETCDF):
        endings = ", ".join((*FORMATS, *FLIGHT_FORMATS, NETCDF))
        raise typer.BadParameter(f"OUT: expected {endings}, got {out.suffix!r}")
    if out.exists():
        raise RecordError(f"{out} exists: choose another name, or remove it")
    try:
        if ending in FORMATS:
            _write_tracks(file, out)
        elif ending == NETCDF:
            write_netcdf(opened_flight(file), out, opener("writing NetCDF"))
        else:
            replace_file(out, FLIGHT_FORMATS[ending](opened_flight(file)), 0o644)
    except OSError as problem:
        name = problem.filename or file
        raise RecordError(f"{name}: {problem.strerror}") from problem
    print_line(f"written: {out}")


def _write_tracks(file: Path, out: Path) -> None:
    tracks = read_tracks(file, opener("reading tracks"))
    replace_file(out, FORMATS[out.suffix.lower()](tracks.points).encode(), 0o644)
    for name, track in tracks.points.items():
        print_line(printable(f"{name}: {len(track)} positions"))
    if tracks.trouble:
        typer.echo(f"the record ends early: {printable(tracks.trouble)}", err=True)
