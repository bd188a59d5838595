"""The violations of one run: episodes, each classed at its beginning, with its history."""

from collections import deque
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field

from tests.oracles.flown_air import Breach

from studies.closed_loop.marks import (
    StationMarks,
    VehicleMarks,
    ViolationClass,
    classify,
)

EPISODE_ENDS_S = 3.0
HISTORY_LINES = 14
LOG_LINES = 3_000

EpisodeKey = tuple[str, tuple[str, ...], str]


@dataclass(slots=True)
class Violation:
    """One episode: the breach at its beginning, its class, and what had happened before."""

    seed: int
    at_s: float
    breach: Breach
    kind: ViolationClass
    why: str
    history: list[str]
    until_s: float = 0.0
    worst: str = ""
    worst_size: float = 0.0


@dataclass(slots=True)
class RunResult:
    """What one run came to."""

    seed: int
    seconds: float = 0.0
    flight_s: float = 0.0
    vehicles: int = 0
    orders: int = 0
    packets: int = 0
    landings: int = 0
    cpu_s: float = 0.0
    violations: list[Violation] = field(default_factory=list)
    stop_latencies_s: list[float] = field(default_factory=list)
    error: str = ""


@dataclass(slots=True)
class ViolationLog:
    """Writes down what happens, and turns breaches into episodes."""

    result: RunResult
    marks: Mapping[str, VehicleMarks]
    now_s: Callable[[], float]
    is_verbose: bool = False
    station_marks: StationMarks = field(default_factory=StationMarks)
    episodes: dict[EpisodeKey, Violation] = field(default_factory=dict)
    """Those that have not ended."""
    alarmed: set[EpisodeKey] = field(default_factory=set)
    """Those whose missing alarm was found already."""
    lines: deque[tuple[float, str, str]] = field(default_factory=lambda: deque(maxlen=LOG_LINES))
    """When, which vehicle (or ""), what."""

    def note(self, serial: str, text: str) -> None:
        """Write a line of the run's history."""
        self.lines.append((self.now_s(), serial, text))
        if self.is_verbose:
            print(f"{self.now_s():8.2f} {serial:<7} {text}", flush=True)

    def found(self, breach: Breach) -> None:
        now_s = self.now_s()
        running = self.episodes.get(breach.key)
        if running is not None:
            running.until_s = now_s
            if breach.size > running.worst_size:
                running.worst, running.worst_size = breach.text, breach.size
            return
        marks = [self.marks[serial] for serial in breach.serials]
        kind, why = classify(breach, marks, self.station_marks, now_s)
        violation = Violation(
            self.result.seed,
            now_s,
            breach,
            kind,
            why,
            self._history(breach.serials),
            now_s,
            breach.text,
            breach.size,
        )
        self.episodes[breach.key] = violation
        self.result.violations.append(violation)
        if self.is_verbose:
            print(
                f"{now_s:8.2f} VIOLATION {kind.value}: {breach.kind} {breach.serials}"
                f" {breach.text}; {why}",
                flush=True,
            )

    def _history(self, serials: tuple[str, ...]) -> list[str]:
        lines = [item for item in self.lines if item[1] in (*serials, "")]
        return [f"{at_s:.1f} {who} {text}"[:200] for at_s, who, text in lines[-HISTORY_LINES:]]

    def end_old(self) -> None:
        """End the episodes that have not been seen for a while."""
        now_s = self.now_s()
        over = [key for key, v in self.episodes.items() if now_s - v.until_s > EPISODE_ENDS_S]
        for key in over:
            del self.episodes[key]
            self.alarmed.discard(key)
