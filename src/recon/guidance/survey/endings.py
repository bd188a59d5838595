"""Why a running survey ends, in a sentence for people: all is imaged, or its budget is spent."""

from recon.guidance.survey.state import SurveyState
from recon.model.survey import CellState
from recon.model.units import ns_to_seconds

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
