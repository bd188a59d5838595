"""Routes about access: the person of a request, and the addresses for other devices as QR codes."""

import io
from collections.abc import Callable

from fastapi import FastAPI, Request, Response

from recon.api import schema
from recon.api.addresses import SharedAddress
from recon.api.responses import PROBLEMS, found
from recon.api.security import person_of
from recon.model.person import THIS_COMPUTER

SVG: dict[int | str, dict[str, object]] = {200: {"content": {"image/svg+xml": {}}}}


def add_access_routes(
    app: FastAPI, app_url: Callable[[], str | None], shared: SharedAddress | None
) -> None:
    """Add all routes of this module; `app_url` is the station's first address for apps."""

    @app.get("/api/access")
    async def access(request: Request) -> schema.AccessView:
        """Name and role of the person of this request, and the address for other computers."""
        person = person_of(request)
        return schema.AccessView(
            name=person.name,
            role=person.role.value,
            is_logged_in=person.address != THIS_COMPUTER,
            urls=[] if shared is None else list(shared.urls),
            fingerprint=None if shared is None else shared.fingerprint,
        )

    @app.get("/api/access/qr.svg", response_class=Response, responses=PROBLEMS | SVG)
    async def code() -> Response:
        """The address for other computers with the certificate's fingerprint, as a QR code."""
        text = found(shared, "Other computers reach nothing: start with --https-host").login_url
        return _qr_code(text)

    @app.get("/api/apps/qr.svg", response_class=Response, responses=PROBLEMS | SVG)
    async def app_code() -> Response:
        """The station's first address for companion apps, as a QR code for the phone."""
        return _qr_code(
            found(app_url(), "Apps on other devices reach nothing: start with --link-host")
        )


def _qr_code(text: str) -> Response:
    import segno

    drawn = io.BytesIO()
    segno.make(text, error="l", micro=False).save(
        drawn, kind="svg", scale=4, border=4, dark="#000", light="#fff"
    )
    return Response(drawn.getvalue(), media_type="image/svg+xml")
