"""Speed of rendering the imaging drone's frames: 1280 x 720 at 5 fps or more on one core.

The baseline is the least any renderer of this kind does: two float maps and one remap of as many
pixels, and a Gaussian random number for each value. Times are the processor's. Run:
uv run python -m pytest benches/sim -s
"""

from time import process_time

import cv2
import numpy as np
import pytest

from recon.camera import TelemetryReference, mounted_pose
from recon.sim.camera.field import FieldRenderer
from recon.sim.camera.frames import CameraView
from recon.sim.land.farmland import lay_out
from recon.sim.land.land_tiles import CELLS_M, LandTiles
from recon.sim.world import LayerSettings, Sky, SkySettings
from recon.site import demo_site_folder, load_site

BUDGET_S = 0.2
MOST_BASELINES = 8.0
LOOKS = 25
LOW = LayerSettings(cover=0.4)
HIGH = LayerSettings(4_000.0, 14.0, 110.0, 0.3)


@pytest.fixture(autouse=True)
def one_core():
    threads = cv2.getNumThreads()
    cv2.setNumThreads(1)
    yield
    cv2.setNumThreads(threads)


@pytest.mark.parametrize("height_m", [60.0, 120.0, 400.0])
def test_a_hovering_imager(height_m: float) -> None:
    imager = load_site(demo_site_folder()).imager
    assert imager is not None
    sky = Sky(SkySettings(3, layers=(LOW, HIGH)))
    frames = FieldRenderer(imager.camera, imager.image_circle, 0, sky)
    pose = mounted_pose(
        TelemetryReference(0.0, 0.0, height_m, 20.0), np.array([0.0, 0.0, height_m])
    )
    frames.prepare()
    frames.render(CameraView(0.0, 0, pose))
    found_s = [
        _seconds(lambda number=number: frames.render(CameraView(0.2 * number, number, pose)))
        for number in range(1, LOOKS)
    ]
    rows, cols = frames.lens.window
    baseline_s = _baseline_s(rows.stop - rows.start, cols.stop - cols.start)
    middle_s = float(np.median(found_s))
    print(
        f"\nfrom {height_m:.0f} m: {1e3 * middle_s:.0f} ms, {1.0 / middle_s:.0f} pictures a second"
        f" (5 asked for); the slowest {1e3 * max(found_s):.0f} ms;"
        f" {middle_s / baseline_s:.1f} times the baseline of {1e3 * baseline_s:.0f} ms"
    )
    assert middle_s < BUDGET_S
    assert middle_s < MOST_BASELINES * baseline_s


def test_new_land() -> None:
    """Moving one square of tiles by a tile: the delay of a frame when the imaging drone flies."""
    tiles, sun = LandTiles(lay_out(0), 0), Sky(SkySettings()).sun_at(0.0)
    tile_m = CELLS_M[0] * 256
    for step in range(2):
        tiles.square(0, tile_m * step, 0.0, sun)
    waits_s = [
        _seconds(lambda step=step: tiles.square(0, tile_m * step, 0.0, sun))
        for step in range(2, 10)
    ]
    print(
        f"\na new row of six tiles, every {tile_m:.0f} m: {1e3 * float(np.median(waits_s)):.0f} ms"
    )
    assert np.median(waits_s) < BUDGET_S


def _seconds(work) -> float:
    began_s = process_time()
    work()
    return process_time() - began_s


def _baseline_s(rows: int, cols: int) -> float:
    random = np.random.default_rng(0)
    land = random.integers(0, 255, (1536, 1536, 4), dtype=np.uint8)
    east, north = np.meshgrid(
        np.linspace(0, 1500, cols, dtype=np.float32), np.linspace(0, 1500, rows, dtype=np.float32)
    )

    def work() -> None:
        cv2.remap(land, east, north, cv2.INTER_LINEAR)
        random.standard_normal((3, rows, cols), dtype=np.float32)

    return min(_seconds(work) for _ in range(10))
