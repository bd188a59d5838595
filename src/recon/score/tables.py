"""The figures of several runs as tables in Markdown."""

from collections.abc import Callable, Sequence
from math import inf, isinf

from recon.score.forecast_figures import HorizonCells, LeadScore
from recon.score.interval import Interval, interval, pooled_quantile, ratio, times
from recon.score.run_score import RunScore
from recon.score.scenario import Scenario
from recon.score.settings import SCORE
from recon.score.shade_figures import Overlap

Row = tuple[str, ...]
Parts = Callable[[LeadScore], tuple[float, float]]
NOTHING = "-"
"""For a figure that no run has."""


def tables(scenario: Scenario, runs: Sequence[RunScore]) -> str:
    """Return all figures of survey, shade and forecast; the order of the runs does not matter."""
    runs = sorted(runs, key=lambda each: each.seed)
    parts = [_head(scenario, runs), _survey(scenario, runs), _shade(runs)]
    if any(each.leads for each in runs):
        parts.append(_forecast(runs))
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
        _time("time to 95 % imaged, min", [r.to_95_imaged_s for r in runs], limit_s),
        _time("time to 95 % in sun, min", [r.to_95_in_sun_s for r in runs], limit_s),
    ]
    for index, minute in enumerate(m for m in SCORE.curve_min if 60.0 * m <= limit_s):
        shares = [r.in_sun_share[index] for r in runs]
        rows.append(_row(f"in sun after {minute:g} min, %", shares, _percent, 1.0))
    rows += [
        _row(
            "counted in sun, but on no photo in sun, %",
            _of(runs, "wrongly_in_sun_share"),
            _percent,
            1.0,
        ),
        _row("until all drones have landed, min", _of(runs, "survey_s"), _minutes),
        _row("flight time of all drones, min", _of(runs, "flight_s"), _minutes),
        _row("missions", _of(runs, "missions"), _plain),
        _row("photos on rows", _of(runs, "photos"), _plain),
        _row("photos in shade, %", _of(runs, "shaded_share"), _percent, 1.0),
        _row("violations: separation under 10 m", _of(runs, "encounters"), _plain),
        _row("violations: landed below battery reserve", _of(runs, "low_landings"), _plain),
        _row("violations: outside the fence", _of(runs, "breaches"), _plain),
        _row("orders refused by the gate", _of(runs, "refusals"), _plain),
    ]
    return _table(("survey", "mean", "95 %", "runs"), rows)


def _shade(runs: Sequence[RunScore]) -> str:
    figures = [run.shade for run in runs]
    edges = [figure.edges for figure in figures if figure.edges.true_area]
    cells = [figure.cells for figure in figures]
    shaded = [figure.shaded for figure in figures]
    lit = [figure.cells - figure.shaded for figure in figures]
    known = [figure.known for figure in figures]
    places = [run.registration_m for run in runs if run.registration_m is not None]
    longest_s = max((run.simulated_s for run in runs), default=0.0)

    def share(name: str, parts: Sequence[float], of: Sequence[float]) -> Row:
        return _formatted(name, ratio(list(zip(parts, of, strict=True))), _percent, 1.0)

    rows = [
        _overlaps("shade IoU", [f.shade for f in figures]),
        _overlaps("shade IoU, maps with 5 to 95 % shade", [f.mixed for f in figures]),
        _formatted(
            "shade IoU, 10th percentile of these maps",
            pooled_quantile([f.mixed_ious for f in figures], 0.1),
            _fine,
            1.0,
        ),
        share("false shade, % of cells in sun", [f.false for f in figures], lit),
        share("missed shade, % of cells in shade", [f.missed for f in figures], shaded),
        share("called wrongly, %", [f.wrong for f in figures], cells),
        share("unknown, %", [f.unknown for f in figures], cells),
        _formatted(
            "transmittance, mean absolute error",
            ratio([(f.transmittance_error, n) for f, n in zip(figures, known, strict=True)]),
            _fine,
        ),
        _formatted("boundary error, m", ratio([(e.area_distance, e.area) for e in edges]), _plain),
        _time("time until 90 % is right, min", [run.to_right_s for run in runs], longest_s),
        _row("registration error, median, m", [each[0] for each in places], _fine),
        _row("registration error, 95th percentile, m", [each[1] for each in places], _fine),
        share("scored ground in shade, %", shaded, cells),
    ]
    return _table(("shade", "figure", "95 %", "runs"), rows)


