"""Names in sentences: the first of many, and the one that was meant."""

from collections.abc import Iterable, Sequence
from difflib import get_close_matches


def first_names(names: Sequence[str], most: int) -> str:
    """Return the first names, and how many more there are."""
    more = f" and {len(names) - most} more" if len(names) > most else ""
    return ", ".join(names[:most]) + more


def did_you_mean(name: str, known: Iterable[str], most: int = 1) -> str:
    """Return the nearest known names as the end of an error's sentence; empty where none is near.

    Letters' case does not count.
    """
    by_folded = {each.casefold(): each for each in known}
    near = get_close_matches(name.casefold(), by_folded, most)
    return f"; did you mean {' or '.join(ascii(by_folded[each]) for each in near)}?" if near else ""
