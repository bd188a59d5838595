"""A page that makes a site in an empty folder; the station begins there afterwards."""

import asyncio
from collections.abc import Callable
from contextlib import closing
from dataclasses import dataclass, field
from pathlib import Path

from recon import version
from recon.api import schema
from recon.api.login import Login
from recon.api.new_site_app import create_new_site_app
from recon.model.errors import SiteError
from recon.site.new_site import make_site, point_above_sea_level
from recon.station.api_views import outcome_of
from recon.station.api_views.edited_site import site_refusal
from recon.station.api_views.site_service import FileImports
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

    async def make(self, asked: schema.NewSiteRequest) -> schema.ActionResponse:
        """Make the site, or return why not."""
        try:
            origin = point_above_sea_level(
                asked.latitude_deg, asked.longitude_deg, asked.ground_above_sea_level_m
            )
            make_site(self.folder, asked.name, origin, asked.simulated_drones)
        except SiteError as problem:
            return schema.ActionResponse(**outcome_of(site_refusal(str(problem))))
        self.made.set()
        return schema.ActionResponse(**outcome_of(None))


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
