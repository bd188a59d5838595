"""The scenarios' skies against real shade: the same places, the same hour, the same figures.

    RECON_DATA=... python -m studies.real_sky
    RECON_DATA=... python -m studies.real_sky --scenario two-layers --skies 20

Half-shaded hours of a plant of 221 places and of 50 pyranometers, each beside skies of a scenario
sampled at its places and times. Lengths are times over a place times the shadows' speed (by
solarspatialtools), so that faster clouds do not look smaller. Of the skies, those of an hour's
cover count, within 10 %. In brackets: the skies' 10th and 90th percentile; a real figure outside
them, and more than 25 % off their median, is marked. Correlations are of the hour, so weather that
changes over it raises them. Edges are too short for a value each 10 s.
"""

import argparse
import os
from itertools import pairwise
from math import hypot
from pathlib import Path

import numpy as np
from tests.oracles.shadow_passages import edge_s

from recon.light.points import LightPoints
from recon.model.arrays import BoolArray, FloatArray
from recon.model.units import NS_PER_S
from recon.score.scenario_file import load_scenario
from recon.score.scenario_sky import drawn_layers, sky_of
from recon.score.table_rows import NOTHING, fine, table
from studies.real_shade import fitted, hours

DIFFUSE_SHARE = 0.25
"""Of the light in full sun, what shade leaves."""
SUNLIT_FROM = 0.5
SAME_COVER = 0.1
FEWEST_SKIES = 3
OFF_BY = 0.25
FIRST_SEED = 400
NAMES = (
    "shade, m",
    "between edges, m",
    "correlation 300 m later",
    "correlation 300 m apart",
    "20-80 % edge, m",
)
FAR_M, NEAR_M = 300.0, 60.0

Figures = tuple[float, ...]


def direct_share(points: LightPoints) -> FloatArray:
    """Return (T, P): the share of the direct sun, by each place's own brightest light."""
    index = points.light / np.nanpercentile(points.light, 98.0, axis=0)
    return np.clip((index - DIFFUSE_SHARE) / (1.0 - DIFFUSE_SHARE), 0.0, 1.0)


def figures(direct: FloatArray, points: LightPoints, speed_mps: float) -> Figures:
    """Return the figures of `NAMES` of the direct share (T, P); NaN where there is none."""
    step_m = points.step_s * speed_mps
    shades, edges, widths = [], 0, []
    for series in direct.T:
        lit = series >= SUNLIT_FROM
        turns = np.flatnonzero(lit[1:] != lit[:-1]) + 1
        edges += turns.size
        shades += [end - start for start, end in pairwise(turns.tolist()) if not lit[start]]
        bounds = [0, *turns.tolist(), series.size]
        if points.step_s <= 1.0:
            widths += [
                edge_s(series[before:after].astype(np.float32), turn - before)
                for before, turn, after in zip(bounds[:-2], bounds[1:-1], bounds[2:], strict=True)
                if min(turn - before, after - turn) >= 10
            ]
    along_m = direct.size * step_m
    return (
        float(np.median(shades)) * step_m if shades else np.nan,
        along_m / edges if edges else np.nan,
        _later(direct, round(FAR_M / step_m)),
        _apart(direct, points),
        float(np.median(widths)) * step_m if widths else np.nan,
    )


def _later(direct: FloatArray, steps: int) -> float:
    """Return the mean correlation of each place with itself some steps later."""
    off = np.asarray(direct - direct.mean(axis=0))
    return float((off[:-steps] * off[steps:]).mean() / (off**2).mean())


def _apart(direct: FloatArray, points: LightPoints) -> float:
    """Return the mean correlation of pairs of places about `FAR_M` apart."""
    together = np.atleast_2d(np.corrcoef(direct.T))
    far_m = np.hypot(
        points.east_m[:, np.newaxis] - points.east_m, points.north_m[:, np.newaxis] - points.north_m
    )
    return float(np.nanmean(together[np.abs(far_m - FAR_M) < NEAR_M]))


def simulated(scenario: str, points: LightPoints, cover: float, skies: int) -> list[Figures]:
    """Return the figures of skies with about an hour's cover, at its places and times."""
    chosen = load_scenario(Path(__file__).parents[1] / "scenarios" / f"{scenario}.toml")
    times_s = (points.times_ns - points.times_ns[0]) / NS_PER_S
    found = []
    for seed in range(FIRST_SEED, FIRST_SEED + skies):
        sky = sky_of(chosen, seed)
        east_m, north_m = (each - each.mean() for each in (points.east_m, points.north_m))
        rows = [
            sky.transmittance(east_m, north_m, part[:, np.newaxis])
            for part in np.array_split(times_s, max(1, len(times_s) // 300))
        ]
        direct = np.vstack(rows).astype(np.float64)
        if abs(float((direct < SUNLIT_FROM).mean()) - cover) <= SAME_COVER:
            layer = drawn_layers(chosen.clouds, seed)[0]
            found.append(figures(direct, points, layer.speed_mps))
    return found


def row(name: str, points: LightPoints, scenario: str, skies: int) -> tuple[str, ...]:
    """Return an hour's line: each real figure beside the skies'."""
    known: BoolArray = np.asarray(np.isfinite(points.light).all(axis=0))
    points = LightPoints(
        tuple(np.array(points.names)[known]),
        points.times_ns,
        points.light[:, known],
        points.east_m[known],
        points.north_m[known],
        None,
    )
    speed_mps, direct = hypot(*fitted(points)), direct_share(points)
    cover = float((direct < SUNLIT_FROM).mean())
    real, drawn = figures(direct, points, speed_mps), simulated(scenario, points, cover, skies)
    if len(drawn) < FEWEST_SKIES:
        return (name, f"{cover:.0%}", f"{speed_mps:.0f}", f"{len(drawn)}", *(NOTHING,) * len(real))
    cells = [_cell(value, others) for value, others in zip(real, np.array(drawn).T, strict=True)]
    return (name, f"{cover:.0%}", f"{speed_mps:.0f}", f"{len(drawn)}", *cells)


def _cell(value: float, others: FloatArray) -> str:
    if np.isnan(value) or np.isnan(others).all():
        return NOTHING
    low, middle, high = np.nanpercentile(others, [10.0, 50.0, 90.0])
    is_off = not low <= value <= high and abs(value / middle - 1.0) > OFF_BY
    text = fine if abs(middle) < 1.0 else "{:.0f}".format
    return f"{text(value)} / {text(middle)} ({text(low)} to {text(high)}){' *' if is_off else ''}"


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--scenario", default="cumulus-40")
    parser.add_argument("--skies", type=int, default=40)
    asked = parser.parse_args()
    folder = Path(os.environ["RECON_DATA"]) / "real-shade"
    rows = [row(name, points, asked.scenario, asked.skies) for name, points in hours(folder)]
    print(table(("hour: real / simulated", "in shade", "m/s", "skies", *NAMES), rows))


if __name__ == "__main__":
    main()
