"""Registration against the truth: how far ground images are displaced, on rendered and real frames.

    RECON_DATA=... python -m studies.registration --seeds 0-2 --frames 30

Figures are of the ground within 195 m of the point below the camera: displacement of each frame's
ground image against that of the reference frame, median and 95th percentile, with registration and
by telemetry alone; the share of frames registered; processor time of a frame on one core. Frames
come every 5 s. Rows of real fields need RECON_DATA.
"""

import argparse
import os
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path
from time import process_time

import cv2
import numpy as np
from tests.camera.registered_scenes import displacements_m
from tests.real_footage.footage import FootageSettings, footage
from tests.real_footage.places import PLACES, load_place

from recon.camera import TelemetryReference, decode_frame, decode_jpeg, mounted_pose
from recon.camera.registration import (
    LensView,
    RegistrationSettings,
    RegistrationState,
    step,
    view_of,
)
from recon.model.imagery import CameraPose, Registration, RgbImage
from recon.sim.camera import CameraSettings, HoverSettings
from recon.sim.camera.field import FieldRenderer
from recon.sim.camera.frames import CameraView
from recon.sim.world import LayerSettings, Sky, SkySettings
from recon.site import demo_site_folder, load_site

PERIOD_S = 5.0
WOBBLE_DEG, DRIFT_M = 1.5, 4.0
WOBBLE = HoverSettings(wobble_deg=WOBBLE_DEG, drift_m=DRIFT_M)
QUALITY = 85
COLS = 1280

Frames = Iterator[tuple[float, RgbImage, CameraPose, CameraPose]]
"""Time, pixels, the pose by telemetry, the true pose."""


@dataclass(slots=True)
class Row:
    """The figures of one kind of frames over all seeds."""

    name: str
    registered_m: list[np.ndarray] = field(default_factory=list)
    telemetry_m: list[np.ndarray] = field(default_factory=list)
    milliseconds: list[float] = field(default_factory=list)
    registered: int = 0

    def add(self, view: LensView, frames: Frames) -> None:
        """Register the frames of one flight."""
        state = RegistrationState()
        start: tuple[CameraPose, CameraPose] | None = None
        for time_s, rgb, prior, true in frames:
            begun_s = process_time()
            state, found = step(view, state, rgb, prior, time_s)
            spent_s = process_time() - begun_s
            if start is not None:
                self.milliseconds.append(1e3 * spent_s)
                self.registered += found.registration is Registration.REGISTERED
                self.registered_m.append(displacements_m(found.pose, true, *start))
                self.telemetry_m.append(displacements_m(prior, true, *start))
            elif state.references:
                start = found.pose, true

    def __str__(self) -> str:
        found, plain = np.stack(self.registered_m), np.stack(self.telemetry_m)
        return (
            f"| {self.name} | {np.median(found):.2f} / {np.percentile(found, 95):.2f} "
            f"| {np.median(plain):.1f} / {np.percentile(plain, 95):.1f} "
            f"| {self.registered} of {len(found)} "
            f"| {np.median(self.milliseconds):.0f} / {np.percentile(self.milliseconds, 95):.0f} |"
        )


def rendered(seed: int, hover: HoverSettings, cover: float, count: int) -> tuple[LensView, Frames]:
    """Return frames of the simulated imaging drone, as JPEG."""
    imager = load_site(demo_site_folder()).imager
    assert imager is not None
    layers = (LayerSettings(cover=cover, outer_scale_m=3_000.0, softness=0.2),) if cover else ()
    sky = Sky(SkySettings(seed, layers=layers))
    settings = CameraSettings(seed, hover=hover)
    renderer = FieldRenderer(imager.camera, imager.image_circle, seed, sky, settings)
    prior = mounted_pose(TelemetryReference(0.0, 0.0, 120.0, 20.0), np.array([0.0, 0.0, 120.0]))

    def frames() -> Frames:
        for number in range(count):
            view = CameraView(PERIOD_S * number, number, prior)
            bgr = np.ascontiguousarray(renderer.render(view)[:, :, ::-1])
            _, jpeg = cv2.imencode(".jpg", bgr, [cv2.IMWRITE_JPEG_QUALITY, QUALITY])
            yield view.elapsed_s, decode_jpeg(jpeg.tobytes()), prior, renderer.true_pose(view)

    return view_of(imager.camera, imager.image_circle, RegistrationSettings()), frames()


def real(seed: int, name: str, is_wobbling: bool, count: int) -> tuple[LensView, Frames]:
    """Return frames made of a real one: moving shade, exposure, noise, JPEG."""
    place = load_place(Path(os.environ["RECON_DATA"]) / "fisheye", name, COLS)
    settings = FootageSettings(
        seed=seed,
        period_s=PERIOD_S,
        wobble_deg=WOBBLE_DEG if is_wobbling else 0.12,
        drift_m=DRIFT_M if is_wobbling else 0.5,
        exposure_follows=0.7,
        white_balance=0.03,
        jpeg_quality=QUALITY,
    )
    frames = (
        (made.time_s, decode_frame(made.frame), made.believed_pose, made.true_pose)
        for made in footage(place, settings, count)
    )
    return view_of(place.camera, place.circle, RegistrationSettings()), frames


def rows(seeds: range, count: int, only: str) -> Iterator[Row]:
    """Yield the rows of the table whose names contain `only`."""
    for name, hover, cover in (
        ("rendered, hover, clear", HoverSettings(), 0.0),
        ("rendered, hover, clouds over 40 %", HoverSettings(), 0.4),
        ("rendered, wobble, clouds over 60 %", WOBBLE, 0.6),
    ):
        row = Row(name)
        for seed in seeds if only in name else ():
            row.add(*rendered(seed, hover, cover, count))
        yield row
    for place in PLACES if "RECON_DATA" in os.environ else ():
        for is_wobbling in (False, True):
            row = Row(f"{place}, {'wobble' if is_wobbling else 'hover'}, clouds over 40 %")
            for seed in seeds if only in row.name else ():
                row.add(*real(seed, place, is_wobbling, count))
            yield row


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description="Measure registration against the truth.")
    parser.add_argument("--seeds", default="0-2", help="first and last, as 0-2")
    parser.add_argument("--frames", type=int, default=30, help="of each flight")
    parser.add_argument("--only", default="", help="rows whose name contains this")
    asked = parser.parse_args()
    first, last = (int(part) for part in asked.seeds.split("-"))
    cv2.setNumThreads(1)
    print("| frames | registered, m | telemetry, m | registered | ms a frame, median / p95 |")
    print("|---|---|---|---|---|")
    for row in rows(range(first, last + 1), asked.frames, asked.only):
        if row.registered_m:
            print(row, flush=True)


if __name__ == "__main__":
    main()
