"""Detection on real fisheye frames, projected on the ground with their own poses.

There is one frame of each field, so time is simulated: the frame is repositioned with the hover
wander, its sensor noise and exposure are drawn, and a shadow of known shape darkens its pixels.
Everything else, the ground, the lens and the JPEG, is as it was photographed.
"""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from tests.detection.shaded_field import FIELD, DriftingShade, centres
from tests.examples import family

from recon.camera import (
    GroundProjector,
    decode_jpeg,
    load_camera,
    load_control_points,
    pose_from_points,
)
from recon.detection import DETECTORS, DetectionSettings, DetectionState
from recon.geo import enu_from_points
from recon.model.geo import GeoPoint, GroundGrid, LocalFrame
from recon.model.imagery import GroundImage
from recon.model.shade import SUNLIT_TRANSMITTANCE, ShadeMap

FIELDS = ("becker-1", "elgin-5", "grand-meadow-7")
EVERY_S = 5.0
DIFFUSE_SHARES = np.array([0.21, 0.36, 0.50])
"""Shade over sun in red, green and blue, measured on becker-1: shade is bluer than sun."""
WANDER_M = 0.5


def projected(folder: Path, name: str) -> GroundImage:
    """The field's frame on 512 m of ground around its camera."""
    camera = load_camera(folder / "camera-model.txt")
    points = load_control_points(folder / name / "GCPs.txt")
    middle = np.mean([(p.latitude_deg, p.longitude_deg, p.ellipsoid_height_m) for p in points], 0)
    frame = LocalFrame(GeoPoint(*(float(number) for number in middle)))
    enu_m = enu_from_points(frame, [point.place for point in points])
    pose = pose_from_points(camera, points, (3840, 2160), enu_m).pose
    east_m, north_m, _ = (float(metres) for metres in pose.position_enu_m)
    grid = GroundGrid(frame, east_m - 256.0, north_m + 256.0, 1.0, 512, 512)
    rgb = decode_jpeg((folder / name / "RefFrame.jpeg").read_bytes())
    found, valid = GroundProjector(grid, camera).project_pixels(rgb, pose)
    return GroundImage(grid, 1, 0, found, valid, pose, serial="IMAGER")


def under(image: GroundImage, shade: DriftingShade, i: int, seed: int) -> GroundImage:
    """The frame as it would be at a moment, under drawn shade."""
    rng = np.random.default_rng([seed, i])
    around = GroundGrid(FIELD.frame, -256.0, 256.0, 1.0, 512, 512)
    direct = shade.transmittance(around, EVERY_S * i)
    beam = (1.0 - DIFFUSE_SHARES) * direct[..., np.newaxis]
    lit = (DIFFUSE_SHARES + beam) ** (1.0 / 2.2)
    levels = image.rgb * lit + rng.normal(0.0, 2.0, (512, 512, 1))
    wander_m = rng.normal(0.0, WANDER_M, 2)
    grid = replace(
        image.grid,
        west_m=image.grid.west_m + float(wander_m[0]),
        north_m=image.grid.north_m + float(wander_m[1]),
    )
    return replace(
        image,
        grid=grid,
        captured_at_ns=round(EVERY_S * i * 1e9),
        rgb=np.clip(np.rint(levels), 0, 255).astype(np.uint8),
    )


@pytest.mark.parametrize("name", family(*FIELDS))
def test_drawn_shadows_are_found_on_real_ground(fisheye_data: Path, name: str) -> None:
    image = projected(fisheye_data, name)
    settings = DetectionSettings(grid=replace(image.grid, cell_m=4.0, rows=128, cols=128))
    # Near enough that a cell has pixels of its own: 8 pixels of the marked frame across.
    east_m, north_m = centres(FIELD)
    near = np.hypot(east_m, north_m) < 180.0
    wrong: dict[str, list[float]] = {method: [] for method in DETECTORS}
    for seed in (70, 71):
        shade = DriftingShade(seed, cover=0.3)
        states = dict.fromkeys(DETECTORS, DetectionState())
        for i in range(25):
            seen = under(image, shade, i, seed)
            is_shade = shade.transmittance(FIELD, EVERY_S * i) < SUNLIT_TRANSMITTANCE
            for method, step in DETECTORS.items():
                states[method], found = step(states[method], seen, settings)
                assert isinstance(found, ShadeMap), found
                if i >= 18:
                    assert found.valid[near].mean() > 0.9
                    counted = near & found.valid
                    wrong[method].append(float((found.is_sunlit == is_shade)[counted].mean()))
    mean = {method: float(np.mean(shares)) for method, shares in wrong.items()}
    assert mean["sunlit_reference"] < 0.05, mean
    assert mean["brightness_ratio"] < 0.1, mean
    assert mean["brightness_ratio"] < 0.5 * mean["otsu"], mean


@pytest.mark.parametrize("name", FIELDS)
def test_a_real_frame_by_itself_gives_a_sound_map_but_no_shade_by_history(
    fisheye_data: Path, name: str
) -> None:
    image = projected(fisheye_data, name)
    _, by_otsu = DETECTORS["otsu"](DetectionState(), image, DetectionSettings())
    _, by_ratio = DETECTORS["brightness_ratio"](DetectionState(), image, DetectionSettings())
    assert isinstance(by_otsu, ShadeMap)
    assert isinstance(by_ratio, ShadeMap)
    assert by_otsu.valid.mean() > 0.5
    assert 0.02 < by_otsu.is_sunlit[by_otsu.valid].mean() < 0.98
    assert not by_ratio.valid.any()
    finest, coarsest = np.nanmin(by_otsu.metres_per_pixel), np.nanmax(by_otsu.metres_per_pixel)
    assert 0.3 < finest < 0.8
    assert coarsest < 12.0
