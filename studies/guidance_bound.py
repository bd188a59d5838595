"""How soon a field could be imaged in sun if its light were known and ways cost nothing.

    python -m studies.guidance_bound cumulus-40-wide --seeds 10

A lower bound by maximum flow, beside what `recon score` has flown. In every ten seconds the drones
together can fly a certain area of rows; a segment of a row can take as much of it as truly lies in
sun then, and no more than its own area in all. The bound is the earliest moment until which 95 % of
the region can so flow into its segments. It knows the sky, stops nowhere, needs no way between rows
and changes no battery, so no planner reaches it: it shows how much of the time is the sky's.
"""

import argparse
from pathlib import Path

import numpy as np
import numpy.typing as npt
from scipy.sparse import csr_array
from scipy.sparse.csgraph import maximum_flow

from recon.cli.score import Chosen, Flying
from recon.geo import cell_centres_m
from recon.guidance.survey import SurveyPlan, plan_survey, surroundings_of
from recon.guidance.survey.segments import NONE, segments_of
from recon.model.command import Refusal
from recon.model.shade import SUNLIT_TRANSMITTANCE
from recon.score import Scenario
from recon.score.interval import interval, log_ratio
from recon.score.run_score import ENOUGH
from recon.score.scenario_sky import sky_of
from recon.score.table_rows import fine, formatted, minutes, table

FloatArray = npt.NDArray[np.float64]

FOLDER = Path(__file__).parents[1] / "scenarios"
PLANNERS = ("sunlit_first", "lawnmower_again")
FIRST_SEED, SLOT_S = 1000, 10.0
UNIT_M2 = 0.1
"""Flows are whole numbers of this."""


def earliest_s(
    lit_m2: FloatArray, area_m2: FloatArray, rate_m2ps: float, slot_s: float, share: float
) -> float | None:
    """Return when a share of all segments' area can be imaged in sun, at the earliest.

    `lit_m2` (S, K) is each segment's area in sun in each slot of time, `area_m2` (S,) its own, and
    `rate_m2ps` what all drones fly over together. None: not within the slots.
    """
    wanted_m2 = share * float(area_m2.sum())
    count = lit_m2.shape[1]
    if _most_m2(lit_m2, area_m2, rate_m2ps * slot_s, count) < wanted_m2 - UNIT_M2:
        return None
    too_few, enough = 0, count
    while enough - too_few > 1:
        middle = (too_few + enough) // 2
        if _most_m2(lit_m2, area_m2, rate_m2ps * slot_s, middle) >= wanted_m2 - UNIT_M2:
            enough = middle
        else:
            too_few = middle
    before_m2 = _most_m2(lit_m2, area_m2, rate_m2ps * slot_s, too_few)
    gained_m2 = _most_m2(lit_m2, area_m2, rate_m2ps * slot_s, enough) - before_m2
    part = min(1.0, max(0.0, (wanted_m2 - before_m2) / max(gained_m2, UNIT_M2)))
    return (too_few + part) * slot_s


def _most_m2(lit_m2: FloatArray, area_m2: FloatArray, slot_m2: float, slots: int) -> float:
    """Return the maximum flow from so many slots through the segments, in square metres."""
    segments = len(area_m2)
    if slots == 0:
        return 0.0
    source, first_segment, sink = 0, 1 + slots, 1 + slots + segments
    of_segment, of_slot = np.nonzero(lit_m2[:, :slots] >= UNIT_M2)
    tails = [np.full(slots, source), 1 + of_slot, first_segment + np.arange(segments)]
    heads = [1 + np.arange(slots), first_segment + of_segment, np.full(segments, sink)]
    sizes_m2 = [np.full(slots, slot_m2), lit_m2[of_segment, of_slot], area_m2]
    capacity = np.floor(np.concatenate(sizes_m2) / UNIT_M2).astype(np.int32)
    graph = csr_array(
        (capacity, (np.concatenate(tails), np.concatenate(heads))), shape=(sink + 1, sink + 1)
    )
    return float(maximum_flow(graph, source, sink).flow_value) * UNIT_M2


def plan_of(scenario: Scenario) -> SurveyPlan:
    """Return the rows of a scenario's survey, as the station plans them."""
    plan = plan_survey(scenario.survey, scenario.frame, surroundings_of(scenario.site.airspace))
    assert not isinstance(plan, Refusal), plan
    return plan


def bound_s(scenario: Scenario, plan: SurveyPlan, seed: int) -> float:
    """Return a seed's bound, cut at the scenario's limit; takeoff is included."""
    settings, survey = plan.settings, scenario.survey
    of_cell = segments_of(plan).of_cell
    is_reached = of_cell != NONE
    east_m, north_m = (axis[is_reached] for axis in np.meshgrid(*cell_centres_m(plan.cells.grid)))
    climb_s = survey.height_above_takeoff_m / settings.climb_mps
    begins_s = settings.start_s + settings.takeoff_s + climb_s
    moments_s = np.arange(begins_s + SLOT_S / 2.0, scenario.limit_s, SLOT_S)
    sky, segment = sky_of(scenario, seed), of_cell[is_reached]
    count = int(segment.max()) + 1
    lit_m2 = np.empty((count, len(moments_s)))
    for slot, at_s in enumerate(moments_s.tolist()):
        light = sky.transmittance(east_m, north_m, np.full(len(east_m), at_s))
        is_lit = light >= SUNLIT_TRANSMITTANCE
        lit_m2[:, slot] = plan.cells.cell_m2 * np.bincount(segment, is_lit, count)
    area_m2 = plan.cells.cell_m2 * np.bincount(segment, minlength=count)
    drones = len(scenario.fleet.serials)
    rate_m2ps = drones * survey.speed_mps * plan.lattice.spacing_m
    found_s = earliest_s(lit_m2, area_m2.astype(np.float64), rate_m2ps, SLOT_S, ENOUGH)
    return scenario.limit_s if found_s is None else min(begins_s + found_s, scenario.limit_s)


def main() -> None:
    """Print a scenario's bound, and how far the planners' runs are from it."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("scenario", help="a name in scenarios/")
    parser.add_argument("--seeds", type=int, default=10)
    parser.add_argument("--first-seed", type=int, default=FIRST_SEED)
    parser.add_argument("--jobs", type=int, help="runs at once; default: one for each core")
    parser.add_argument("--alone", action="store_true", help="the bound only: fly nothing")
    asked = parser.parse_args()
    path = FOLDER / f"{asked.scenario}.toml"
    seeds = range(asked.first_seed, asked.first_seed + asked.seeds)
    scenario = Chosen(None, None, None, None, surveys_only=True).scenario(path)
    plan = plan_of(scenario)
    bounds_s = {seed: bound_s(scenario, plan, seed) for seed in seeds}
    rows = [formatted("bound, min", interval(list(bounds_s.values())), minutes)]
    for planner in () if asked.alone else PLANNERS:
        chosen = Chosen(planner, None, None, None, surveys_only=True).scenario(path)
        runs = Flying(seeds, asked.jobs, None, fresh=False).runs_of(path, chosen)
        over = [(r.to_95_in_sun_s or scenario.limit_s, bounds_s[r.seed]) for r in runs]
        rows.append(formatted(f"{planner} over the bound", log_ratio(over), fine))
    print(table((asked.scenario, "mean", "95 %", "seeds"), rows))


if __name__ == "__main__":
    main()
