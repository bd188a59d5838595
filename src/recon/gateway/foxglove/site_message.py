"""The site's layers and the temporary zones, as shapes on a map. Pure."""

import json
from collections.abc import Iterable

from foxglove_schemas_protobuf.GeoJSON_pb2 import GeoJSON

from recon.client.site import SiteFeature
from recon.client.zones import TemporaryZoneStatus
from recon.gateway.foxglove.live_message import GEOJSON, LiveMessage

SITE_TOPIC = "/site"
_COLOURS = {
    "boundary": "#2e7d32",
    "keep_out": "#c62828",
    "height_zones": "#ef6c00",
    "landing_pads": "#1565c0",
    "survey_regions": "#f9a825",
    "temporary_zone": "#c62828",
}


def site_message(
    features: Iterable[SiteFeature], zones: Iterable[TemporaryZoneStatus], at_ns: int
) -> LiveMessage:
    """Return all layers, then the zones in force; outlines alone, coloured by layer."""
    shapes = [
        _shape(f.layer, str(f.properties.get("name") or f.layer), dict(f.geometry))
        for f in features
    ]
    shapes += [
        _shape("temporary_zone", z.name, {"type": "Polygon", "coordinates": [z.ring]})
        for z in zones
    ]
    text = json.dumps({"type": "FeatureCollection", "features": shapes})
    return LiveMessage(SITE_TOPIC, GEOJSON, at_ns, GeoJSON(geojson=text).SerializeToString())


def _shape(layer: str, name: str, geometry: dict[str, object]) -> dict[str, object]:
    style = {"color": _COLOURS[layer], "fillOpacity": 0.05}
    properties = {"name": name, "layer": layer, "style": style}
    return {"type": "Feature", "properties": properties, "geometry": geometry}
