"""Forecast figures as tables: the station's method by lead, and all methods side by side."""

from collections.abc import Callable, Mapping, Sequence
from math import isinf

from recon.score.change_figures import ChangeScore
from recon.score.forecast_figures import LeadScore, SeenCells
from recon.score.forecast_scoring import ForecastKey
from recon.score.interval import Interval, log_ratio, ratio
from recon.score.run_score import ScoredMaps
from recon.score.settings import SCORE
from recon.score.table_rows import (
    NOTHING,
    Row,
    fine,
    finest,
    plain,
    share,
    table,
)

Parts = Callable[[LeadScore], tuple[float, float]]
Text = Callable[[float], str]


def forecast_tables(runs: Sequence[ScoredMaps], own: str, against: str | None) -> list[str]:
    """Return the tables of the station's method, and of all methods if one is named to compare
    them with."""
    found = [_of_method(runs, own), _changes(runs)]
    if against is not None:
        methods = sorted({method for run in runs for method, _lead_s, _cells in run.forecasts})
        found += [_side_by_side(runs, methods, cells) for cells in SeenCells]
        found += [_against(runs, methods, against, cells) for cells in SeenCells]
    return found


def _brier(score: LeadScore) -> tuple[float, float]:
    return score.squares, score.cells


def _iou(score: LeadScore) -> tuple[float, float]:
    return score.shade.both, score.shade.either


def _calibration(score: LeadScore) -> tuple[float, float]:
    return score.calibration.error_sum, score.cells


def _head(first: str) -> Row:
    return (first, *(f"{lead_s:g} s" for lead_s in SCORE.lead_s))


def _of_method(runs: Sequence[ScoredMaps], method: str) -> str:
    figures: dict[str, tuple[Parts, Text]] = {"Brier": (_brier, finest), "shade IoU": (_iou, fine)}
    rows = [
        (
            f"cells {SeenCells.SEEN.value}, %",
            *(_seen_percent(runs, method, lead_s) for lead_s in SCORE.lead_s),
        )
    ]
    rows += [
        (f"{name}, {cells.value}", *_by_lead(runs, method, cells, parts, text))
        for name, (parts, text) in figures.items()
        for cells in SeenCells
    ]
    pooled = [_pooled(runs, method, lead_s) for lead_s in SCORE.lead_s]
    errors = [NOTHING if one.cells == 0 else fine(_share(_calibration(one))) for one in pooled]
    rows.append((f"calibration error, {SeenCells.SEEN.value}", *errors))
    return table(_head(f"forecast by {method}"), rows)


def _changes(runs: Sequence[ScoredMaps]) -> str:
    found = [run.changes for run in runs]

    error_s = sum(found, ChangeScore()).median_error_s
    error = NOTHING if error_s is None else plain(error_s)
    rows = [
        ("median error, s", error, NOTHING, f"{len(runs)}"),
        share("false alarms, %", [f.false_alarms for f in found], [f.predicted for f in found]),
        share("missed, %", [f.missed for f in found], [f.came for f in found]),
    ]
    return table(("time to shade, within the horizon", "figure", "95 %", "runs"), rows)


def _seen_percent(runs: Sequence[ScoredMaps], method: str, lead_s: float) -> str:
    seen = _pooled(runs, method, lead_s).cells
    whole = _pooled(runs, method, lead_s, SeenCells.ALL).cells
    return f"{100.0 * seen / whole:.0f}" if whole else NOTHING


def _pooled(
    runs: Sequence[ScoredMaps], method: str, lead_s: float, cells: SeenCells = SeenCells.SEEN
) -> LeadScore:
    """Return the score over all runs: reliability needs their cells together."""
    return sum((_score(run, method, lead_s, cells) for run in runs), LeadScore())


def _score(run: ScoredMaps, method: str, lead_s: float, cells: SeenCells) -> LeadScore:
    return run.forecasts.get((method, lead_s, cells), LeadScore())


def _share(parts: tuple[float, float]) -> float:
    return parts[0] / parts[1]


def _by_lead(
    runs: Sequence[ScoredMaps], method: str, cells: SeenCells, parts: Parts, text: Text
) -> list[str]:
    return [
        _text(text, ratio([parts(_score(run, method, lead_s, cells)) for run in runs]))
        for lead_s in SCORE.lead_s
    ]


def _text(text: Text, found: Interval | None) -> str:
    if found is None:
        return NOTHING
    mean = text(found.mean)
    return mean if isinf(found.high) else f"{mean} ({text(found.low)} to {text(found.high)})"


def _side_by_side(runs: Sequence[ScoredMaps], methods: Sequence[str], cells: SeenCells) -> str:
    rows = [(method, *_by_lead(runs, method, cells, _brier, finest)) for method in methods]
    return table(_head(f"Brier, {cells.value}"), rows)


def _against(
    runs: Sequence[ScoredMaps], methods: Sequence[str], against: str, cells: SeenCells
) -> str:
    rows = []
    for method in methods:
        if method != against:
            pairs = [
                [
                    (_score(run, method, s, cells).brier, _score(run, against, s, cells).brier)
                    for run in runs
                ]
                for s in SCORE.lead_s
            ]
            rows.append((method, *(_text(fine, log_ratio(each)) for each in pairs)))
    return table(_head(f"Brier over that of {against}, {cells.value}"), rows)


def leads_table(
    sums: Mapping[ForecastKey, LeadScore], methods: Sequence[str], scale: float = 1.0
) -> str | None:
    """Return figures of methods over recorded maps by lead; None where no lead was reached.

    `scale` is how many seconds of the maps a second of the methods stands for.
    """
    reached = {lead_s for method, lead_s, _cells in sums if method in methods}
    leads = sorted(reached)
    if not leads:
        return None
    head = tuple(f"{lead_s * scale:g} s" for lead_s in leads)
    figures: dict[str, tuple[Parts, Text]] = {"Brier": (_brier, finest), "shade IoU": (_iou, fine)}
    parts = []
    for title, (figure, text) in figures.items():
        rows = [
            (method, *(_of_sums(sums, method, lead_s, figure, text) for lead_s in leads))
            for method in methods
        ]
        parts.append(table((title, *head), rows))
    return "\n\n".join(parts)


def _of_sums(
    sums: Mapping[ForecastKey, LeadScore], method: str, lead_s: float, figure: Parts, text: Text
) -> str:
    part, of = figure(sums.get((method, lead_s, SeenCells.ALL), LeadScore()))
    return text(part / of) if of else NOTHING
