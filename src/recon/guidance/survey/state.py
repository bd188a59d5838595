"""A survey under way: who flies what, and how far it has come."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from types import MappingProxyType

import numpy as np

from recon.guidance.survey.plan import SurveyPlan
from recon.guidance.survey.progress import Progress
from recon.guidance.survey.route import Place, Route
from recon.model.survey import CellState, SurveyPhase
from recon.model.units import ns_to_seconds

Routes = Mapping[str, Route]
NO_ROUTES: Routes = MappingProxyType({})


@dataclass(frozen=True, slots=True)
class Surveyor:
    """What the planner must know of one of the survey's vehicles, now.

    `is_able`: it may be given a mission, or goes on with the one it has (it is heard, led by
    guidance, not on its way home). `ended_mission` is the number of its newest mission of this
    survey that has ended, however it ended. `time_left_s` is how long it can still fly, the reserve
    taken off; None when nobody knows, and then the gate alone says what its battery is good for.
    """

    serial: str
    place_m: Place
    """East-north metres of the site."""
    is_able: bool = True
    ended_mission: int = 0
    time_left_s: float | None = None
    home_m: Place | None = None
    """Where it lands; None: where it is now."""


@dataclass(frozen=True, slots=True)
class Flight:
    """A mission that was given, until it has ended."""

    number: int
    route: Route
    corners_m: tuple[Place, ...]
    """East-north metres of the site, for showing."""
    length_m: float


@dataclass(frozen=True, slots=True)
class Refused:
    """A mission that the gate refused."""

    reason: str
    at_ns: int


@dataclass(frozen=True, slots=True, eq=False)
class SurveyState:
    """One survey's state; by serial where it is a mapping.

    `waiting` holds what is left of each vehicle's share of the round. `refusals` are the newest of
    each vehicle. One refused while nobody else flew is `barred`: it is given nothing until the
    survey is started anew, for the reason lies with itself or with the rows.
    """

    plan: SurveyPlan
    progress: Progress
    serials: tuple[str, ...] = ()
    phase: SurveyPhase = SurveyPhase.CREATED
    reason: str = "not started yet"
    """Why it is in this phase, or what hinders it, in a sentence for people."""
    round: int = 0
    flights: Mapping[str, Flight] = field(default_factory=lambda: MappingProxyType({}))
    waiting: Routes = field(default_factory=lambda: NO_ROUTES)
    refusals: Mapping[str, Refused] = field(default_factory=lambda: MappingProxyType({}))
    barred: frozenset[str] = frozenset()
    missions: int = 0
    flown_m: float = 0.0
    """Planned metres of all missions given and not refused."""
    started_at_ns: int | None = None
    ended_at_ns: int | None = None
    quiet_since_ns: int = 0
    """Since when nobody flies."""


@dataclass(frozen=True, slots=True)
class SurveyFigures:
    """Areas by counted cells of the region; times from the start, None: not yet."""

    region_m2: float
    reached_m2: float
    """What the rows see for sure; less than the region where they had to be cut."""
    not_yet_m2: float
    in_shade_m2: float
    """Imaged, and not for sure in sun."""
    in_sun_m2: float
    sun_unknown_m2: float
    """Imaged, and no shade map told in which light; counted as in shade."""
    time_to_95_imaged_s: float | None
    time_to_95_in_sun_s: float | None
    """Of what the rows reach."""


def figures(state: SurveyState) -> SurveyFigures:
    """Return the figures of a survey as it stands."""
    cells, progress = state.plan.cells, state.progress
    inside = cells.is_inside
    states = progress.state[inside]
    unknown = (states == CellState.IN_SHADE) & ~progress.is_sun_known[inside]
    return SurveyFigures(
        region_m2=float(inside.sum()) * cells.cell_m2,
        reached_m2=float(cells.is_reached.sum()) * cells.cell_m2,
        not_yet_m2=_area_m2(states, CellState.NOT_YET, cells.cell_m2),
        in_shade_m2=_area_m2(states, CellState.IN_SHADE, cells.cell_m2),
        in_sun_m2=_area_m2(states, CellState.IN_SUN, cells.cell_m2),
        sun_unknown_m2=float(unknown.sum()) * cells.cell_m2,
        time_to_95_imaged_s=_after_s(state, progress.imaged_95_at_ns),
        time_to_95_in_sun_s=_after_s(state, progress.in_sun_95_at_ns),
    )


def _area_m2(states: "np.typing.NDArray[np.uint8]", which: CellState, cell_m2: float) -> float:
    return float((states == which).sum()) * cell_m2


def _after_s(state: SurveyState, at_ns: int | None) -> float | None:
    if at_ns is None or state.started_at_ns is None:
        return None
    return ns_to_seconds(at_ns - state.started_at_ns)


HECTARE_M2 = 10_000.0


def spent_budget(state: SurveyState, wanted: CellState, now_ns: int) -> str | None:
    """Return which budget is spent, so that no more missions are given; None: none is."""
    budget = state.plan.survey.budget
    since_s = 0.0 if state.started_at_ns is None else ns_to_seconds(now_ns - state.started_at_ns)
    if budget.time_s is not None and since_s >= budget.time_s:
        return f"the {budget.time_s:g} s allowed are over; {_missing(state, wanted)}"
    if budget.flown_m is not None and state.flown_m >= budget.flown_m:
        return f"the {budget.flown_m:g} m allowed are flown; {_missing(state, wanted)}"
    return None


def end_between_rounds(state: SurveyState, wanted: CellState) -> str | None:
    """Return why the survey is done, between two rounds; None: it goes on."""
    if is_enough(state, wanted):
        sun = " in sun" if wanted == CellState.IN_SUN else ""
        return f"all that the rows reach is imaged{sun}"
    if is_enough(state, CellState.IN_SHADE) and not state.progress.is_sun_known.any():
        return (
            "all that the rows reach is imaged, in light that nobody knows: without an eye that "
            "sees the field nothing is flown again for sun"
        )
    rounds = state.plan.survey.budget.rounds
    if state.round < rounds:
        return None
    flown = "the one round allowed is" if rounds == 1 else f"all {rounds} rounds allowed are"
    return f"{flown} flown; {_missing(state, wanted)}"


def is_enough(state: SurveyState, wanted: CellState) -> bool:
    """Return whether as many cells as are asked for are in the wanted state."""
    reached = state.plan.cells.is_reached
    share = float((state.progress.state[reached] >= wanted).mean())
    return share >= state.plan.settings.enough_share


def _missing(state: SurveyState, wanted: CellState) -> str:
    """How much of what the rows reach is not imaged, and how much only in shade."""
    cells = state.plan.cells
    states = state.progress.state[cells.is_reached]

    def words(which: CellState, what: str) -> str:
        area_ha = float((states == which).sum()) * cells.cell_m2 / HECTARE_M2
        return f"{area_ha:.2f} ha {what}"

    reached = f"of {states.size * cells.cell_m2 / HECTARE_M2:.2f} ha"
    not_yet = words(CellState.NOT_YET, "are not imaged")
    if wanted == CellState.IN_SHADE:
        return f"{reached}, {not_yet}"
    return f"{reached}, {words(CellState.IN_SHADE, 'are imaged in shade only')}, {not_yet}"
