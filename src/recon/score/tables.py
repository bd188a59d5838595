"""The figures of several runs as tables in Markdown."""

from collections.abc import Sequence

from recon.score.forecast_tables import forecast_tables
from recon.score.interval import pooled_quantile, ratio
from recon.score.run_score import RunScore, ScoredMaps
from recon.score.scenario import Scenario
from recon.score.settings import SCORE
from recon.score.shade_figures import Overlap
from recon.score.table_rows import (
    Row,
    fine,
    formatted,
    minutes,
    percent,
    plain,
    row,
    share,
    table,
    time,
)


def tables(scenario: Scenario, runs: Sequence[RunScore], against: str | None = None) -> str:
    """Return all figures of survey, shade and forecast; the order of the runs does not matter.

    `against` names the forecast that the others are compared with.
    """
    runs = sorted(runs, key=lambda each: each.seed)
    parts = [_head(scenario, runs), _survey(scenario, runs)]
    if scenario.methods.scores_maps:
        parts.append(shade_table(runs))
    if any(each.forecasts for each in runs):
        parts += forecast_tables(runs, scenario.methods.forecast, against)
    return "\n\n".join(parts)


def _head(scenario: Scenario, runs: Sequence[RunScore]) -> str:
    methods, survey = scenario.methods, scenario.survey
    return (
        f"{scenario.name}: {scenario.about}\n"
        f"detection {methods.detection}, forecast {methods.forecast}, planner {survey.planner}; "
        f"{len(runs)} seeds"
    )


def _survey(scenario: Scenario, runs: Sequence[RunScore]) -> str:
    limit_s = scenario.limit_s
    rows = [
        time("time to 95 % imaged, min", [r.to_95_imaged_s for r in runs], limit_s),
        time("time to 95 % in sun, min", [r.to_95_in_sun_s for r in runs], limit_s),
    ]
    for index, minute in enumerate(m for m in SCORE.curve_min if 60.0 * m <= limit_s):
        shares = [r.in_sun_share[index] for r in runs]
        rows.append(row(f"in sun after {minute:g} min, %", shares, percent, 1.0))
    rows += [
        share(
            "counted in sun, but on no photo in sun, %",
            [each.wrongly_in_sun for each in runs],
            [each.counted_in_sun for each in runs],
        ),
        row("until all drones have landed, min", _of(runs, "survey_s"), minutes),
        row("flight time of all drones, min", _of(runs, "flight_s"), minutes),
        row("missions", _of(runs, "missions"), plain),
        row("photos on rows", _of(runs, "photos"), plain),
        row("photos in shade, %", _of(runs, "shaded_share"), percent, 1.0),
        row("violations: separation under 10 m", _of(runs, "encounters"), plain),
        row("violations: landed below battery reserve", _of(runs, "low_landings"), plain),
        row("violations: outside the fence", _of(runs, "breaches"), plain),
        row("orders refused by the gate", _of(runs, "refusals"), plain),
        formatted(
            "orders refused by the gate, for each mission",
            ratio([(each.refusals, each.missions) for each in runs]),
            fine,
        ),
        row("stopped by the station's watchdogs", _of(runs, "holds"), plain),
    ]
    return table(("survey", "mean", "95 %", "runs"), rows)


def shade_table(runs: Sequence[ScoredMaps]) -> str:
    """Return the figures of shade maps and poses."""
    figures = [run.shade for run in runs]
    edges = [figure.edges for figure in figures if figure.edges.true_area]
    cells = [figure.cells for figure in figures]
    shaded = [figure.shaded for figure in figures]
    lit = [figure.cells - figure.shaded for figure in figures]
    known = [figure.known for figure in figures]
    places = [run.registration_m for run in runs if run.registration_m is not None]
    longest_s = max((run.simulated_s for run in runs), default=0.0)

    rows = [
        _overlaps("shade IoU", [f.shade for f in figures]),
        _overlaps("shade IoU, maps with 5 to 95 % shade", [f.mixed for f in figures]),
        formatted(
            "shade IoU, 10th percentile of these maps",
            pooled_quantile([f.mixed_ious for f in figures], 0.1),
            fine,
            1.0,
        ),
        share("false shade, % of cells in sun", [f.false for f in figures], lit),
        share("missed shade, % of cells in shade", [f.missed for f in figures], shaded),
        share("called wrongly, %", [f.wrong for f in figures], cells),
        share("unknown, %", [f.unknown for f in figures], cells),
        formatted(
            "transmittance, mean absolute error",
            ratio([(f.transmittance_error, n) for f, n in zip(figures, known, strict=True)]),
            fine,
        ),
        formatted("boundary error, m", ratio([(e.area_distance, e.area) for e in edges]), plain),
        time("time until 90 % is right, min", [run.to_right_s for run in runs], longest_s),
        row("registration error, median, m", [each[0] for each in places], fine),
        row("registration error, 95th percentile, m", [each[1] for each in places], fine),
        share("scored ground in shade, %", shaded, cells),
    ]
    return table(("shade", "figure", "95 %", "runs"), rows)


def _overlaps(name: str, overlaps: Sequence[Overlap]) -> Row:
    return formatted(name, ratio([(each.both, each.either) for each in overlaps]), fine, 1.0)


def _of(runs: Sequence[RunScore], name: str) -> list[float | None]:
    return [getattr(run, name) for run in runs]
