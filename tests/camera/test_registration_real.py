"""Registration on the real frames: relit with moving shade, wobbling, exposed, as JPEG."""

from pathlib import Path

import numpy as np
import pytest
from tests.camera.registered_scenes import displacements_m
from tests.examples import family
from tests.real_footage.footage import FootageSettings, footage
from tests.real_footage.places import PLACES, load_place

from recon.camera import decode_frame
from recon.camera.registration import RegistrationSettings, RegistrationState, step, view_of
from recon.model.imagery import CameraPose, Registration

FRAMES = 8
HOVER = FootageSettings(seed=3, exposure_follows=0.7, white_balance=0.03, jpeg_quality=80)
WOBBLE = FootageSettings(
    seed=3,
    wobble_deg=1.5,
    drift_m=4.0,
    exposure_follows=0.7,
    white_balance=0.03,
    jpeg_quality=80,
)


@pytest.mark.parametrize("settings", [HOVER, WOBBLE], ids=["hover", "wobble"])
@pytest.mark.parametrize("name", family(*PLACES))
def test_a_real_field_stays_in_place(
    name: str, settings: FootageSettings, fisheye_data: Path
) -> None:
    place = load_place(fisheye_data, name)
    view = view_of(place.camera, place.circle, RegistrationSettings())
    state, off_m = RegistrationState(), []
    start: tuple[CameraPose, CameraPose] | None = None
    for made in footage(place, settings, FRAMES):
        rgb = decode_frame(made.frame)
        state, found = step(view, state, rgb, made.believed_pose, made.time_s)
        if start is not None:
            assert found.registration is Registration.REGISTERED
            off_m.append(displacements_m(found.pose, made.true_pose, *start))
        elif state.references:
            start = found.pose, made.true_pose
    assert len(off_m) == FRAMES - 2
    assert np.median(off_m) < 0.5
    assert np.percentile(off_m, 95) < 1.5
