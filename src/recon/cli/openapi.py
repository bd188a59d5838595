"""`recon openapi`: the API's description, from which the console's types are generated."""

import json
from typing import Any

from recon import __version__
from recon.api.app import create_app
from recon.api.security import Access
from recon.site import default_site
from recon.station.api_views.service import Service
from recon.station.kernel.build import first_state
from recon.station.kernel.driver import AsyncioDriver


def openapi_command() -> None:
    """Print the OpenAPI document."""
    print(json.dumps(openapi_document(), indent=2, sort_keys=True))


def openapi_document() -> dict[str, Any]:
    """Return the OpenAPI document of a station that does not run."""
    site = default_site()
    driver = AsyncioDriver(first_state(site), lambda: 0)
    service = Service.around(driver, site, None)
    return create_app(service, Access(), None, __version__).openapi()
