"""Surveys of one planner, detection or scenario against those of another, seed by seed."""

from collections.abc import Sequence
from dataclasses import dataclass

from recon.score.interval import Interval, interval, log_ratio, ratio
from recon.score.run_score import RunScore
from recon.score.table_rows import fine, formatted, percent, table

LOST_FROM = 1.05
"""A seed counts as lost when the survey takes longer than this times the other."""


@dataclass(frozen=True, slots=True)
class SurveyRatios:
    """Surveys over others of the same seeds; None without a seed that both have flown."""

    time: Interval | None
    """Ratio of the times to 95 % in sun, the geometric mean of the seeds' ratios. A survey that has
    not reached it within the limit counts as the limit."""
    lost_share: Interval | None
    """Share of the seeds that took longer by more than `LOST_FROM`."""
    flight_time: Interval | None
    """Ratio over all seeds together: a seed in which nothing flies counts too, and has no ratio."""
    missions: Interval | None
    """Ratio over all seeds together."""


def survey_ratios(
    runs: Sequence[RunScore], others: Sequence[RunScore], limit_s: float
) -> SurveyRatios:
    """Return the ratios of `runs` over `others` over the seeds that both have flown."""
    by_seed = {each.seed: each for each in others}
    pairs = [(each, by_seed[each.seed]) for each in runs if each.seed in by_seed]

    def in_sun_s(run: RunScore) -> float:
        return limit_s if run.to_95_in_sun_s is None else min(run.to_95_in_sun_s, limit_s)

    times = [(in_sun_s(one), in_sun_s(other)) for one, other in pairs]
    return SurveyRatios(
        time=log_ratio(times),
        lost_share=interval([float(a > LOST_FROM * b) for a, b in times]),
        flight_time=ratio([(a.flight_s, b.flight_s) for a, b in pairs]),
        missions=ratio([(a.missions, b.missions) for a, b in pairs]),
    )


def survey_table(
    runs: Sequence[RunScore], others: Sequence[RunScore], against: str, limit_s: float
) -> str:
    """Return the ratios of `runs` over `others`, the runs with `against`, by seed."""
    found = survey_ratios(runs, others, limit_s)
    rows = [
        formatted("time to 95 % in sun", found.time, fine),
        formatted("seeds lost by more than 5 %, %", found.lost_share, percent, 1.0),
        formatted("flight time", found.flight_time, fine),
        formatted("missions", found.missions, fine),
    ]
    return table((f"over {against}", "ratio", "95 %", "runs"), rows)
