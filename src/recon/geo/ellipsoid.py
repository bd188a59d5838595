"""WGS84 latitude, longitude, ellipsoidal height <-> earth-centred coordinates, vectorised."""

import numpy as np
import numpy.typing as npt

FloatArray = npt.NDArray[np.float64]

SEMI_MAJOR_AXIS_M = 6_378_137.0
FLATTENING = 1.0 / 298.257223563
SEMI_MINOR_AXIS_M = SEMI_MAJOR_AXIS_M * (1.0 - FLATTENING)
ECCENTRICITY_SQUARED = FLATTENING * (2.0 - FLATTENING)
SECOND_ECCENTRICITY_SQUARED = ECCENTRICITY_SQUARED / (1.0 - ECCENTRICITY_SQUARED)

LATITUDE_ITERATIONS = 3
"""Bowring's formula is off by under a nanometre near the ground after two; one to spare."""


def prime_vertical_radius_m(latitude_rad: FloatArray) -> FloatArray:
    """Return the radius of curvature in the east-west direction, any shape."""
    sine: FloatArray = np.sin(latitude_rad)
    return SEMI_MAJOR_AXIS_M / np.sqrt(1.0 - ECCENTRICITY_SQUARED * sine * sine)


def meridian_radius_m(latitude_rad: FloatArray) -> FloatArray:
    """Return the radius of curvature in the north-south direction, any shape."""
    radius = prime_vertical_radius_m(latitude_rad)
    return radius**3 * (1.0 - ECCENTRICITY_SQUARED) / SEMI_MAJOR_AXIS_M**2


def ecef_from_geodetic(
    latitude_rad: FloatArray, longitude_rad: FloatArray, height_m: FloatArray
) -> FloatArray:
    """Return earth-centred, earth-fixed metres (N, 3) of N points."""
    radius = prime_vertical_radius_m(latitude_rad)
    across = (radius + height_m) * np.cos(latitude_rad)
    return np.stack(
        [
            across * np.cos(longitude_rad),
            across * np.sin(longitude_rad),
            (radius * (1.0 - ECCENTRICITY_SQUARED) + height_m) * np.sin(latitude_rad),
        ],
        axis=-1,
    )


def geodetic_from_ecef(ecef_m: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return latitude, longitude (radians) and ellipsoidal height (metres) of (N, 3) points.

    Bowring (1976), iterated; for points within some hundred kilometres of the surface.
    """
    x, y, z = ecef_m[..., 0], ecef_m[..., 1], ecef_m[..., 2]
    across = np.hypot(x, y)
    # The parametric latitude, as sine and cosine so that the poles need no special case.
    sine, cosine = _unit(z * SEMI_MAJOR_AXIS_M, across * SEMI_MINOR_AXIS_M)
    for _ in range(LATITUDE_ITERATIONS):
        rise = z + SECOND_ECCENTRICITY_SQUARED * SEMI_MINOR_AXIS_M * sine**3
        run = across - ECCENTRICITY_SQUARED * SEMI_MAJOR_AXIS_M * cosine**3
        sine, cosine = _unit((1.0 - FLATTENING) * rise, run)
    latitude = np.arctan2(rise, run)
    # Height along the normal: no division by cos(latitude), so it works at the poles.
    foot_across = across - SEMI_MAJOR_AXIS_M * cosine
    foot_z = z - SEMI_MINOR_AXIS_M * sine
    height = foot_across * np.cos(latitude) + foot_z * np.sin(latitude)
    return latitude, np.arctan2(y, x), height


def _unit(rise: FloatArray, run: FloatArray) -> tuple[FloatArray, FloatArray]:
    length = np.hypot(rise, run)
    return rise / length, run / length
