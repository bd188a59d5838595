"""`recon shadow-record`: the shade maps of a flight and what they tell of each cell, as GeoTIFF."""

from pathlib import Path
from typing import Annotated

import typer

from recon.cli.opened_flight import opened_flight
from recon.cli.output import print_line
from recon.cli.progress import progress_over
from recon.cli.recorded_maps import refuse_used
from recon.model.errors import RecordError
from recon.product.photos.card import begin_own
from recon.product.shadow_record import photos_by_cell, sun_by_cell, sun_cog
from recon.product.sun_at import shade_map
from recon.product.tag import sun_history
from recon.product.tagged import tagged_photos
from recon.record.files.atomic_file import replace_file
from recon.record.raster.shade_geotiff import shade_cog_bytes

MAPS, SUN = "shade", "sun.tif"
FILE_MODE = 0o644


def shadow_record_command(
    file: Annotated[Path, typer.Argument(metavar="FILE", help="A flight record (MCAP).")],
    out: Annotated[Path, typer.Option(help="A new or empty folder.")] = Path("shadow-record"),
    tagged: Annotated[
        Path | None,
        typer.Option(help="A folder that recon tag has written: adds photos by cell."),
    ] = None,
) -> None:
    """Write a flight's shade maps, and when each cell was in sun, as GeoTIFFs."""
    refuse_used(out)
    flight = opened_flight(file)
    history = sun_history(flight)
    sun, photos = sun_by_cell(history), None
    if tagged is not None:
        shown = [(each.at_ns, each.footprint) for each in tagged_photos(tagged, flight)]
        photos = photos_by_cell(history, progress_over(shown, "photos", len(shown)))
    try:
        begin_own(out)
        (out / MAPS).mkdir(exist_ok=True)
        for kept in progress_over(flight.maps, "shade maps", len(flight.maps)):
            utc = flight.utc(kept.at_ns)
            name = utc.replace("-", "").replace(":", "") + ".tif"
            data = shade_cog_bytes(shade_map(kept, history.grid), utc)
            replace_file(out / MAPS / name, data, FILE_MODE)
        replace_file(out / SUN, sun_cog(flight, sun, photos), FILE_MODE)
    except OSError as problem:
        raise RecordError(f"{problem.filename or out}: {problem.strerror}") from problem
    first, last = flight.utc(flight.maps[0].at_ns), flight.utc(flight.maps[-1].at_ns)
    print_line(f"{len(flight.maps)} shade maps, {first} to {last}: {out / MAPS}")
    print_line(f"first and last time in sun by cell: {out / SUN}")
