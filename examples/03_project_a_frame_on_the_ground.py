"""Project a fisheye frame onto the ground: the demo site's lens and pose, a chessboard image.

Run: uv run python examples/03_project_a_frame_on_the_ground.py [OUTPUT.tif]
"""

import sys
from pathlib import Path

import numpy as np

from recon.camera.ground import GroundProjector
from recon.model.imagery import Frame
from recon.record.raster.geotiff import write_ground_image
from recon.site import demo_site_folder, load_site


def main() -> None:
    """Project one frame onto the demo site's grid and print how much of it is covered."""
    site = load_site(demo_site_folder())
    assert site.imager is not None
    assert site.ground_grid is not None
    solution = site.imager.solution
    print(
        f"pose: {solution.rms_px:.2f} px rms, {solution.height_above_ground_m:.1f} m above ground"
    )

    rows, cols = site.imager.camera.rows, site.imager.camera.cols
    row, col = np.mgrid[0:rows, 0:cols]
    board = np.where((row // 40 + col // 40) % 2, 230, 40).astype(np.uint8)
    frame = Frame(1, site.imager.serial, 0, 0, 0.0, rgb=np.repeat(board[..., None], 3, axis=2))

    projector = GroundProjector(site.ground_grid, site.imager.camera, site.imager.image_circle)
    image = projector.project(frame, solution.pose)
    print(f"ground image: {image.rgb.shape}, {image.valid.mean():.0%} of the grid covered")
    if len(sys.argv) > 1:
        write_ground_image(Path(sys.argv[1]), image)
        print(f"written to {sys.argv[1]}")


if __name__ == "__main__":
    main()
