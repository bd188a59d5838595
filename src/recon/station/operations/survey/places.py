"""Places of a survey on the globe."""

from collections.abc import Iterable

import numpy as np

from recon.geo import geo_from_enu
from recon.model.geo import LocalFrame
from recon.station.state.survey_record import Place

DECIMALS = 7
"""Of a degree: a centimetre."""


def lon_lat(frame: LocalFrame, places_m: Iterable[Place]) -> list[tuple[float, float]]:
    """Return (longitude, latitude) of places in east-north metres of the frame."""
    points_m = np.array([(*place, 0.0) for place in places_m]).reshape(-1, 3)
    latitude_deg, longitude_deg, _ = geo_from_enu(frame, points_m)
    return [
        (round(float(lon), DECIMALS), round(float(lat), DECIMALS))
        for lon, lat in zip(longitude_deg, latitude_deg, strict=True)
    ]
