"""The figures of a soak, from its samples: windows, growth, percentiles, tables and the verdict."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field

import numpy as np

MB = 1e6
SETTLING_SHARE = 1.0 / 6.0
"""Share of the run before memory has to be flat: the first ten minutes of an hour."""
GROWTH_LIMIT = 0.01
"""Share of a process's memory by which it may grow in an hour."""
ALL_STOP_LIMIT_MS = 100.0
HOUR_S = 3_600.0
LEAST_SAMPLES = 8


@dataclass(frozen=True, slots=True)
class ProcessSample:
    """One look at one process."""

    at_s: float
    role: str
    pid: int
    rss_bytes: int
    handles: int
    threads: int


@dataclass(frozen=True, slots=True)
class AllStop:
    """One all stop: when it was pressed, and the time until the last vehicle's packet was sent.

    `away` counts vehicles without a link at that moment; `unsent` packets of the press before that
    were never sent, also not when their vehicles were back.
    """

    at_s: float
    on_wires_ms: float
    unsent: int = 0
    away: int = 0


@dataclass(frozen=True, slots=True)
class Sizes:
    """One look at what the station answers and keeps."""

    at_s: float
    state_bytes: int
    record_bytes: int


@dataclass(slots=True)
class Soak:
    """Everything that a run has measured; times are seconds since its start."""

    processes: list[ProcessSample] = field(default_factory=list)
    stops: list[AllStop] = field(default_factory=list)
    sizes: list[Sizes] = field(default_factory=list)


@dataclass(frozen=True, slots=True)
class Growth:
    """How the memory of one process changed after it had settled; shares of its mean an hour.

    `share_per_hour` is None for too few samples.
    """

    role: str
    pid: int
    mean_bytes: float
    share_per_hour: float | None

    @property
    def is_flat(self) -> bool:
        """Whether it grew by less than the limit."""
        return self.share_per_hour is not None and self.share_per_hour <= GROWTH_LIMIT


def growths(samples: Iterable[ProcessSample], settled_s: float) -> list[Growth]:
    """Return the growth of each process that was sampled after `settled_s`, by role and pid."""
    series: dict[tuple[str, int], list[ProcessSample]] = {}
    for sample in samples:
        if sample.at_s >= settled_s:
            series.setdefault((sample.role, sample.pid), []).append(sample)
    return [_growth(role, pid, each) for (role, pid), each in sorted(series.items())]


def _growth(role: str, pid: int, samples: Sequence[ProcessSample]) -> Growth:
    """Fit a line: one large sample at an end does not decide."""
    rss = np.array([each.rss_bytes for each in samples], dtype=np.float64)
    mean_bytes = float(rss.mean())
    if len(samples) < LEAST_SAMPLES:
        return Growth(role, pid, mean_bytes, None)
    at_s = np.array([each.at_s for each in samples])
    slope = float(np.polyfit(at_s - at_s[0], rss, 1)[0])
    return Growth(role, pid, mean_bytes, slope * HOUR_S / mean_bytes)


def faults_of(soak: Soak, length_s: float) -> list[str]:
    """Return a sentence for each figure that misses its limit; none for a good run."""
    found = growths(soak.processes, SETTLING_SHARE * length_s)
    pids = {each.role: [other.pid for other in found if other.role == each.role] for each in found}
    faults = [
        f"{role} ended and was started again, {len(each) - 1} times"
        for role, each in pids.items()
        if len(each) > 1
    ]
    faults += [_fault(each) for each in found if len(pids[each.role]) == 1 and not each.is_flat]
    p99_ms = percentile_ms(soak.stops, 99)
    if p99_ms is None or p99_ms > ALL_STOP_LIMIT_MS:
        shown = "not measured" if p99_ms is None else f"{p99_ms:.0f} ms"
        faults.append(f"all stop p99 is {shown}, at most {ALL_STOP_LIMIT_MS:g} ms expected")
    unsent = sum(each.unsent for each in soak.stops)
    if unsent:
        faults.append(f"{unsent} packets of all stops were not sent")
    return faults


def _fault(growth: Growth) -> str:
    if growth.share_per_hour is None:
        return f"memory of {growth.role}: fewer than {LEAST_SAMPLES} samples"
    return f"memory of {growth.role} grows by {100.0 * growth.share_per_hour:.1f} % an hour"


def percentile_ms(stops: Sequence[AllStop], percent: float) -> float | None:
    """Return a percentile of the latency of all stop; None without any."""
    return float(np.percentile([each.on_wires_ms for each in stops], percent)) if stops else None


def window_lines(soak: Soak, from_s: float, until_s: float) -> list[str]:
    """Return the table of one part of the run: its last look at everything, and its all stops."""
    stops = [each for each in soak.stops if from_s <= each.at_s < until_s]
    sizes = [each for each in soak.sizes if from_s <= each.at_s < until_s]
    p50_ms, p99_ms = percentile_ms(stops, 50), percentile_ms(stops, 99)
    lines = [f"minutes {from_s / 60.0:.1f} to {until_s / 60.0:.1f}"]
    if sizes:
        last = sizes[-1]
        lines.append(
            f"  state {last.state_bytes / 1e3:.0f} kB, record {last.record_bytes / MB:.0f} MB"
        )
    if p50_ms is not None and p99_ms is not None:
        away = sum(each.away for each in stops)
        lines.append(
            f"  {len(stops)} all stops: p50 {p50_ms:.1f} ms, p99 {p99_ms:.1f} ms; "
            f"{away} vehicles were without a link, and told later"
        )
    lines.append(f"  {'process':<12}{'memory MB':>10}{'handles':>9}{'threads':>9}")
    newest = {
        (each.role, each.pid): each for each in soak.processes if from_s <= each.at_s < until_s
    }
    lines += [
        f"  {role:<12}{each.rss_bytes / MB:>10.1f}{each.handles:>9}{each.threads:>9}"
        for (role, _), each in sorted(newest.items())
    ]
    return lines


def growth_lines(soak: Soak, length_s: float) -> list[str]:
    """Return the growth of each process after the first sixth."""
    return [
        f"  {each.role:<12}{each.mean_bytes / MB:>10.1f} MB, {_percent(each)}"
        for each in growths(soak.processes, SETTLING_SHARE * length_s)
    ]


def _percent(growth: Growth) -> str:
    share = growth.share_per_hour
    return "too few samples" if share is None else f"{100.0 * share:+.2f} % an hour"