def _overlaps(name: str, overlaps: Sequence[Overlap]) -> Row:
    return _formatted(name, ratio([(each.both, each.either) for each in overlaps]), _fine, 1.0)


def _forecast(runs: Sequence[RunScore]) -> str:
    head = ("forecast", *(f"{lead_s / 60.0:g} min" for lead_s in SCORE.lead_s))
    rows = [
        (f"cells, {ahead.value}, %", *(_cells(runs, lead_s, ahead) for lead_s in SCORE.lead_s))
        for ahead in HorizonCells
    ]
    figures: dict[str, Parts] = {
        "Brier": lambda score: (score.squares, score.cells),
        "shade IoU": lambda score: (score.shade.both, score.shade.either),
    }
    for name, parts in figures.items():
        for ahead in HorizonCells:
            cells = [_lead(runs, lead_s, ahead, parts) for lead_s in SCORE.lead_s]
            rows.append((f"{name}, {ahead.value}", *cells))
    return _table(head, rows)


def _lead(runs: Sequence[RunScore], lead_s: float, ahead: HorizonCells, parts: Parts) -> str:
    scores = [run.leads.get((lead_s, ahead)) for run in runs]
    found = ratio([parts(score) for score in scores if score is not None])
    if found is None:
        return NOTHING
    mean = _fine(found.mean)
    return mean if isinf(found.high) else f"{mean} ({_fine(found.low)} to {_fine(found.high)})"


def _cells(runs: Sequence[RunScore], lead_s: float, ahead: HorizonCells) -> str:
    def cells(which: HorizonCells) -> int:
        return sum(
            score.cells for run in runs if (score := run.leads.get((lead_s, which))) is not None
        )

    return (
        f"{100.0 * cells(ahead) / cells(HorizonCells.ALL):.0f}"
        if cells(HorizonCells.ALL)
        else NOTHING
    )


def _of(runs: Sequence[RunScore], name: str) -> list[float | None]:
    return [getattr(run, name) for run in runs]


def _row(
    name: str, values: Sequence[float | None], text: Callable[[float], str], most: float = inf
) -> Row:
    return _formatted(name, interval(values), text, most)


def _formatted(
    name: str, found: Interval | None, text: Callable[[float], str], most: float = inf
) -> Row:
    if found is None:
        return name, NOTHING, NOTHING, "0"
    return name, text(found.mean), _bounds(found, text, most), f"{found.count}"


def _time(name: str, values: Sequence[float | None], limit_s: float) -> Row:
    found = times(values, limit_s)
    if found is None:
        return name, NOTHING, NOTHING, "0"
    is_cut = found.reached < found.count
    mean = ("at least " if is_cut else "") + _minutes(found.mean.mean)
    reached = f"{found.reached} of {found.count} within the limit"
    return name, mean, _bounds(found.mean, _minutes, limit_s), reached


def _bounds(found: Interval, text: Callable[[float], str], most: float) -> str:
    """Return the interval, cut to the range of the figure: 0 to `most`."""
    if found.high == inf:
        return NOTHING
    return f"{text(max(found.low, 0.0))} to {text(min(found.high, most))}"


def _plain(value: float) -> str:
    return f"{value:.1f}"


def _fine(value: float) -> str:
    return f"{value:.2f}"


def _percent(value: float) -> str:
    return f"{100.0 * value:.1f}"


def _minutes(value: float) -> str:
    return f"{value / 60.0:.1f}"


def _table(head: Row, rows: Sequence[Row]) -> str:
    lines = [head, ("---",) * len(head), *rows]
    return "\n".join(f"| {' | '.join(line)} |" for line in lines)
