"""Whether a JPEG has its end: the markers before its first scan, and the end of its data."""

FILL = 0xFF
START_OF_SCAN, END_OF_IMAGE = 0xDA, b"\xff\xd9"
ALONE = frozenset((0x01, *range(0xD0, 0xD9)))
"""Markers without a length: TEM, restarts, and a start of image inside the image."""


def is_cut_off(data: bytes) -> bool:
    """Return whether a JPEG ends before its image does (ISO/IEC 10918-1, annex B).

    Any number of fill bytes FF may stand before a marker. Previews inside EXIF do not count; what
    follows the image, as further pictures do, may be cut. Damage is not looked for.
    """
    at = 2
    while True:
        if data[at : at + 1] not in (b"", b"\xff"):
            return False
        while at < len(data) and data[at] == FILL:
            at += 1
        if at + 3 > len(data):
            return True
        marker = data[at]
        if marker == START_OF_SCAN:
            # Whatever follows the image begins after its end: to look from the end is as good.
            return data.rfind(END_OF_IMAGE, at) < 0
        at += 1 if marker in ALONE else 1 + int.from_bytes(data[at + 1 : at + 3])
