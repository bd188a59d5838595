"""Draws frames of the simulated imaging drone, for docs/world.md.

    python -m studies.imager_pictures docs/images/imager.jpg

From the left: few clouds from 60 m over a farm, broken clouds from 120 m, many clouds from 400 m.
"""

import argparse
from pathlib import Path

import cv2
import numpy as np

from recon.camera import TelemetryReference, mounted_pose
from recon.sim.camera.field import FieldRenderer
from recon.sim.camera.frames import CameraView
from recon.sim.world import LayerSettings, Sky, SkySettings
from recon.site import demo_site_folder, load_site

SEED = 0
SIDE_PX = 460
QUALITY = 80
SHOTS = (
    (60.0, 150.0, 60.0, 0.1, 60.0),
    (120.0, 20.0, 30.0, 0.4, 100.0),
    (400.0, 0.0, 0.0, 0.5, 100.0),
)
"""Height, east and north in metres, cover, time in seconds."""


def shot(height_m: float, east_m: float, north_m: float, cover: float, time_s: float) -> np.ndarray:
    """Return one picture's square around the image circle, small."""
    imager = load_site(demo_site_folder()).imager
    assert imager is not None
    clouds = LayerSettings(cover=cover, outer_scale_m=2_500.0, softness=0.15)
    frames = FieldRenderer(
        imager.camera, imager.image_circle, SEED, Sky(SkySettings(SEED, layers=(clouds,)))
    )
    reference = TelemetryReference(0.0, 0.0, height_m, 15.0)
    pose = mounted_pose(reference, np.array([east_m, north_m, height_m]))
    picture = frames.render(CameraView(time_s, 0, pose))[frames.lens.window]
    return cv2.resize(picture, (SIDE_PX, SIDE_PX), interpolation=cv2.INTER_AREA)


def main() -> None:
    """Write the picture."""
    parser = argparse.ArgumentParser(description="Draw frames of the simulated imaging drone.")
    parser.add_argument("file", type=Path)
    whole = np.hstack([shot(*at) for at in SHOTS])
    is_written, data = cv2.imencode(".jpg", whole[:, :, ::-1], [cv2.IMWRITE_JPEG_QUALITY, QUALITY])
    if not is_written:
        raise SystemExit("expected a picture that JPEG can hold")
    parser.parse_args().file.write_bytes(data.tobytes())


if __name__ == "__main__":
    main()
