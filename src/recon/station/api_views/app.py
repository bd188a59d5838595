"""The HTTP application of a station: its routes, the streams, the console's files."""

from pathlib import Path

from fastapi import FastAPI

from recon.api.access_routes import add_access_routes
from recon.api.addresses import SharedAddress
from recon.api.app import add_console, add_errors_and_headers, new_app
from recon.api.flight_routes import FlightArchive, NoFlights, add_flight_routes
from recon.api.map_routes import MapFolder, NoMaps, add_map_routes
from recon.api.photo_routes import NoPhotos, PhotoWork, add_photo_routes
from recon.api.replay_routes import Replaying, add_replay_routes
from recon.station.api_views.operation_routes import add_operation_routes
from recon.station.api_views.order_routes import add_order_routes
from recon.station.api_views.pairing_routes import add_pairing_routes
from recon.station.api_views.picture_routes import add_picture_routes
from recon.station.api_views.service import Service
from recon.station.api_views.site_routes import add_site_routes
from recon.station.api_views.state_routes import add_state_routes
from recon.station.api_views.survey_routes import add_survey_routes
from recon.station.api_views.vehicle_routes import add_vehicle_routes
from recon.station.api_views.zone_routes import add_zone_routes


def create_app(
    service: Service,
    console: Path | None,
    version: str,
    shared: SharedAddress | None = None,
    flights: FlightArchive | None = None,
    replay: Replaying | None = None,
    maps: MapFolder | None = None,
    photos: PhotoWork | None = None,
) -> FastAPI:
    """Return the application around a station, to be put behind an `AccessCheck`.

    `console` is the folder with the built console; without one a page describes how to build it.
    `shared` is the address for other computers; `flights` are the station's records, `photos` the
    work on photos of these; `maps` its base maps; with a `replay` everything is refused that orders
    or changes anything.
    """
    app = new_app("Recon", version)
    add_access_routes(app, lambda: service.app_url, shared)
    add_state_routes(app, service)
    add_order_routes(app, service)
    add_operation_routes(app, service)
    add_vehicle_routes(app, service)
    add_pairing_routes(app, service)
    add_picture_routes(app, service)
    add_site_routes(app, service)
    add_survey_routes(app, service)
    add_flight_routes(app, flights or NoFlights())
    add_photo_routes(app, photos or NoPhotos())
    add_map_routes(app, maps or NoMaps())
    add_zone_routes(app, service)
    add_replay_routes(app, replay)
    add_console(app, console)
    add_errors_and_headers(app)
    return app
