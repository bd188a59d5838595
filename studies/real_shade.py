"""Forecasts on real shade: a plant of 221 places, and 50 pyranometers, against other methods.

    RECON_DATA=... python -m studies.real_shade
    RECON_DATA=... python -m studies.real_shade --only plant-a --no-others

Each method sees maps between the places up to its moment, and is held against what the sensors
showed at 15, 30 and 60 s (20 s for 15 where values come each 10 s), each 30 s of an hour. In the
same run: persistence, climatology, pysteps (Lucas and Kanade's flow, semi-Lagrangian extrapolation)
and solarspatialtools (the newest map moved by its cloud motion vector of the last ten minutes). The
velocity of reference is that vector over the whole hour; which one is nearer the truth tells the
last column: how far maps moved by it for half a minute are off what the sensors then showed, over
maps at rest (mean squares). Last comes the time of a forecast of 128 x 128 cells with 21 leads on
one core. Neither baseline is given a prior: what comes from outside the map has the share in sun so
far.
"""

import argparse
import os
import sys
import time
import warnings
from collections.abc import Iterator, Mapping
from dataclasses import replace
from math import cos, hypot, nan, sin
from pathlib import Path

import cv2
import numpy as np
from tests.detection.shaded_field import DriftingShade
from tests.forecast.moving_shade import noisy_map

from recon.forecast import FORECASTERS, Forecaster, ForecastSettings, ForecastState
from recon.forecast.followed import with_recent
from recon.forecast.state import forecast_of, prior_sunlit, sunlit_now, with_map
from recon.light.points import LightPoints
from recon.model.arrays import FloatArray
from recon.model.shade import SURE, ShadeMap, SunForecast
from recon.model.units import NS_PER_S
from recon.score.forecast_figures import LeadScore, SeenCells
from recon.score.point_maps import PointMaps
from recon.score.point_verification import PointScores, verified_at_points
from recon.score.table_rows import NOTHING, fine, plain, table

PLANT_HOURS = "ace"
PLANT_STEP_S = 10
LEADS = 3
WINDOW_S, REFIT_S = 600.0, 300.0
FLOW_MAPS = 3
TIMED_LEADS_S = tuple(15.0 * number for number in range(21))
RUNS = 15
MOVED_S = 30.0

Velocity = tuple[float, float]


def hours(folder: Path) -> Iterator[tuple[str, LightPoints]]:
    """Yield each hour of real shade by name."""
    plant = np.load(folder / "pv-plant.npz")
    places = plant["east_m"], plant["north_m"]
    names = tuple(map(str, range(len(places[0]))))
    for hour in PLANT_HOURS:
        light = plant[f"hour_{hour}"].astype(np.float64)
        times_ns = np.arange(len(light), dtype=np.int64) * PLANT_STEP_S * NS_PER_S
        yield f"plant-{hour}", LightPoints(names, times_ns, light, *places, None)
    hope = np.load(folder / "hope-melpitz.npz")
    light = hope["ghi_wpm2"].astype(np.float64)
    names = tuple(map(str, range(light.shape[1])))
    times_ns = hope["time_unix_s"] * NS_PER_S
    yield "hope", LightPoints(names, times_ns, light, hope["east_m"], hope["north_m"], None)


def fitted(points: LightPoints, rows: slice = slice(None)) -> Velocity:
    """Return the cloud motion vector of solarspatialtools, east and north; NaN without one."""
    import pandas
    from solarspatialtools.cmv import compute_cmv

    index = points.light / np.nanpercentile(points.light, 98.0, axis=0)
    at = pandas.to_datetime(points.times_ns[rows])
    values = pandas.DataFrame(index[rows], index=at, columns=list(points.names))
    places = pandas.DataFrame({"e": points.east_m, "n": points.north_m}, index=list(points.names))
    with warnings.catch_warnings(action="ignore"):
        try:
            speed_mps, angle, *_ = compute_cmv(values, places)
        except (ValueError, IndexError):
            return nan, nan
    return float(speed_mps * cos(angle)), float(speed_mps * sin(angle))


