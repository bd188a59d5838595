"""Real frames by $RECON_DATA: without it tests skip, with RECON_DATA_REQUIRED=1 they fail."""

import os
from pathlib import Path

import pytest

from recon.camera import OmnidirectionalCamera
from recon.site.demo_site import demo_camera


@pytest.fixture(scope="session")
def fisheye_data() -> Path:
    """The folder of the real fisheye frames."""
    folder = Path(os.environ.get("RECON_DATA", "")) / "fisheye"
    if "RECON_DATA" in os.environ and (folder / "camera-model.txt").is_file():
        return folder
    reason = f"real frames needed: set RECON_DATA to the folder that holds fisheye/ (now: {folder})"
    if os.environ.get("RECON_DATA_REQUIRED") == "1":
        pytest.fail(reason)
    pytest.skip(reason)


@pytest.fixture(scope="session")
def camera() -> OmnidirectionalCamera:
    """A made-up lens of 170 degrees, 1280 x 720, with its centre and affine off the ideal."""
    return demo_camera()
