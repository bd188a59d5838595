"""Print statistics of rendered frames beside those of real frames.

    RECON_DATA=FOLDER python -m studies.frame_statistics --seeds 3

Levels are percentiles of green; blue over red is the rim's (58 to 64 degrees off axis) over the
middle's (0 to 20), in light by the display curve. Without RECON_DATA only rendered frames.
"""

import argparse
import os
from collections.abc import Iterator
from pathlib import Path

import cv2
import numpy as np

from recon.camera import OmnidirectionalCamera, decode_jpeg, load_camera
from recon.model.imagery import RgbImage
from recon.score import load_scenario
from recon.score.simulation import simulation_of
from recon.sim.camera.field import FieldRenderer
from recon.sim.camera.frames import CameraView
from recon.sim.camera.tone import light_of_value
from recon.sim.fleet import IMAGER_SERIAL

PLACES = ("becker-1", "elgin-5", "grand-meadow-7")
ROWS, COLS = 720, 1280
AT_S = 120.0
FIELD_DEG = 64.0


def off_axis_deg(camera: OmnidirectionalCamera) -> np.ndarray:
    """Return the angle of each pixel from the lens's axis, (ROWS, COLS)."""
    pixels = np.stack(np.meshgrid(np.arange(COLS), np.arange(ROWS)), axis=-1).reshape(-1, 2)
    along = camera.unproject(pixels.astype(float))[:, 2]
    return np.degrees(np.arccos(np.clip(along, -1.0, 1.0))).reshape(ROWS, COLS)


def row(name: str, rgb: RgbImage, angles_deg: np.ndarray) -> str:
    """Return one line of the table."""
    levels = np.percentile(rgb[angles_deg < FIELD_DEG, 1], (1, 50, 99))
    light = np.maximum(light_of_value()[rgb], 1e-4)
    bluer = light[:, :, 2] / light[:, :, 0]
    rim = np.median(bluer[(angles_deg > 58.0) & (angles_deg < FIELD_DEG)])
    middle = np.median(bluer[angles_deg < 20.0])
    return f"| {name} | {' | '.join(f'{level:.0f}' for level in levels)} | {rim / middle:.2f} |"


def real_rows(folder: Path) -> Iterator[str]:
    """Yield the lines of the real frames."""
    angles_deg = off_axis_deg(load_camera(folder / "camera-model.txt"))
    for place in PLACES:
        rgb = decode_jpeg((folder / place / "RefFrame.jpeg").read_bytes())
        small = cv2.resize(rgb, (COLS, ROWS), interpolation=cv2.INTER_AREA).astype(np.uint8)
        yield row(place, small, angles_deg)


def rendered_rows(path: Path, seeds: int) -> Iterator[str]:
    """Yield the lines of a scenario's frames."""
    scenario = load_scenario(path)
    for seed in range(seeds):
        imager = simulation_of(scenario, seed).imagers[IMAGER_SERIAL]
        assert imager is not None
        assert imager.rig is not None
        renderer = imager.source
        assert isinstance(renderer, FieldRenderer)
        rgb = renderer.render(CameraView(AT_S, 0, imager.rig.marked_pose))
        yield row(f"seed {seed}", rgb, off_axis_deg(renderer.camera))


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description="Print statistics of frames.")
    parser.add_argument("--scenario", type=Path, default=Path("scenarios/cumulus-40.toml"))
    parser.add_argument("--seeds", type=int, default=3)
    options = parser.parse_args()
    print(
        "| frame | green 1 % | 50 % | 99 % | blue over red, rim / middle |\n|---|---|---|---|---|"
    )
    if "RECON_DATA" in os.environ:
        for line in real_rows(Path(os.environ["RECON_DATA"]) / "fisheye"):
            print(line)
    for line in rendered_rows(options.scenario, options.seeds):
        print(line, flush=True)


if __name__ == "__main__":
    main()
