"""The application of a folder without a site: one page that asks where the field is.

It answers at the console's address before there is a station, and ends when the site is made.
"""

from pathlib import Path
from typing import Protocol

from fastapi import FastAPI
from fastapi.responses import RedirectResponse

from recon.api import schema
from recon.api.app import add_errors_and_headers, new_app
from recon.api.console_files import ConsoleFiles
from recon.api.import_route import Importing, add_import

PAGE = "new-site.html"


class NewSitePort(Importing, Protocol):
    """What the page needs."""

    def about(self) -> schema.NewSiteView:
        """Return the folder, and a name for the site."""
        ...

    async def shapes(self, asked: schema.NewSiteRequest) -> schema.NewSiteShapes:
        """Return the layers that the site would have, or why there is no such site."""
        ...

    async def make(self, asked: schema.NewSiteRequest) -> schema.ActionResponse:
        """Make the site, or return why not."""
        ...


def create_new_site_app(port: NewSitePort, console: Path, version: str) -> FastAPI:
    """Return the application, to be put behind an `AccessCheck`."""
    app = new_app("Recon: a new site", version, openapi_url=None)

    @app.get("/api/site/new")
    async def about() -> schema.NewSiteView:
        """The folder that waits for a site."""
        return port.about()

    add_import(app, lambda: port)

    @app.post("/api/site/new/shapes")
    async def shapes(asked: schema.NewSiteRequest) -> schema.NewSiteShapes:
        """The layers that the site would have, to be looked at. Nothing is written."""
        return await port.shapes(asked)

    @app.post("/api/site/new")
    async def make(asked: schema.NewSiteRequest) -> schema.ActionResponse:
        """Make the site; the station begins then, at the same address."""
        return await port.make(asked)

    @app.get("/")
    async def page() -> RedirectResponse:
        return RedirectResponse(PAGE)

    app.mount("/", ConsoleFiles(directory=console, html=True), name="console")
    add_errors_and_headers(app)
    return app
