"""The flight over a vehicle's share of segments that images the most ground in sun soonest.

A beam search (Lowerre 1976) in time. A node is a place, a moment, and which segments are taken by
then; from it the flight continues along a row, changes to an end of what is left on a near row, or
waits. Nodes are sorted into steps of time; of each step only the best are kept, by what they
have gained and by what the time that each has left is worth. A gain is the missing ground times the
probability of sun at that moment; later gains count less, since what comes late may not come. Each
gap that a flight leaves in a row costs a stop later, so it counts against it.

The work is bounded by nodes, never by time: the same input gives the same flight on any machine.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from math import exp, hypot
from typing import NamedTuple

import numpy as np

from recon.guidance.survey.lattice import AlongAcross, RowLattice
from recon.guidance.survey.route import RowLeg
from recon.guidance.survey.rows import Piece
from recon.guidance.survey.segments import NONE, ExpectedSun, Segment, Segments
from recon.guidance.survey.settings import SurveySettings
from recon.model.arrays import BoolArray, FloatArray

AHEAD, BACK, WAITS = 1, -1, 0


class Node(NamedTuple):
    """A moment of a possible flight: it has just flown `segment`, or waited beside it."""

    value_m2: float
    at_s: float
    place_m: AlongAcross
    taken: int
    """A bit for each segment."""
    segment: int
    heading: int
    gain_m2: float
    """Ground of `segment` that will most likely be imaged in sun, 0 if it is too little."""
    before: "Node | None"


@dataclass(frozen=True, slots=True)
class PlannedLeg:
    """A part of a row to be flown: its segments in order, and when its end is reached."""

    route: RowLeg
    segments: tuple[int, ...]
    from_s: float
    until_s: float
    probability: float
    """Probability of sun, mean over its missing ground."""


@dataclass(frozen=True, slots=True)
class Flight:
    """What a vehicle does best: wait until `from_s`, then fly these legs. Without legs there is
    nothing in sun to be gained within the time looked at."""

    legs: tuple[PlannedLeg, ...]
    waits_s: float


@dataclass(frozen=True, slots=True)
class Pace:
    """How fast a vehicle flies: `stop_s` for each corner, `layer_s` for a path in its layer."""

    speed_mps: float
    stop_s: float
    layer_s: float


class Search:
    """One vehicle's search over the segments that are `free` (S,)."""

    def __init__(
        self,
        segments: Segments,
        expected: ExpectedSun,
        free: BoolArray,
        lattice: RowLattice,
        pace: Pace,
        settings: SurveySettings,
    ) -> None:
        self._parts, self._lattice = segments.parts, lattice
        self._pace, self._settings = pace, settings
        self._step_s, self._end_s = settings.moment_s, settings.planned_s
        fade = np.exp(-expected.moments_s / settings.patience_s)
        self._fade: list[float] = fade.tolist()
        missing = np.where(free, expected.missing_m2, 0.0)
        self._missing_m2: list[float] = missing.tolist()
        self._sun: list[list[float]] = expected.probability.tolist()
        self._is_soon_lit = _soon(expected.probability, settings).tolist()
        self._rate = settings.expected_rate * float(
            (missing @ expected.probability).mean() / max(missing.sum(), 1.0)
        ) * (pace.speed_mps * lattice.spacing_m)  # fmt: skip
        self._gap_m2 = settings.gap_costs_s * pace.speed_mps * lattice.spacing_m
        self._rows = self._by_row(free)
        self._steps: dict[int, list[Node]] = {}

    def _by_row(self, free: BoolArray) -> dict[int, tuple[int, ...]]:
        by_row: dict[int, list[int]] = {}
        for number in np.nonzero(free)[0].tolist():
            by_row.setdefault(self._parts[number].row, []).append(number)
        return {row: tuple(numbers) for row, numbers in by_row.items()}

    def best(self, place_m: AlongAcross, starts_s: float) -> Flight:
        """Return the best flight of a vehicle that can start on its way from a place then."""
        best = start = Node(0.0, starts_s, place_m, 0, NONE, WAITS, 0.0, None)
        self._steps = {0: [start]}
        for step in range(int(self._end_s / self._settings.beam_step_s) + 1):
            for node in self._kept(step):
                if node.value_m2 > best.value_m2:
                    best = node
                for following in self._following(node):
                    self._add(step, following)
        return self._flight(best)

    def _add(self, step: int, node: Node) -> None:
        if node.at_s < self._end_s:
            at = max(step + 1, int(node.at_s / self._settings.beam_step_s))
            self._steps.setdefault(at, []).append(node)

    def _kept(self, step: int) -> Iterator[Node]:
        """The best nodes of a step, each of another place or with other segments taken."""
        nodes = self._steps.pop(step, [])
        rate = self._rate * exp(-step * self._settings.beam_step_s / self._settings.patience_s)
        nodes.sort(key=lambda node: rate * node.at_s - node.value_m2)
        kept: set[tuple[int, int, int]] = set()
        for node in nodes:
            key = (node.segment, node.heading, node.taken)
            if key not in kept:
                kept.add(key)
                yield node
                if len(kept) == self._settings.beam_width:
                    return

    def _following(self, node: Node) -> Iterator[Node]:
        if node.heading != WAITS:
            here = self._parts[node.segment]
            on = here.after if node.heading == AHEAD else here.before
            if on != NONE:
                yield self._flown(node, on, node.heading, node.at_s)
        for segment, heading in self._entries(node):
            arrives_s = self._arrives_s(node, segment, heading)
            flown = self._flown(node, segment, heading, arrives_s)
            if flown.gain_m2 > 0.0:
                yield flown
        at_s = node.at_s + self._step_s
        yield node._replace(at_s=at_s, heading=WAITS, gain_m2=0.0, before=node)

    def _entries(self, node: Node) -> set[tuple[int, int]]:
        """Return where a flight may continue on the nearest rows with something left in sun, now or
        when it arrives: at the ends of what is left, and of what will be in sun of it."""
        when = min(int(node.at_s / self._step_s) + 1, len(self._fade) - 1)
        left: list[tuple[float, list[int]]] = []
        for row, numbers in self._rows.items():
            free = [number for number in numbers if not node.taken >> number & 1]
            if any(self._is_soon_lit[number][when] for number in free):
                left.append((abs(self._lattice.row_across_m(row) - node.place_m[1]), free))
        left.sort(key=lambda each: each[0])
        entries: set[tuple[int, int]] = set()
        for _, free in left[: self._settings.rows_looked_at]:
            lit = [number for number in free if self._sun[number][when] > 0.5]
            for ends in (free, lit):
                if ends:
                    entries |= {(ends[0], AHEAD), (ends[-1], BACK)}
        return entries

    def _arrives_s(self, node: Node, segment: int, heading: int) -> float:
        part, pace = self._parts[segment], self._pace
        entry_m = part.start_m if heading == AHEAD else part.end_m
        across_m = abs(part.across_m - node.place_m[1])
        path_m = hypot(entry_m - node.place_m[0], across_m)
        arrives_s = node.at_s + (0.0 if node.heading == WAITS else pace.stop_s / 2.0)
        if path_m > 1.0:
            arrives_s += path_m / pace.speed_mps + pace.stop_s
        is_near = path_m <= self._settings.near_m if node.segment == NONE else (
            across_m <= self._settings.near_rows * self._lattice.spacing_m
        )  # fmt: skip
        return arrives_s if is_near else arrives_s + pace.layer_s

    def _flown(self, node: Node, segment: int, heading: int, from_s: float) -> Node:
        part = self._parts[segment]
        until_s = from_s + part.length_m / self._pace.speed_mps
        moment = min(int((from_s + until_s) / 2.0 / self._step_s), len(self._fade) - 1)
        gain_m2 = self._gain_m2(segment, moment, node.taken)
        value_m2, taken = node.value_m2, node.taken
        if gain_m2 > 0.0:
            value_m2 += (gain_m2 - self._gaps_m2(segment, taken)) * self._fade[moment]
            taken |= 1 << segment
        place_m = (part.end_m if heading == AHEAD else part.start_m, part.across_m)
        return Node(value_m2, until_s, place_m, taken, segment, heading, gain_m2, node)

    def _gain_m2(self, segment: int, moment: int, taken: int) -> float:
        """What a segment gains when it is flown at a moment.

        Most likely in shade, it gains nothing and stays to be flown: in shade once, it would most
        likely be so again a moment later.
        """
        sun = self._sun[segment][moment]
        if taken >> segment & 1 or sun < self._settings.least_sun_probability:
            return 0.0
        part, gain_m2 = self._parts[segment], self._missing_m2[segment] * sun
        least_m2 = self._settings.least_gain * part.length_m * self._lattice.spacing_m
        return gain_m2 if gain_m2 > least_m2 else 0.0

    def _gaps_m2(self, segment: int, taken: int) -> float:
        """What a segment costs when it is taken: one gap more between two that are left, one less
        where it was the last of its gap."""
        part = self._parts[segment]
        beside = sum(
            each != NONE and self._missing_m2[each] > 0.0 and not taken >> each & 1
            for each in (part.before, part.after)
        )
        return (beside - 1) * self._gap_m2

    def _flight(self, best: Node) -> Flight:
        """The flight that ends in a node: its waiting, and its legs as far as it then goes without
        waiting again."""
        nodes: list[Node] = []
        node: Node | None = best
        while node is not None and node.before is not None:
            nodes.append(node)
            node = node.before
        nodes.reverse()
        first = next((i for i, each in enumerate(nodes) if each.gain_m2 > 0.0), None)
        if first is None:
            return Flight((), self._end_s)
        flown = nodes[first:]
        until = next((i for i, each in enumerate(flown) if each.heading == WAITS), len(flown))
        return Flight(tuple(self._legs(flown[:until])), nodes[first - 1].at_s if first else 0.0)

    def _legs(self, nodes: Sequence[Node]) -> Iterator[PlannedLeg]:
        run: list[Node] = []
        for node in nodes:
            if run and not _goes_on(run[-1], node, self._parts):
                yield from self._leg(run)
                run = []
            run.append(node)
        yield from self._leg(run)

    def _leg(self, run: Sequence[Node]) -> Iterator[PlannedLeg]:
        """The run as a leg, without the ends that gain nothing; no leg where it all does."""
        useful = [index for index, node in enumerate(run) if node.gain_m2 > 0.0]
        if not useful:
            return
        flown = run[useful[0] : useful[-1] + 1]
        parts = [self._parts[node.segment] for node in flown]
        start_m, end_m = min(p.start_m for p in parts), max(p.end_m for p in parts)
        piece = Piece(parts[0].row, start_m, end_m)
        missing_m2 = sum(self._missing_m2[run[index].segment] for index in useful)
        sun = sum(node.gain_m2 for node in flown) / missing_m2
        yield PlannedLeg(
            RowLeg(piece, flown[0].heading == BACK),
            tuple(node.segment for node in flown),
            flown[0].at_s - parts[0].length_m / self._pace.speed_mps,
            flown[-1].at_s,
            sun,
        )


def _soon(probability: FloatArray, settings: SurveySettings) -> BoolArray:
    """(S, K): whether flying over a segment is worth it at a moment, or within `transit_s` of
    it."""
    is_worth = probability >= settings.least_sun_probability
    soon = is_worth.copy()
    for later in range(1, 1 + int(settings.transit_s / settings.moment_s)):
        soon[:, :-later] |= is_worth[:, later:]
    found: BoolArray = soon
    return found


def _goes_on(node: Node, following: Node, parts: Sequence[Segment]) -> bool:
    """Whether a flight continues along the same row in the same direction."""
    here = parts[node.segment]
    on = here.after if node.heading == AHEAD else here.before
    return (
        following.heading == node.heading and following.segment == on and following.before is node
    )
