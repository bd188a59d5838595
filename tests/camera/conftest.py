"""The lens that the camera's tests look through."""

import pytest
from tools.demo_site import demo_camera

from recon.camera import OmnidirectionalCamera


@pytest.fixture(scope="session")
def camera() -> OmnidirectionalCamera:
    """A made-up lens of 170 degrees, 1280 x 720, with its centre and affine off the ideal."""
    return demo_camera()
