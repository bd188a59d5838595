"""Scores shade methods on footage of the three real places under moving shade.

    python -m studies.real_footage --frames 120 --auto-exposure

RECON_DATA names the folder of the real frames. They are relit with drawn clouds
(`tests/real_footage`), so the truth is known. Frames are projected on the ground by their true
poses, or with --telemetry by the pose that telemetry gives. Prints for each place and method the
figures of docs/score.md over the ground that the lens shows, from 30 s on.
"""

import argparse
import os
from pathlib import Path

import numpy as np
from tests.real_footage.footage import FootageSettings, footage, ground_images
from tests.real_footage.places import PLACES, load_place

from recon.detection import DETECTORS, DetectionSettings, DetectionState
from recon.geo import nearest_cells
from recon.model.imagery import GroundImage
from recon.model.shade import ShadeMap
from recon.score.shade_figures import ShadeFigures, map_figures

BEGIN_S = 30.0
"""No method knows anything before it has seen the ground for a while."""
HEAD = f"{'place':<16}{'method':<20}{'IoU':>6}{'p10':>6}{'false':>7}{'missed':>7}{'wrong':>7}"
HEAD += f"{'unknown':>8}{'light':>7}{'edge m':>8}"


def figures(
    folder: Path,
    place_name: str,
    method: str,
    settings: FootageSettings,
    options: argparse.Namespace,
) -> ShadeFigures:
    """Return a method's figures over the footage of one place."""
    place = load_place(folder, place_name, options.cols)
    made = footage(place, settings, options.frames)
    grid = place.grid()
    detect, state, total = DETECTORS[method], DetectionState(), ShadeFigures()
    latest: ShadeMap | None = None
    for image, frame in ground_images(place, made, grid, is_pose_true=not options.telemetry):
        state, found = detect(state, image, DetectionSettings())
        if isinstance(found, ShadeMap):
            latest = found
        if latest is not None and frame.time_s >= BEGIN_S:
            total += _scored(latest, image, frame.transmittance(latest.grid))
    return total


def _scored(shade: ShadeMap, image: GroundImage, truth: np.ndarray) -> ShadeFigures:
    """The figures of a map over the cells whose middles the image shows."""
    rows, cols, _ = nearest_cells(image.grid, shade.grid)
    counted = image.valid[rows, cols]
    return map_figures(shade.transmittance, shade.valid, truth, counted, shade.grid.cell_m)


def _line(place: str, method: str, found: ShadeFigures) -> str:
    def share(part: int, of: int) -> str:
        return f"{100.0 * part / of:.1f}" if of else "-"

    worst = f"{np.quantile(found.mixed_ious, 0.1):.2f}" if found.mixed_ious else "-"
    overlap = "-" if found.iou is None else f"{found.iou:.2f}"
    light = f"{found.transmittance_error / found.known:.2f}" if found.known else "-"
    edge = "-" if found.edges.mean_m is None else f"{found.edges.mean_m:.1f}"
    return (
        f"{place:<16}{method:<20}{overlap:>6}{worst:>6}"
        f"{share(found.false, found.cells - found.shaded):>7}"
        f"{share(found.missed, found.shaded):>7}{share(found.wrong, found.cells):>7}"
        f"{share(found.unknown, found.cells):>8}{light:>7}{edge:>8}"
    )


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description="Shade methods on real ground.")
    parser.add_argument("--frames", type=int, default=120, help="one every 5 s")
    parser.add_argument("--seeds", type=int, nargs="+", default=[0])
    parser.add_argument("--cover", type=float, default=0.4)
    parser.add_argument("--cols", type=int, default=640, help="columns of the frames")
    parser.add_argument("--methods", nargs="+", default=list(DETECTORS), choices=list(DETECTORS))
    parser.add_argument("--auto-exposure", action="store_true")
    parser.add_argument(
        "--telemetry", action="store_true", help="project frames by telemetry's pose"
    )
    options = parser.parse_args()
    folder = Path(os.environ["RECON_DATA"]) / "fisheye"
    print(HEAD, flush=True)
    for place in PLACES:
        for method in options.methods:
            total = ShadeFigures()
            for seed in options.seeds:
                settings = FootageSettings(
                    seed=seed,
                    cover=options.cover,
                    exposure_follows=0.7 if options.auto_exposure else 0.0,
                    white_balance=0.03 if options.auto_exposure else 0.0,
                )
                total += figures(folder, place, method, settings, options)
            print(_line(place, method, total), flush=True)


if __name__ == "__main__":
    main()
