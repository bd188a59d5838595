"""Places on the ground."""

import numpy as np
import pytest

from recon.model.geo import LatLon
from recon.sim.world import SunSettings

NOON_UTC_S = 1_750_442_400.0
"""2025-06-20 18:00 UTC: about noon at the demo's field."""


@pytest.fixture
def noon() -> SunSettings:
    return SunSettings(LatLon(41.9012, -93.6034), NOON_UTC_S)


@pytest.fixture
def ground() -> tuple[np.ndarray, np.ndarray]:
    """East and north metres (90, 160) of a field's surroundings."""
    return np.meshgrid(np.linspace(-2000.0, 2000.0, 160), np.linspace(1000.0, -1000.0, 90))
