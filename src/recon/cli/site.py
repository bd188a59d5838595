"""`recon site`: a site's folder made, checked, and filled from files of other programs."""

import re
import time
from collections.abc import Sequence
from dataclasses import dataclass
from enum import Enum
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from recon.cli.commands import App
from recon.cli.opened_site import FolderArgument, opened_site, save_staged
from recon.cli.options import with_options
from recon.cli.output import print_line, print_warning
from recon.cli.site_fetch import fetch_command
from recon.model.errors import SiteError
from recon.model.geo import GeoPoint
from recon.model.units import M_PER_FT

if TYPE_CHECKING:
    from recon.model.airspace import SiteLayer
    from recon.site.drawing import DrawnFeature

site_app = App(help="Make, check and fill a site's folder: import, fetch.", no_args_is_help=True)
site_app.command("fetch")(fetch_command)


class Layer(Enum):
    """The layer that imported features become."""

    BOUNDARY = "boundary"
    KEEP_OUT = "keep_out"
    HEIGHT_ZONES = "height_zones"
    SURVEY_REGIONS = "survey_regions"
    LANDING_PADS = "landing_pads"


@site_app.command("new")
def new_command(
    folder: Annotated[Path, typer.Argument(help="Made if missing.")],
    at: Annotated[
        str, typer.Option("--at", metavar="LAT,LON", help="The origin: a point in the field.")
    ],
    above_sea_level: Annotated[
        str | None,
        typer.Option(
            "--ground-above-sea-level",
            metavar="HEIGHT",
            help="Of the ground there, as maps have it: 278m or 912ft.",
        ),
    ] = None,
    altitude_m: Annotated[
        float | None,
        typer.Option("--ground-altitude-m", help="The same, above the WGS84 ellipsoid."),
    ] = None,
    name: Annotated[str | None, typer.Option(help="Default: the folder's name.")] = None,
    drones: Annotated[
        int,
        typer.Option(
            min=0, max=63, help="Simulated drones to rehearse with, and an imaging drone; 0: none."
        ),
    ] = 3,
) -> None:
    """Make a site's folder. Its layers are drawn in the console, or imported."""
    from recon.site.new_site import NewSiteFields, make_site, point_above_sea_level

    place = _place(at)
    if (above_sea_level is None) == (altitude_m is None):
        raise SiteError("expected one of --ground-above-sea-level and --ground-altitude-m")
    if altitude_m is not None:
        origin = GeoPoint(*place, altitude_m)
    else:
        origin = point_above_sea_level(*place, _height_m(above_sea_level or ""))
    asked = NewSiteFields(name=name or folder.resolve().name, drones=drones, has_imager=drones > 0)
    path = make_site(folder, origin, asked)
    print_line(f"{path} is written")
    print_line(f"draw it and rehearse: recon demo --site {folder}")


@site_app.command("imager")
def imager_command(folder: FolderArgument) -> None:
    """Add a simulated imaging drone to a site: rehearsals then have sun and forecast."""
    from recon.site.drawing import stage_files
    from recon.site.new_site import imager_files

    imagers = opened_site(folder).imagers
    if imagers:
        raise SiteError(f"{folder} has an imaging drone already: {', '.join(sorted(imagers))}")
    save_staged(folder, stage_files(folder, imager_files(folder)), "imaging drone")
    print_line(f"{folder} has a simulated imaging drone; rehearse: recon demo --site {folder}")


@site_app.command("check")
def check_command(folder: FolderArgument) -> None:
    """Read a site as a start does: print its report and warnings, or what is wrong."""
    from recon.site import site_report
    from recon.site.fetched_report import fetched_report

    site = opened_site(folder)
    for line in (*site_report(site), *fetched_report(site, time.time())):
        print_line(line)


@dataclass(frozen=True, slots=True, kw_only=True)
class ImportOptions:
    """What becomes of a file's shapes."""

    layer: Annotated[Layer, typer.Option("--as", help="What its shapes become.")]
    chosen: Annotated[
        list[str] | None, typer.Option("--feature", help="Only the shapes of these names.")
    ] = None
    close_paths: Annotated[
        bool, typer.Option("--close-paths", help="Take paths as areas, closed by a straight line.")
    ] = False
    replaces: Annotated[
        bool, typer.Option("--replace", help="Instead of what the layer holds, not beside it.")
    ] = False


@site_app.command("import")
@with_options
def import_command(
    folder: FolderArgument,
    file: Annotated[
        Path,
        typer.Argument(
            help="KML, KMZ, Shapefile (zip), GeoPackage, GeoJSON, ISOXML, GPX, or a plan of DJI "
            "Pilot 2 or QGroundControl."
        ),
    ],
    options: ImportOptions,
) -> None:
    """Import shapes as a layer of a site. A running station does not see it before its restart."""
    from recon.fields.choice import chosen_features
    from recon.fields.field_file import read_import
    from recon.fields.limits import LARGEST_FILE_BYTES
    from recon.model.airspace import SiteLayer
    from recon.site.layer_import import layer_import
    from recon.site.reading import read_bounded

    frame = opened_site(folder).frame
    assert frame is not None, "a folder's site has an origin"
    data = read_bounded(file, LARGEST_FILE_BYTES, "a file to import")
    found = read_import(file.name, data, close_paths=options.close_paths)
    chosen = chosen_features(file, found, options.chosen)
    layer = SiteLayer(options.layer.value)
    new = layer_import(str(file), found, chosen, layer, frame.origin.ellipsoid_height_m)
    excluded = [*map(str, found.excluded), *new.excluded]
    for warning in (*found.warnings, *(f"excluded: {each}" for each in excluded)):
        print_warning(warning)
    _add(folder, new.features, layer, replaces=options.replaces, what=f"import of {file.name}")
    others = len(found.features) - len(chosen)
    print_line(
        f"{len(new.features)} imported into {layer}, {len(excluded)} excluded"
        + (f", {others} not chosen" if others else "")
    )


def _add(
    folder: Path,
    new: "Sequence[DrawnFeature]",
    layer: "SiteLayer",
    *,
    replaces: bool,
    what: str,
) -> None:
    """Save a site's drawing with new features. Raises `SiteError`."""
    from recon.site.drawing import read_drawing, stage_drawing

    kept = [each for each in read_drawing(folder) if not (replaces and each.layer == layer)]
    save_staged(folder, stage_drawing(folder, [*kept, *new]), what)


def _height_m(text: str) -> float:
    found = re.fullmatch(r"\s*(-?\d+(?:[.,]\d+)?)\s*(m|ft)\s*", text.lower())
    if found is None:
        raise SiteError(
            f"--ground-above-sea-level: expected a height like 278m or 912ft, got {text!a}"
        )
    return float(found[1].replace(",", ".")) * (M_PER_FT if found[2] == "ft" else 1.0)


def _place(text: str) -> tuple[float, float]:
    try:
        latitude, longitude = (float(word) for word in text.split(","))
    except ValueError:
        raise SiteError(
            f"--at: expected LAT,LON in degrees like 41.9,-93.6, got {text!a}"
        ) from None
    return latitude, longitude
