"""One ground image from the newest of each imaging drone: all are on the site's grid."""

from collections.abc import Sequence

from recon.model.imagery import GroundImage, Registration
from recon.model.replacing import replace
from recon.model.units import seconds_to_ns
from recon.station.state.imaging import TOGETHER_WITHIN_S, Imaging

WORST_FIRST = (Registration.LOST, Registration.UNREGISTERED, Registration.REGISTERED)


def newest_images(imaging: Imaging) -> tuple[GroundImage, ...]:
    """Return each imaging drone's newest ground image, the newest first, without those excluded."""
    every = (each.ground_image for each in imaging.imagers.values())
    known = sorted((image for image in every if image is not None), key=_captured_ns, reverse=True)
    return tuple(
        image
        for image in known
        if known[0].captured_at_ns - image.captured_at_ns <= seconds_to_ns(TOGETHER_WITHIN_S)
    )


def mosaic(images: Sequence[GroundImage]) -> GroundImage | None:
    """Return one image of several on one grid, the first on top; None of none."""
    if len(images) < 2:
        return images[0] if images else None
    rgb, valid = images[0].rgb.copy(), images[0].valid.copy()
    for image in images[1:]:
        added = image.valid & ~valid
        rgb[added] = image.rgb[added]
        valid |= added
    return replace(alignment_of(images), rgb=rgb, valid=valid)


def alignment_of(images: Sequence[GroundImage]) -> GroundImage:
    """Return the first image, but as old as the oldest of them, and aligned as badly as the worst.

    Exposure is locked if all are.
    """
    residuals_m = [each.registration_residual_m for each in images]
    return replace(
        images[0],
        captured_at_ns=min(map(_captured_ns, images)),
        registration=min((each.registration for each in images), key=WORST_FIRST.index),
        registration_residual_m=max((r for r in residuals_m if r is not None), default=None),
        exposure_locked=all(each.exposure_locked for each in images),
    )


def _captured_ns(image: GroundImage) -> int:
    return image.captured_at_ns
