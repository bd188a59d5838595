"""QR codes on the terminal, for the cameras of tablets."""

import io
import sys

HALF_BLOCKS = " ▀▄█"


def qr_lines(text: str, is_terminal: bool | None = None) -> list[str]:
    """Return the lines of a QR code, none where no camera could read it: not on a terminal, or in
    an encoding without its characters."""
    if not (sys.stdout.isatty() if is_terminal is None else is_terminal):
        return []
    import segno

    try:
        HALF_BLOCKS.encode(sys.stdout.encoding or "ascii")
    except UnicodeEncodeError:
        return []
    drawn = io.StringIO()
    segno.make(text, error="l", micro=False).terminal(drawn, compact=True, border=2)
    return drawn.getvalue().splitlines()
