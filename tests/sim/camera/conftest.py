"""A lens and poses for the tests of the imaging drone's camera."""

from collections.abc import Callable

import numpy as np
import pytest

from recon.camera import (
    ImageCircle,
    OmnidirectionalCamera,
    TelemetryReference,
    load_camera,
    mounted_pose,
)
from recon.model.imagery import CameraPose
from recon.site import demo_site_folder

MakePose = Callable[..., CameraPose]


@pytest.fixture(scope="session")
def camera() -> OmnidirectionalCamera:
    return load_camera(demo_site_folder() / "camera-model.txt")


@pytest.fixture(scope="session")
def circle(camera: OmnidirectionalCamera) -> ImageCircle:
    return ImageCircle(camera.centre_col_px, camera.centre_row_px, 340.0)


@pytest.fixture(scope="session")
def pose() -> MakePose:
    def make(
        height_m: float = 120.0, east_m: float = 0.0, north_m: float = 0.0, yaw_deg: float = 0.0
    ) -> CameraPose:
        reference = TelemetryReference(0.0, 0.0, height_m, yaw_deg)
        return mounted_pose(reference, np.array([east_m, north_m, height_m]))

    return make
