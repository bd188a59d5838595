"""A survey's progress in figures."""

from dataclasses import dataclass

import numpy as np

from recon.guidance.survey.state import SurveyState
from recon.model.survey import CellState
from recon.model.units import ns_to_seconds


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
