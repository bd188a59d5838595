"""How regularly a link's telemetry arrives: rate, jitter and gaps, from arrival times alone.

Core telemetry is sent at an even rate, so what is uneven at its arrival is the link, or an app
that is busy. Nothing is sent for it.
"""

from dataclasses import dataclass

from recon.model.units import NS_PER_S

MEMORY = 16
"""Packets over which rate and jitter are averaged: at 10 Hz 1.6 s, slower than a burst."""
WINDOW_NS = 30 * NS_PER_S
"""A gap is remembered for one to two of these: an operator looks at a vehicle about as often."""
BAR_GAPS_S = (3.0, 2.0, 1.0, 0.5)
"""Gaps under which a link has one bar, two, three, four: lost telemetry has none, and at 10 Hz half
a second is five packets."""


@dataclass(frozen=True, slots=True)
class Arrivals:
    """The arrivals of a link's core telemetry, so far."""

    newest_ns: int
    interval_s: float | None = None
    """Mean time between two."""
    jitter_s: float = 0.0
    """Mean difference of that time from its mean."""
    window_began_ns: int = 0
    gap_s: float = 0.0
    """The longest time between two in this window, and in the one before."""
    gap_before_s: float = 0.0


def after_arrival(arrivals: Arrivals | None, at_ns: int) -> Arrivals:
    """Return a link's arrivals with one more; None: it is the first."""
    if arrivals is None:
        return Arrivals(at_ns, window_began_ns=at_ns)
    passed_s = max(0.0, (at_ns - arrivals.newest_ns) / NS_PER_S)
    mean_s, jitter_s = arrivals.interval_s, arrivals.jitter_s
    if mean_s is None:
        mean_s = passed_s
    mean_s += (passed_s - mean_s) / MEMORY
    jitter_s += (abs(passed_s - mean_s) - jitter_s) / MEMORY
    began_ns, gap_s, before_s = arrivals.window_began_ns, arrivals.gap_s, arrivals.gap_before_s
    if at_ns - began_ns >= WINDOW_NS:
        began_ns, gap_s, before_s = at_ns, 0.0, gap_s
    return Arrivals(at_ns, mean_s, jitter_s, began_ns, max(gap_s, passed_s), before_s)


@dataclass(frozen=True, slots=True)
class LinkFigures:
    """Figures of a link as of now; `bars` 0 to 4. The longest gap counts the present silence."""

    rate_hz: float
    jitter_s: float
    longest_gap_s: float
    bars: int


def link_figures(arrivals: Arrivals | None, now_ns: int) -> LinkFigures | None:
    """Return a link's figures; None before two packets of core telemetry."""
    if arrivals is None or not arrivals.interval_s:
        return None
    silent_s = (now_ns - arrivals.newest_ns) / NS_PER_S
    gap_s = max(silent_s, arrivals.gap_s, arrivals.gap_before_s)
    bars = sum(gap_s < limit_s for limit_s in BAR_GAPS_S)
    return LinkFigures(1.0 / arrivals.interval_s, arrivals.jitter_s, gap_s, bars)
