"""What the imaging drone sees of the shade to come when it moves upwind, and when it stays.

    python -m studies.move_upwind --seeds 3

The whole station in virtual time with true shade maps, twenty minutes of one scenario, each seed
flown twice: with a survey that allows the move, and with one that does not. For each: the share of
the scored cells whose shade at a lead was in view (means of a forecast each minute), and the error
of the forecasts over all cells. Then each move: when, how far, and what it was to gain.
"""

import argparse
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from recon.model.units import NS_PER_S
from recon.score import Scenario, load_scenario
from recon.score.forecast_figures import SeenCells
from recon.score.run import StationRun
from recon.score.settings import SCORE
from recon.station.state.imager_motion import MoveUpwind

FOLDER = Path(__file__).parents[1] / "scenarios"
LEADS_S = (30.0, 60.0, 90.0)


@dataclass(frozen=True, slots=True)
class Flown:
    """Shares in view and Brier scores at `LEADS_S`, and the moves of one run."""

    seen: Sequence[float]
    brier: Sequence[float]
    moves: Sequence[MoveUpwind]


def flown(scenario: Scenario, seed: int, *, upwind: bool) -> Flown:
    """Return one run of the scenario, for as long as forecasts are scored."""
    survey = replace(scenario.survey, upwind_allowed=upwind)
    run = StationRun(replace(scenario, survey=survey), seed)
    moves: dict[int, MoveUpwind] = {}
    while run.now_s < SCORE.least_run_s:
        run.advance_a_second()
        newest = run.driver.station.upwind_moves.newest
        if newest is not None:
            moves[newest.begun_at_ns] = newest
    sums, method = run.shade_score.forecasts, scenario.methods.forecast
    seen, brier = [], []
    for lead_s in LEADS_S:
        everywhere = sums[method, lead_s, SeenCells.ALL]
        part = sums.get((method, lead_s, SeenCells.SEEN))
        seen.append(0.0 if part is None else part.cells / everywhere.cells)
        brier.append(everywhere.squares / everywhere.cells)
    return Flown(seen, brier, tuple(moves.values()))


def row(name: str, run: Flown) -> str:
    """Return a line of the table."""
    seen, brier = (" / ".join(f"{v:.2f}" for v in values) for values in (run.seen, run.brier))
    return f"| {name} | {seen} | {brier} |"


def mean(runs: Sequence[Flown]) -> Flown:
    """Return the means of several runs."""
    seen, brier = ([getattr(run, name) for run in runs] for name in ("seen", "brier"))
    return Flown(np.mean(seen, axis=0).tolist(), np.mean(brier, axis=0).tolist(), ())


def main() -> None:
    """Print a line for each seed with and without the move, the means, and the moves."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--scenario", default="wind-shift-upwind")
    parser.add_argument("--seeds", type=int, default=3)
    parser.add_argument("--first-seed", type=int, default=0)
    asked = parser.parse_args()
    scenario = load_scenario(FOLDER / f"{asked.scenario}.toml")
    leads = " / ".join(f"{lead_s:.0f}" for lead_s in LEADS_S)
    print(f"| {asked.scenario} | in view at {leads} s | Brier, all cells |\n| --- | --- | --- |")
    moving, staying = [], []
    for seed in range(asked.first_seed, asked.first_seed + asked.seeds):
        for runs, upwind in ((moving, True), (staying, False)):
            runs.append(flown(scenario, seed, upwind=upwind))
            words = "moves" if upwind else "stays"
            print(row(f"seed {seed}, {words}", runs[-1]), flush=True)
    print(row("mean, moves", mean(moving)))
    print(row("mean, stays", mean(staying)))
    for seed, run in enumerate(moving, asked.first_seed):
        for move in run.moves:
            at_min = move.begun_at_ns / NS_PER_S / 60.0
            end = f"{move.stage.value} {move.reason}".strip()
            print(f"seed {seed}, minute {at_min:.1f} ({end}): {move.proposal.sentence}")


if __name__ == "__main__":
    main()