def vector_method(points: LightPoints) -> Forecaster:
    """Return the newest map moved by the cloud motion vector of the last ten minutes."""
    fits: dict[int, Velocity] = {}

    def forecast(state: ForecastState, settings: ForecastSettings) -> SunForecast:
        at_s = (state.newest.captured_at_ns - int(points.times_ns[0])) / NS_PER_S
        number = int(at_s // REFIT_S)
        if number and number not in fits:
            end = round(number * REFIT_S / points.step_s)
            begin = max(0, end - round(WINDOW_S / points.step_s))
            fits[number] = fitted(points, slice(begin, end))
        velocity = fits.get(number, (nan, nan))
        east_mps, north_mps = np.nan_to_num(velocity)
        cell_m = state.newest.grid.cell_m
        flow = np.ones((2, *state.newest.valid.shape)) * np.array(
            [[[east_mps / cell_m]], [[-north_mps / cell_m]]]
        )
        claimed = None if np.isnan(velocity[0]) else velocity
        return _extrapolated(state, settings, flow, "solarspatialtools", claimed)

    return Forecaster(with_map, forecast)


def flow_method() -> Forecaster:
    """Return pysteps: the flow of the last maps, and the newest one moved along it."""
    from pysteps.motion import get_method

    def observed(
        state: ForecastState, shade: ShadeMap, settings: ForecastSettings
    ) -> ForecastState:
        return with_recent(with_map(state, shade, settings), shade, settings)

    def forecast(state: ForecastState, settings: ForecastSettings) -> SunForecast:
        recent = state.recent[-FLOW_MAPS:]
        flow = np.zeros((2, *state.newest.valid.shape))
        if len(recent) > 1:
            step_s = (recent[-1].captured_at_ns - recent[0].captured_at_ns) / NS_PER_S
            step_s /= len(recent) - 1
            frames = np.stack([np.where(one.valid, one.transmittance, nan) for one in recent])
            flow = get_method("LK")(frames, verbose=False) / step_s
        east, south = np.median(flow, axis=(1, 2)) * state.newest.grid.cell_m
        return _extrapolated(state, settings, flow, "pysteps", (float(east), float(-south)))

    return Forecaster(observed, forecast)


def _extrapolated(
    state: ForecastState,
    settings: ForecastSettings,
    flow: FloatArray,
    method: str,
    velocity_mps: Velocity | None,
) -> SunForecast:
    """Return the newest map moved along a flow (2, R, C) in cells a second, right and down."""
    from pysteps.nowcasts import get_method

    shade, prior = state.newest, prior_sunlit(state, settings)
    now = np.where(shade.valid, shade.transmittance, nan)
    later_s = list(settings.lead_s[1:])
    moved = get_method("extrapolation")(now, flow, later_s)
    chances = [sunlit_now(shade, prior, settings)]
    for values in moved:
        known = np.isfinite(values)
        direct = np.where(known, values, nan).astype(np.float32)
        there = replace(
            shade, transmittance=direct, valid=known, confidence=known.astype(np.float32)
        )
        chances.append(sunlit_now(there, prior, settings))
    levels = np.rint(np.stack(chances) * SURE).astype(np.uint8)
    return forecast_of(shade, settings, prior, method, levels, 0.0, velocity_mps)


def rows(
    name: str, points: LightPoints, methods: Mapping[str, Forecaster]
) -> list[tuple[str, ...]]:
    """Return an hour's rows of the table."""
    scores, truth = verified_at_points(points, methods), fitted(points)
    maps, nothing = PointMaps(points), (NOTHING,) * 6
    found: list[tuple[str, ...]] = [
        (name, "the hour's vector", *nothing, fine(moved_over_rest(maps, truth)))
    ]
    for method in methods:
        ratios = [_ratio(scores, method, lead_s) for lead_s in scores.leads_s[:LEADS]]
        claimed = [each for each in scores.velocities_mps[method] if each is not None]
        off_mps = [hypot(east - truth[0], north - truth[1]) for east, north in claimed]
        errors: tuple[str, ...] = (NOTHING,) * 4
        if off_mps:
            middle_mps = tuple(np.median(claimed, axis=0).tolist())
            off = plain(float(np.median(off_mps))), plain(max(off_mps))
            errors = *off, f"{len(claimed)}", fine(moved_over_rest(maps, middle_mps))
        found.append((name, method, *ratios, *errors))
    return found


def moved_over_rest(maps: PointMaps, velocity: Velocity) -> float:
    """Return the mean square error of maps moved for `MOVED_S`, over that of maps at rest."""
    points, (rows, cols) = maps.points, maps.cells
    later = round(MOVED_S / points.step_s)
    squares, east_cells = np.zeros(2), velocity[0] * MOVED_S / maps.grid.cell_m
    to_then = np.array([[1.0, 0.0, -east_cells], [0.0, 1.0, velocity[1] * MOVED_S]])
    to_then[1, 2] /= maps.grid.cell_m
    chosen = range(0, len(points.times_ns) - later, later)
    for number, shade in zip(chosen, maps.each(chosen), strict=True):
        direct, shape = shade.transmittance, shade.transmittance.shape[::-1]
        how = cv2.INTER_LINEAR | cv2.WARP_INVERSE_MAP
        moved = cv2.warpAffine(
            direct, to_then, shape, flags=how, borderMode=cv2.BORDER_CONSTANT, borderValue=nan
        )
        off = np.stack([each[rows, cols] for each in (moved, direct)]) - maps.direct[number + later]
        squares += np.square(off[:, np.isfinite(off).all(axis=0)]).sum(axis=1)
    return float(squares[0] / squares[1])


def _ratio(scores: PointScores, method: str, lead_s: float) -> str:
    ours, still = (
        scores.sums.get((each, lead_s, SeenCells.ALL), LeadScore()).brier
        for each in (method, "persistence")
    )
    return NOTHING if ours is None or not still else fine(ours / still)


def timed_s(method: Forecaster) -> float:
    """Return the median time of a map of 128 x 128 cells and its forecast of 21 leads."""
    drawn, settings = DriftingShade(5, 0.4, (5.0, 2.0)), ForecastSettings(lead_s=TIMED_LEADS_S)
    state, found = ForecastState(), []
    for number in range(RUNS):
        shade = noisy_map(drawn, 5.0 * number)
        begun = time.perf_counter()
        state = method.observed(state, shade, settings)
        method.forecast(state, settings)
        found.append(time.perf_counter() - begun)
    return float(np.median(found[RUNS // 2 :]))


def main() -> None:
    parser = argparse.ArgumentParser(description="Forecasts on real shade.")
    parser.add_argument("--only", help="One hour: plant-a, plant-c, plant-e or hope.")
    parser.add_argument("--no-others", action="store_true", help="Recon's methods alone.")
    options = parser.parse_args()
    if "RECON_DATA" not in os.environ:
        print("RECON_DATA names no folder with real-shade: not run")
        sys.exit(0)
    cv2.setNumThreads(1)
    found = []
    for name, points in hours(Path(os.environ["RECON_DATA"]) / "real-shade"):
        if options.only in (None, name):
            methods = dict(FORECASTERS)
            if not options.no_others:
                methods |= {"pysteps": flow_method(), "solarspatialtools": vector_method(points)}
            found += rows(name, points, methods)
    head = (
        "hour",
        "method",
        "15 (20) s",
        "30 s",
        "60 s",
        "off, m/s",
        "farthest",
        "claimed",
        "moved",
    )
    print("Brier over that of persistence, and the velocity off that of the whole hour:\n")
    print(table(head, found))
    ours_s = timed_s(FORECASTERS["advection"])
    print(f"\n128 x 128 cells, 21 leads: advection {1e3 * ours_s:.0f} ms", end="")
    if options.no_others:
        print()
        return
    flow_s = timed_s(flow_method())
    print(f", pysteps {1e3 * flow_s:.0f} ms: {flow_s / ours_s:.1f} times as fast")


if __name__ == "__main__":
    main()
