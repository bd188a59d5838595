"""Whether a TIFF holds all of its first picture."""

from typing import Any

from recon.product.photos.photo_error import PhotoError

SIGNATURES = (b"II*\0", b"MM\0*", b"II+\0", b"MM\0+")
"""First bytes of a TIFF, and of one beyond 4 GB."""
PLACES = ((273, 279), (324, 325))
"""Tags with the places and sizes of strips, and of tiles."""


def refuse_cut_off(image: Any, size: int) -> None:
    """Raise `PhotoError` for an open TIFF of `size` bytes whose picture lies partly behind them."""
    tags = image.tag_v2
    for places, sizes in PLACES:
        if places in tags:
            ends = zip(_numbers(tags[places]), _numbers(tags.get(sizes, 0)), strict=False)
            if any(begin + length > size for begin, length in ends):
                raise PhotoError("the file is cut off: copy it from the card again")


def _numbers(value: Any) -> tuple[int, ...]:
    return value if isinstance(value, tuple) else (value,)
