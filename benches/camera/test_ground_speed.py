"""Speed of laying a frame on the ground, beside baselines of the same run; the floor asserted.

python -m pytest benches/camera -c benches/pytest.ini
"""

from collections.abc import Callable
from time import perf_counter

import cv2
import numpy as np
import pytest

from recon.camera import GroundProjector, ground_maps
from recon.camera.motion import TelemetryReference, mounted_pose
from recon.camera.omnidirectional import OmnidirectionalCamera
from recon.model.geo import GroundGrid
from recon.model.imagery import CameraPose
from recon.site import demo_site_folder, load_site

ROUNDS = 60
MOST_MS_PER_FRAME = 5.0


def times_ms(*steps: Callable[[int], object]) -> np.ndarray:
    """Milliseconds (steps, rounds); the steps take turns, so that all meet the same noise."""
    taken = np.empty((len(steps), ROUNDS))
    for turn in range(ROUNDS):
        for i, step in enumerate(steps):
            start = perf_counter()
            step(turn)
            taken[i, turn] = (perf_counter() - start) * 1e3
    return taken


def maps_of_every_cell(
    grid: GroundGrid, camera: OmnidirectionalCamera, pose: CameraPose
) -> tuple[np.ndarray, np.ndarray]:
    """The maps as one would first write them: every cell projected automatically."""
    east = grid.west_m + (np.arange(grid.cols) + 0.5) * grid.cell_m
    north = grid.north_m - (np.arange(grid.rows) + 0.5) * grid.cell_m
    points = np.zeros((grid.rows, grid.cols, 3))
    points[..., 0], points[..., 1] = east, north[:, np.newaxis]
    rays = (points - pose.position_enu_m) @ pose.rotation_enu_camera
    pixels = camera.project_beyond_range(rays).astype(np.float32)
    return pixels[..., 0], pixels[..., 1]


def test_a_frame_of_a_hovering_imager_is_projected_in_under_5_ms_on_one_core(
    capsys: pytest.CaptureFixture[str],
) -> None:
    cv2.setNumThreads(1)
    site = load_site(demo_site_folder())
    assert site.imager is not None
    assert site.ground_grid is not None
    grid, camera = site.ground_grid, site.imager.camera
    rgb = np.random.default_rng(1).integers(0, 256, (720, 1280, 3), dtype=np.uint8)
    # A hovering eye is a little elsewhere in every frame, so no map can be used twice.
    poses = [
        mounted_pose(
            TelemetryReference(0.0, 0.0, 120.0, 20.0 + 0.1 * turn),
            np.array([0.02 * turn, -0.01 * turn, 120.0 + 0.005 * turn]),
        )
        for turn in range(ROUNDS)
    ]
    projector = GroundProjector(grid, camera, site.imager.image_circle)
    fixed_maps = ground_maps(grid, camera, poses[0])

    def project(turn: int) -> object:
        return projector.project_pixels(rgb, poses[turn])

    def remap_only(_: int) -> object:
        return cv2.remap(rgb, *fixed_maps, cv2.INTER_LINEAR)

    def project_every_cell(turn: int) -> object:
        return cv2.remap(rgb, *maps_of_every_cell(grid, camera, poses[turn]), cv2.INTER_LINEAR)

    project(0)
    project_every_cell(0)
    projected, bare, naive = times_ms(project, remap_only, project_every_cell)
    with capsys.disabled():
        print(
            f"\nground image {grid.rows}x{grid.cols} from 1280x720, maps and mask included: "
            f"{np.median(projected):.2f} ms a frame (best {projected.min():.2f}); "
            f"{np.median(projected) / np.median(bare):.1f}x a bare cv2.remap "
            f"({np.median(bare):.2f} ms), "
            f"{np.median(naive) / np.median(projected):.1f}x as fast as projecting every cell "
            f"({np.median(naive):.1f} ms)",
            flush=True,
        )
    assert projected.min() < MOST_MS_PER_FRAME
    assert np.median(projected) < np.median(naive) / 4.0
