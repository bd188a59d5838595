"""A JPEG's markers up to its first scan, and whether its data has its end (ISO/IEC 10918-1, annex
B)."""

START_OF_IMAGE, END_OF_IMAGE = b"\xff\xd8", b"\xff\xd9"
FILL, START_OF_SCAN = 0xFF, 0xDA
ALONE = frozenset((0x00, 0x01, *range(0xD0, 0xD9)))
"""Markers without a length: TEM, restarts, a start of image inside the image; 00 is no marker, but
decoders pass over it."""


def whole_jpeg(data: bytes) -> bytes | None:
    """Return a JPEG that any reader takes, the same bytes where nothing is odd; None for one that
    ends before its image does.

    Any number of fill bytes FF may stand before a marker. Previews inside EXIF do not count; what
    follows the image, as further pictures do, may be cut. Damage is not looked for.
    """
    at, odd = 2, list[tuple[int, int]]()
    while True:
        # Bytes that belong nowhere are passed over, as decoders do.
        begin = at = data.find(b"\xff", at)
        if at < 0:
            return None
        while at < len(data) and data[at] == FILL:
            at += 1
        if at + 3 > len(data):
            return None
        marker = data[at]
        if marker == START_OF_SCAN:
            # Whatever follows the image begins after its end: to look from the end is as good.
            if data.rfind(END_OF_IMAGE, at) < 0:
                return None
            break
        if marker in ALONE:
            at += 1
            odd.append((begin, at))
        else:
            at += 1 + int.from_bytes(data[at + 1 : at + 3])
    return _without(data, odd)


def _without(data: bytes, parts: list[tuple[int, int]]) -> bytes:
    """Return data without some parts, given in their order."""
    for begin, end in reversed(parts):
        data = data[:begin] + data[end:]
    return data
