"""Figures as rows of tables in Markdown: a name, the figure, its interval, the number of runs."""

from collections.abc import Callable, Sequence
from math import inf

from recon.score.interval import Interval, interval, ratio, times

Row = tuple[str, ...]
NOTHING = "-"
"""Text for a figure that no run has."""


def row(
    name: str, values: Sequence[float | None], text: Callable[[float], str], most: float = inf
) -> Row:
    """Return the row of a mean over runs."""
    return formatted(name, interval(values), text, most)


def formatted(
    name: str, found: Interval | None, text: Callable[[float], str], most: float = inf
) -> Row:
    """Return the row of a figure with its interval."""
    if found is None:
        return name, NOTHING, NOTHING, "0"
    return name, text(found.mean), bounds(found, text, most), f"{found.count}"


def share(name: str, parts: Sequence[float], of: Sequence[float]) -> Row:
    """Return the row of a share in per cent, over all runs together."""
    return formatted(name, ratio(list(zip(parts, of, strict=True))), percent, 1.0)


def time(name: str, values: Sequence[float | None], limit_s: float) -> Row:
    """Return the row of times to an event, cut at the limit."""
    found = times(values, limit_s)
    if found is None:
        return name, NOTHING, NOTHING, "0"
    is_cut = found.reached < found.count
    mean = ("at least " if is_cut else "") + minutes(found.mean.mean)
    reached = f"{found.reached} of {found.count} within the limit"
    return name, mean, bounds(found.mean, minutes, limit_s), reached


def bounds(found: Interval, text: Callable[[float], str], most: float) -> str:
    """Return the interval, cut to the range of the figure: 0 to `most`."""
    if found.high == inf:
        return NOTHING
    return f"{text(max(found.low, 0.0))} to {text(min(found.high, most))}"


def plain(value: float) -> str:
    """Return a number with one digit."""
    return f"{value:.1f}"


def fine(value: float) -> str:
    """Return a number with two digits."""
    return f"{value:.2f}"


def finest(value: float) -> str:
    """Return a number with three digits."""
    return f"{value:.3f}"


def percent(value: float) -> str:
    """Return a share in per cent."""
    return f"{100.0 * value:.1f}"


def minutes(value: float) -> str:
    """Return seconds in minutes."""
    return f"{value / 60.0:.1f}"


def table(head: Row, rows: Sequence[Row]) -> str:
    """Return rows as a table in Markdown."""
    lines = [head, ("---",) * len(head), *rows]
    return "\n".join(f"| {' | '.join(line)} |" for line in lines)
