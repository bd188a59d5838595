"""A page that makes a site in an empty folder; the station begins there afterwards."""

import asyncio
from collections.abc import Callable
from contextlib import closing
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from recon import version
from recon.api import schema
from recon.api.login import Login
from recon.api.new_site_app import create_new_site_app
from recon.model.errors import SiteError
from recon.model.geo import GeoPoint
from recon.site.new_site import (
    MOST_LETTERS,
    NewSiteFields,
    layers_of,
    make_site,
    point_above_sea_level,
)
from recon.site.reading import convert
from recon.site.schema import RehearsalTable
from recon.station.api_views import outcome_of
from recon.station.api_views.edited_site import site_refusal
from recon.station.api_views.site_service import FileImports, feature_view
from recon.station.host.http_servers import listen, loopback_server, stop_on_signals, url_of

HOST = "127.0.0.1"


@dataclass(slots=True, eq=False)
class NewSite:
    """The folder, and whether its site is made. Implements `NewSitePort`."""

    folder: Path
    made: asyncio.Event = field(default_factory=asyncio.Event)
    _imports: FileImports = field(default_factory=FileImports)

    def about(self) -> schema.NewSiteView:
        """Return the folder, and its name for the site."""
        folder = self.folder.resolve()
        return schema.NewSiteView(folder=str(folder), name=folder.name)

    async def import_features(
        self, name: str, data: bytes, *, close_paths: bool
    ) -> schema.ImportedView:
        """Return the polygons and points of a file, or why it is refused."""
        return await self._imports.read(name, data, close_paths=close_paths)

    async def shapes(self, asked: schema.NewSiteRequest) -> schema.NewSiteShapes:
        """Return the layers that the site would have, or why there is no such site."""
        try:
            origin, fields = _asked(asked)
            drawn = await asyncio.to_thread(layers_of, origin, fields)
        except SiteError as problem:
            refused = outcome_of(site_refusal(str(problem)))
            return schema.NewSiteShapes(**refused, features=[])
        features = [feature_view(each) for each in drawn.features]
        return schema.NewSiteShapes(**outcome_of(None), features=features)

    async def make(self, asked: schema.NewSiteRequest) -> schema.ActionResponse:
        """Make the site, or return why not."""
        try:
            origin, fields = _asked(asked)
            await asyncio.to_thread(make_site, self.folder, origin, fields)
        except SiteError as problem:
            return schema.ActionResponse(**outcome_of(site_refusal(str(problem))))
        self.made.set()
        return schema.ActionResponse(**outcome_of(None))


def _asked(asked: schema.NewSiteRequest) -> tuple[GeoPoint, NewSiteFields]:
    """Return the origin and the fields of a request. Raises `SiteError`."""
    origin = point_above_sea_level(
        asked.latitude_deg, asked.longitude_deg, asked.ground_above_sea_level_m
    )
    air = {
        "cloud_cover_percent": asked.cloud_cover_percent,
        "wind_mps": asked.wind_mps,
        "wind_from_deg": asked.wind_from_deg,
    }
    fields = NewSiteFields(
        name=asked.name,
        drones=asked.simulated_drones,
        has_imager=asked.simulated_drones > 0,
        regions=_by_name(asked.regions, asked.name),
        margin_m=asked.margin_m,
        rehearsal=convert("rehearsal", air, RehearsalTable, ""),
    )
    return origin, fields


def _by_name(regions: list[schema.NewRegion], site: str) -> dict[str, dict[str, Any]]:
    """Return the polygons by names that are all different; one without a name has the site's."""
    named: dict[str, dict[str, Any]] = {}
    for region in regions:
        name = base = region.name[: MOST_LETTERS - 4].strip() or site
        while name in named:
            name = f"{base} {len(named) + 1}"
        named[name] = region.geometry.model_dump()
    return named


def awaits_site(folder: Path) -> bool:
    """Return whether a folder is missing or empty: a site may be made there."""
    return not folder.exists() or (folder.is_dir() and not any(folder.iterdir()))


async def make_in_browser(
    folder: Path, http_port: int, console: Path, on_open: Callable[[str], None]
) -> int | None:
    """Serve the page until the site is made. Return its port for the station, None after a signal.

    Raises `StartError` for a port that is taken.
    """
    new_site = NewSite(folder)
    with closing(listen(HOST, http_port, "--http-port")) as sock:
        app = create_new_site_app(new_site, console, version())
        server = loopback_server(app, Login(), HOST)
        stop_on_signals([server])
        serving = asyncio.create_task(server.serve(sockets=[sock]))
        making = asyncio.create_task(new_site.made.wait())
        # The server closes its socket.
        port = int(sock.getsockname()[1])
        on_open(url_of(HOST, sock))
        await asyncio.wait((serving, making), return_when=asyncio.FIRST_COMPLETED)
        making.cancel()
        server.should_exit = True
        await serving
        return port if new_site.made.is_set() else None
