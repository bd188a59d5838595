"""Flies a planned fleet return in 10 Hz steps, with motion and distances of its own.

Uses only the heights, paths and pads of the plan, and asks `hindrance` before each start. Every
vehicle has its own speeds, hovers with a drift of its own and waits before it touches down.
"""

from collections.abc import Sequence
from dataclasses import dataclass, field
from math import hypot, inf, sqrt
from random import Random

import numpy as np

from recon.guidance.fleet_return import (
    FleetReturnSettings,
    Hovering,
    Place,
    ReturnFlight,
    ReturnPlan,
    Separation,
    claim_left,
    hindrance,
    layer_is_taken_by,
    whole_claim,
)

STEP_S = 0.1
DRIFT_M = 1.2


@dataclass
class Flier:
    """One vehicle: hovers, then flies point after point, then is on the ground."""

    name: str
    place_m: Place
    rng: Random
    targets_m: list[Place] = field(default_factory=list)
    is_on_ground: bool = False
    began_s: float | None = None
    landed_s: float | None = None
    waits_s: float = 0.0

    def __post_init__(self) -> None:
        self.level_mps = self.rng.uniform(4.0, 8.0)
        self.upright_mps = self.rng.uniform(1.0, 3.0)
        self.drift_m = tuple(self.rng.uniform(-DRIFT_M, DRIFT_M) / sqrt(2.0) for _ in range(2))

    @property
    def true_place_m(self) -> Place:
        east_m, north_m, up_m = self.place_m
        return east_m + self.drift_m[0], north_m + self.drift_m[1], up_m

    def begin(self, flight: ReturnFlight, now_s: float) -> None:
        layer_m, pad = flight.layer_up_m, flight.pad
        self.began_s = now_s
        self.waits_s = self.rng.uniform(0.5, 4.0)
        self.targets_m = [
            (*self.place_m[:2], layer_m),
            *((east_m, north_m, layer_m) for east_m, north_m in flight.path_m[1:]),
            (pad.east_m, pad.north_m, pad.up_m + 0.3),
        ]

    def step(self, now_s: float) -> None:
        if self.began_s is None or self.is_on_ground:
            return
        if now_s - self.began_s < self.waits_s:
            return
        if not self.targets_m:
            self.is_on_ground, self.landed_s = True, now_s
            return
        offset = [t - p for t, p in zip(self.targets_m[0], self.place_m, strict=True)]
        far_m = sqrt(sum(part * part for part in offset))
        is_level = abs(offset[2]) < 0.01
        reach_m = (self.level_mps if is_level else self.upright_mps) * STEP_S
        if far_m <= reach_m:
            self.place_m = self.targets_m.pop(0)
            return
        east_m, north_m, up_m = (
            p + part * reach_m / far_m for p, part in zip(self.place_m, offset, strict=True)
        )
        self.place_m = (east_m, north_m, up_m)


@dataclass
class Flown:
    """What came of it."""

    fliers: dict[str, Flier]
    nearest_m: float = inf
    """Level distance of the worst pair in the air whose heights were nearer than is allowed."""
    nearest_pair: str = "no pair"
    most_at_once: int = 0
    most_at_a_pad: int = 0
    lasted_s: float = 0.0
    heights: list[tuple[float, dict[str, tuple[float, float]]]] = field(default_factory=list)
    """Every second: height and path to the pad of each in the air."""


def fly(
    plan: ReturnPlan,
    others: dict[str, Place],
    separation: Separation,
    least: Separation,
    settings: FleetReturnSettings,
    seed: int,
    at_most_s: float = 20_000.0,
) -> Flown:
    """Fly a plan to its end; `others` hover all the time."""
    rng = Random(seed)
    fliers = {f.name: Flier(f.name, f.start_m, Random(rng.random())) for f in plan.flights}
    hoverers = {n: Flier(n, place, Random(rng.random())) for n, place in others.items()}
    flown = Flown(fliers | hoverers)
    waiting = list(plan.flights)
    under_way: list[ReturnFlight] = []
    for count in range(round(at_most_s / STEP_S)):
        now_s = count * STEP_S
        if count % 10 == 0:
            _begin(waiting, under_way, flown.fliers, separation, settings, now_s)
            under_way[:] = [f for f in under_way if not flown.fliers[f.name].is_on_ground]
            _note(flown, under_way, now_s)
        for flier in fliers.values():
            flier.step(now_s)
        _watch(flown, least)
        flown.lasted_s = now_s
        if all(flier.is_on_ground for flier in fliers.values()):
            break
    return flown


def _begin(
    waiting: list[ReturnFlight],
    under_way: list[ReturnFlight],
    fliers: dict[str, Flier],
    separation: Separation,
    settings: FleetReturnSettings,
    now_s: float,
) -> None:
    flying = {n: f.place_m for n, f in fliers.items() if not f.is_on_ground}
    moving = {f.name for f in under_way}
    for flight in tuple(waiting):
        hovering = [
            Hovering(n, n, p) for n, p in flying.items() if n != flight.name and n not in moving
        ]
        now = [claim_left(f, flying[f.name], settings) for f in under_way if f.name in flying]
        before = waiting[: waiting.index(flight)]
        if layer_is_taken_by(flight, before, under_way) is not None:
            continue
        claims = [whole_claim(earlier) for earlier in before]
        if hindrance(flight, claims, now, hovering, separation) is None:
            fliers[flight.name].begin(flight, now_s)
            waiting.remove(flight)
            under_way.append(flight)
            moving.add(flight.name)


def _note(flown: Flown, under_way: Sequence[ReturnFlight], now_s: float) -> None:
    flown.most_at_once = max(flown.most_at_once, len(under_way))
    heights: dict[str, tuple[float, float]] = {}
    landing: dict[str, int] = {}
    for flight in under_way:
        flier, pad = flown.fliers[flight.name], flight.pad
        east_m, north_m, up_m = flier.place_m
        heights[flight.name] = up_m, hypot(east_m - pad.east_m, north_m - pad.north_m)
        if len(flier.targets_m) <= 1:
            landing[pad.name] = landing.get(pad.name, 0) + 1
    flown.heights.append((now_s, heights))
    flown.most_at_a_pad = max(flown.most_at_a_pad, *landing.values(), 0)


def _watch(flown: Flown, least: Separation) -> None:
    flying = [f for f in flown.fliers.values() if not f.is_on_ground]
    if len(flying) < 2:
        return
    places = np.array([f.true_place_m for f in flying])
    one, other = np.triu_indices(len(flying), 1)
    offsets = np.abs(places[one] - places[other])
    level_m = np.hypot(offsets[:, 0], offsets[:, 1])
    level_m[offsets[:, 2] >= least.vertical_m] = np.inf
    worst = int(np.argmin(level_m))
    if level_m[worst] < flown.nearest_m:
        flown.nearest_m = float(level_m[worst])
        flown.nearest_pair = f"{flying[one[worst]].name} and {flying[other[worst]].name}"
