"""Routes about access: the person of a request, and the address for other computers as a QR."""

import io

from fastapi import FastAPI, Request, Response

from recon.api import schema
from recon.api.addresses import SharedAddress
from recon.api.responses import PROBLEMS, found
from recon.api.security import person_of
from recon.model.person import THIS_COMPUTER

SVG: dict[int | str, dict[str, object]] = {200: {"content": {"image/svg+xml": {}}}}


def add_access_routes(app: FastAPI, shared: SharedAddress | None) -> None:
    """Add all routes of this module."""

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
        import segno

        text = found(shared, "Other computers reach nothing: start with --https-host").login_url
        drawn = io.BytesIO()
        segno.make(text, error="l", micro=False).save(
            drawn, kind="svg", scale=4, border=4, dark="#000", light="#fff"
        )
        return Response(drawn.getvalue(), media_type="image/svg+xml")
