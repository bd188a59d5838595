"""The site's areas and pads and the temporary zones, as shapes on a map. Pure."""

import json

from foxglove_schemas_protobuf.GeoJSON_pb2 import GeoJSON

from recon.client.messages import StateMessage
from recon.gateway.foxglove.live_message import GEOJSON, LiveMessage

SITE_TOPIC = "/site"
_COLOURS = {
    "boundary": "#2e7d32",
    "keep_out": "#c62828",
    "height": "#ef6c00",
    "survey": "#f9a825",
    "pad": "#1565c0",
    "temporary_zone": "#c62828",
}


def site_message(seen: StateMessage) -> LiveMessage:
    """Return what is drawn of the site in a state; areas are hardly filled."""
    shapes = []
    if seen.site is not None:
        shapes += [_shape(a.kind, a.name, "Polygon", a.rings) for a in seen.site.areas]
        shapes += [
            _shape("pad", pad.name, "Point", (pad.longitude_deg, pad.latitude_deg))
            for pad in seen.site.pads
        ]
    shapes += [
        _shape("temporary_zone", zone.name, "Polygon", (zone.ring,))
        for zone in seen.temporary_zones
    ]
    text = json.dumps({"type": "FeatureCollection", "features": shapes})
    content = GeoJSON(geojson=text).SerializeToString()
    return LiveMessage(SITE_TOPIC, GEOJSON, seen.time_ns, content)


def _shape(kind: str, name: str, shape: str, coordinates: object) -> dict[str, object]:
    style = {"color": _COLOURS[kind], "fillOpacity": 0.05}
    return {
        "type": "Feature",
        "properties": {"name": name, "kind": kind, "style": style},
        "geometry": {"type": shape, "coordinates": coordinates},
    }
