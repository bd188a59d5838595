"""`recon site fetch`: heights and weather of a site, brought before leaving base."""

import asyncio
from typing import Annotated

import typer

from recon.cli.opened_site import FolderArgument, opened_site
from recon.model.errors import SiteError

INCOMPLETE = 1


def fetch_command(
    folder: FolderArgument,
    elevation: Annotated[
        list[str] | None,
        typer.Option(
            metavar="TEMPLATE_OR_FILE",
            help="GeoTIFF tiles of a degree, with {NS}{lat:02} and {EW}{lon:03}, or files; "
            "default: [fetch] of site.toml.",
        ),
    ] = None,
    datum: Annotated[
        str | None,
        typer.Option(
            metavar="geoid|wgs84",
            help="Zero of the heights; known for Copernicus GLO-30, GLO-90 and USGS 3DEP.",
        ),
    ] = None,
    weather: Annotated[
        str | None,
        typer.Option(
            metavar="TEMPLATE_OR_FILE",
            help="Open-Meteo's forecast, with {latitude} and {longitude}, or a file of one; "
            "default: [fetch] of site.toml.",
        ),
    ] = None,
    replaces: Annotated[
        bool, typer.Option("--replace", help="Instead of an elevation file of your own.")
    ] = False,
) -> None:
    """Fetch what the site needs at the field: the ground's heights, and the weather.

    With an option only what it names. Ask the sources' licences first. An interrupted fetch
    resumes where it stopped. Exit code 1: not all of the boundary has heights.
    """
    from recon.cli.elevation_fetch import fetch_elevation
    from recon.cli.weather_fetch import fetch_weather
    from recon.site.load import read_fetch_table

    site, table = opened_site(folder), read_fetch_table(folder)
    stated = datum
    if not elevation and weather is None:
        elevation = [table.elevation] if table.elevation else []
        weather, stated = table.weather, datum or table.elevation_datum
    if not elevation and weather is None:
        raise SiteError(
            f"{folder}: expected where to fetch from, got nothing: give --elevation or --weather, "
            'or add [fetch] with elevation = "..." or weather = "..." to site.toml'
        )
    if weather is not None:
        asyncio.run(fetch_weather(folder, site, weather))
    if elevation and not asyncio.run(fetch_elevation(folder, site, elevation, stated, replaces)):
        raise typer.Exit(INCOMPLETE)
