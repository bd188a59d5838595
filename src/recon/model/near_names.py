"""The hint at a known name for one that is mistyped."""

from collections.abc import Iterable
from difflib import get_close_matches


def did_you_mean(name: str, known: Iterable[str], most: int = 1) -> str:
    """Return the nearest known names as the end of an error's sentence; empty where none is near.

    Letters' case does not count.
    """
    by_folded = {each.casefold(): each for each in known}
    near = get_close_matches(name.casefold(), by_folded, most)
    return f"; did you mean {' or '.join(ascii(by_folded[each]) for each in near)}?" if near else ""
