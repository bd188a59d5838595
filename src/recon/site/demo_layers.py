"""The demonstration's GeoJSON layers: a boundary, a farmyard to keep out of, two fields to survey.

The outlines are in metres east and north of the origin, here only; the files hold degrees.
"""

import json
from collections.abc import Mapping

from recon.geo import geo_from_enu
from recon.model.geo import LocalFrame

Outline = tuple[tuple[float, float], ...]

BOUNDARY: Outline = ((-245, -240), (240, -245), (250, 60), (180, 245), (-230, 250))
FARMYARD: Outline = ((150, 60), (205, 60), (205, 120), (180, 120), (180, 95), (150, 95))
SURVEY: Mapping[str, Outline] = {
    "west field": ((-200, 20), (-60, 30), (-50, 200), (-190, 190)),
    "south-east field": ((40, -200), (190, -190), (200, -60), (90, -40)),
}
DECIMALS = 8
"""Of a degree: a millimetre."""


def demo_layer_files(frame: LocalFrame) -> dict[str, str]:
    """Return the text of each layer's file around a frame's origin; the same at each call."""
    return {
        "boundary.geojson": _collection("boundary", {"demo field": BOUNDARY}, frame),
        "keep_out.geojson": _collection("keep_out", {"farmyard": FARMYARD}, frame),
        "survey_regions.geojson": _collection("survey_regions", SURVEY, frame),
    }


def _collection(name: str, outlines: Mapping[str, Outline], frame: LocalFrame) -> str:
    features = ",\n".join(
        json.dumps(
            {
                "type": "Feature",
                "properties": {"name": feature},
                "geometry": {"type": "Polygon", "coordinates": [_ring(outline, frame)]},
            }
        )
        for feature, outline in outlines.items()
    )
    return (
        f'{{\n"type": "FeatureCollection",\n"name": "{name}",\n"features": [\n{features}\n]\n}}\n'
    )


def _ring(outline: Outline, frame: LocalFrame) -> list[list[float]]:
    """Return longitude, latitude pairs, the first again at the end."""
    points = [(east_m, north_m, 0.0) for east_m, north_m in (*outline, outline[0])]
    latitudes, longitudes, _ = geo_from_enu(frame, points)
    return [
        [round(float(longitude), DECIMALS), round(float(latitude), DECIMALS)]
        for latitude, longitude in zip(latitudes, longitudes, strict=True)
    ]
