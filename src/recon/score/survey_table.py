"""Surveys of one planner, detection or scenario against those of another, seed by seed."""

from collections.abc import Sequence

from recon.score.interval import log_ratio
from recon.score.run_score import RunScore
from recon.score.table_rows import Row, fine, formatted, percent, row, table

LOST_FROM = 1.05
"""A seed counts as lost when the survey takes longer than this times the other."""


def survey_table(
    runs: Sequence[RunScore], others: Sequence[RunScore], against: str, limit_s: float
) -> str:
    """Return the ratios of `runs` over `others`, the runs with `against`, by seed.

    A survey that has not reached 95 % in sun within the limit counts as the limit. Ratios are
    geometric means over the seeds that both have flown, with 95 % intervals of the logarithms.
    """
    by_seed = {each.seed: each for each in others}
    pairs = [(each, by_seed[each.seed]) for each in runs if each.seed in by_seed]

    def in_sun_s(run: RunScore) -> float:
        return limit_s if run.to_95_in_sun_s is None else min(run.to_95_in_sun_s, limit_s)

    times = [(in_sun_s(one), in_sun_s(other)) for one, other in pairs]
    lost = [float(a > LOST_FROM * b) for a, b in times]
    rows: list[Row] = [
        formatted("time to 95 % in sun", log_ratio(times), fine),
        row("seeds lost by more than 5 %, %", lost, percent, 1.0),
        formatted("flight time", log_ratio([(a.flight_s, b.flight_s) for a, b in pairs]), fine),
        formatted("missions", log_ratio([(a.missions, b.missions) for a, b in pairs]), fine),
    ]
    return table((f"over {against}", "ratio", "95 %", "runs"), rows)
