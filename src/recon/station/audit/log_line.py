"""The lines that a running station prints, in colour on a terminal."""

import re
import sys
from datetime import datetime

DIM, BOLD, GREEN, YELLOW, MAGENTA = (f"\033[{code}m" for code in (2, 1, 32, 33, 35))
RESET = "\033[0m"
EVENT_WIDTH = 30
_NEEDS_QUOTES = re.compile(r"[\s=\"']")


def print_info(text: str, by: str | None = None) -> None:
    """Print what happened."""
    _print("info", GREEN, text, by)


def print_warning(text: str, by: str | None = None) -> None:
    """Print what a person should look at."""
    _print("warning", YELLOW, text, by)


def _print(level: str, colour: str, text: str, by: str | None) -> None:
    parts = [(DIM, f"{datetime.now():%Y-%m-%d %H:%M:%S}"), (colour, f"[{level:<9}]")]
    if by is None:
        parts.append((BOLD, text))
    else:
        shown = repr(by) if _NEEDS_QUOTES.search(by) else by
        parts += [(BOLD, f"{text:<{EVENT_WIDTH}}"), (MAGENTA, f"by={shown}")]
    is_coloured = sys.stdout.isatty()
    words = (f"{part}{word}{RESET}" if is_coloured else word for part, word in parts)
    print(" ".join(words), flush=True)
