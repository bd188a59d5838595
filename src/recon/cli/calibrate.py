"""`recon calibrate`: fit a lens to photos of a chessboard and show how well it fits."""

import sys
from pathlib import Path
from typing import Annotated

import numpy as np
import typer

from recon.camera import CalibrationError, ImageCircle, find_image_circle, format_camera
from recon.camera.calibration import (
    BoardPhoto,
    Chessboard,
    Coverage,
    LensCalibration,
    calibrate_lens,
    coverage_of,
    find_corners,
    residual_picture,
    warnings_of,
)
from recon.camera.photo_files import photo_size, read_photo
from recon.cli.output import print_line, print_table, printable
from recon.cli.picture import png_of
from recon.cli.progress import progress_over
from recon.model.errors import RecordError
from recon.record.files.atomic_file import replace_file

MOST_PHOTOS = 200
CIRCLE_PHOTOS = 5
"""Photos in which the image circle is looked for."""
FILE_MODE = 0o644

PhotosArgument = Annotated[
    list[Path], typer.Argument(metavar="PHOTO...", help="Photos of one flat chessboard.")
]
RowsOption = Annotated[
    int, typer.Option(help="Rows of inner corners: one fewer than rows of squares.")
]
ColsOption = Annotated[int, typer.Option(help="Columns of inner corners.")]
SquareOption = Annotated[float, typer.Option("--square-mm", help="Side of a square, in mm.")]
OutOption = Annotated[Path, typer.Option(help="File of the lens to write.")]
PictureOption = Annotated[
    Path | None,
    typer.Option(help="PNG of the residuals; default: beside the lens's file."),
]


def calibrate_command(
    photos: PhotosArgument,
    rows: RowsOption,
    cols: ColsOption,
    square_mm: SquareOption,
    out: OutOption = Path("camera-model.txt"),
    picture: PictureOption = None,
) -> None:
    """Fit a lens to photos of a chessboard, for `camera-model.txt` of a site."""
    board = Chessboard(rows, cols, square_mm)
    size = _common_size(photos)
    seen = _boards(photos, board)
    calibration = calibrate_lens(board, seen, *size)
    circle = _image_circle(photos, calibration)
    coverage = coverage_of(calibration, circle)
    _write(out, format_camera(calibration.camera).encode())
    drawn = picture or out.with_suffix(".png")
    _write(drawn, png_of(residual_picture(calibration, coverage, circle)))
    _print_residuals(calibration)
    _print_summary(calibration, coverage, circle)
    print_line(f"wrote {out} and {drawn}")


def _common_size(photos: list[Path]) -> tuple[int, int]:
    """Return (rows, cols) of all photos, by their headers, before any work is done."""
    if len(photos) > MOST_PHOTOS:
        raise CalibrationError(f"expected at most {MOST_PHOTOS} photos, got {len(photos)}")
    first = photo_size(photos[0])
    for photo in photos[1:]:
        size = photo_size(photo)
        if size != first:
            raise CalibrationError(
                f"{photo}: expected {first[1]} x {first[0]} pixels as in {photos[0]}, got "
                f"{size[1]} x {size[0]}; photos of one lens at one setting are needed"
            )
    return first


def _boards(photos: list[Path], board: Chessboard) -> list[BoardPhoto]:
    """Return the photos that show the whole board; the others are listed."""
    seen, missing = [], []
    for photo in progress_over(photos, "looking for the chessboard", len(photos)):
        corners = find_corners(read_photo(photo), board)
        if corners is None:
            missing.append(photo)
        else:
            seen.append(BoardPhoto(photo.name, corners))
    for photo in missing:
        print(f"{printable(str(photo))}: no whole chessboard found, skipped", file=sys.stderr)
    if not seen:
        raise CalibrationError(
            f"expected a chessboard with {board.rows} x {board.cols} inner corners in the photos, "
            f"got none in {len(photos)}; --rows and --cols count the points where four squares "
            "meet, one fewer than the squares"
        )
    return seen


def _image_circle(photos: list[Path], calibration: LensCalibration) -> ImageCircle | None:
    """Return the median of the circles found in the first photos, None without one."""
    found = [find_image_circle(read_photo(p), calibration.camera) for p in photos[:CIRCLE_PHOTOS]]
    circles = [(c.centre_col_px, c.centre_row_px, c.radius_px) for c in found if c is not None]
    if not circles:
        return None
    return ImageCircle(*(float(value) for value in np.median(circles, axis=0)))


def _print_residuals(calibration: LensCalibration) -> None:
    table = [
        (
            photo.name,
            f"{photo.rms_px:.2f}",
            f"{np.linalg.norm(photo.residuals_px, axis=1).max():.2f}",
            f"{photo.is_used.sum()} of {len(photo.is_used)}" if photo.is_used.any() else "excluded",
        )
        for photo in calibration.photos
    ]
    print_table("residuals", ("photo", "rms px", "largest px", "corners used"), table)


def _print_summary(
    calibration: LensCalibration, coverage: Coverage, circle: ImageCircle | None
) -> None:
    camera = calibration.camera
    print_line(
        f"overall: rms {calibration.rms_px:.3f} px over {len(calibration.corners_used)} corners"
    )
    print_line(
        f"centre: column {camera.centre_col_px:.1f}, row {camera.centre_row_px:.1f} "
        f"(standard deviation {calibration.centre_sigma_px:.2f} px); focal length "
        f"{-camera.direct[0]:.1f} px ({calibration.focal_sigma_share:.2%})"
    )
    view = "frame: no image circle found" if circle is None else "image circle"
    print_line(
        f"coverage: {coverage.share:.0%} of the {view}, out to {coverage.reach_deg:.0f} of "
        f"{coverage.field_deg:.0f} degrees from the axis"
    )
    if circle is not None:
        print_line(
            f"image circle: col_px = {circle.centre_col_px:.1f}, row_px = "
            f"{circle.centre_row_px:.1f}, radius_px = {circle.radius_px:.1f}"
        )
    for warning in warnings_of(calibration, coverage):
        print_line(f"warning: {warning}")


def _write(path: Path, data: bytes) -> None:
    try:
        replace_file(path, data, FILE_MODE)
    except OSError as problem:
        raise RecordError(
            f"{path}: expected to write {len(data)} bytes, got: {problem.strerror or problem}"
        ) from problem
