"""Shade methods on rendered frames, without the station: quick enough to develop with.

    python -m studies.shade --scenario cumulus-40 --seeds 0-4 --minutes 20
    python -m studies.shade --scenario cumulus-40 --exposure locked --pose telemetry
    python -m studies.shade --scenario cumulus-20 --earlier 10    what an earlier flight is worth

Frames are rendered at a small size, projected on the ground with the true pose (or telemetry's),
and kept in a temporary folder for the next call. Unknown cells count as wrong in the IoU. A method
named like `brightness_ratio:600` remembers so many seconds. What is lost by cause is the difference
between two calls: true pose or telemetry's, exposure locked or automatic, all minutes or `--after`,
and `--ceiling`: each map read at the transmittance that divides it best, as with the true level of
sun.

With `--earlier` the first minutes are a flight of their own: what it has learned is taken up by a
second one, which begins there, in one row, and not by the same one in the other.
"""

import argparse
import hashlib
import tempfile
import time
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from functools import lru_cache
from pathlib import Path
from typing import NamedTuple

import cv2
import numpy as np

from recon.camera import GroundProjector
from recon.detection import (
    DETECTORS,
    DetectionSettings,
    DetectionState,
    RejectedFrame,
    sunlit_reference_of,
)
from recon.model.geo import GroundGrid
from recon.model.imagery import CameraPose, GroundImage
from recon.model.shade import SUNLIT_TRANSMITTANCE, FloatMap, MaskMap, ShadeMap
from recon.model.units import seconds_to_ns
from recon.score.scenario import Scenario
from recon.score.scenario_file import load_scenario
from recon.score.shade_figures import ShadeFigures, map_figures
from recon.score.simulation import rig_of, simulation_of
from recon.sim.camera.field import FieldRenderer
from recon.sim.camera.frames import CameraView
from recon.sim.fleet import IMAGER_SERIAL

IMAGE_CELL_M, FIELD_CELL_M = 2.0, 4.0
FULL_COLS, FULL_ROWS = 1280, 720
CEILING_AT: tuple[float, ...] = tuple(np.arange(0.2, 0.82, 0.02).tolist())
"""Transmittances at which a map may be divided to show the ceiling."""
SERIAL = "SIM-IMAGER"


@lru_cache(maxsize=1)
def _renderer_digest() -> bytes:
    """Of the code and the scenarios that frames come from: another one renders anew."""
    project = Path(__file__).parents[1]
    rooms = [project / "src/recon" / room for room in ("sim", "camera", "geo", "score")]
    files = [file for room in rooms for file in room.rglob("*.py")]
    digest = hashlib.sha256()
    for file in sorted([*files, *(project / "scenarios").rglob("*.toml"), Path(__file__)]):
        digest.update(file.read_bytes())
    return digest.digest()


@dataclass(frozen=True, slots=True)
class Flight:
    """What is rendered; with the renderer's code the key of the cache."""

    scenario: str
    seed: int
    minutes: float
    exposure: str
    pose: str
    cols: int
    every_s: float

    @property
    def folder(self) -> Path:
        """The flight's folder in the cache."""
        key = hashlib.sha256(repr(self).encode() + _renderer_digest()).hexdigest()[:16]
        name = self.scenario.replace("/", "-")
        return Path(tempfile.gettempdir()) / "recon-shade" / f"{name}-{self.seed}-{key}"


@dataclass(frozen=True, slots=True, eq=False)
class Moment:
    """A ground image and the true transmittance on the field grid."""

    image: GroundImage
    transmittance: FloatMap


class Figures(NamedTuple):
    """A method's figures over the frames of a flight, or of one flight for each seed."""

    shade: ShadeFigures
    mixed_iou: float
    mixed_p10: float
    """Mean and 10th percentile over frames with 5 to 95 % shade."""
    first_right_min: float
    """When 90 % of the cells were first known and right; infinite if never."""
    mean_ms: float
    most_ms: float
    """Processor time of a frame."""


def frame_figures(
    found: ShadeMap | None, truth: FloatMap, counted: MaskMap, *, is_ceiling: bool
) -> ShadeFigures:
    """Return the figures of a frame's map; a rejected frame is unknown throughout."""
    if found is None:
        return map_figures(truth, np.zeros_like(counted), truth, counted, FIELD_CELL_M)
    read = map_figures(found.transmittance, found.valid, truth, counted, FIELD_CELL_M)
    if not is_ceiling:
        return read
    least = _best_division(found, (truth < SUNLIT_TRANSMITTANCE) & counted)
    moved = found.transmittance + np.float32(SUNLIT_TRANSMITTANCE - least)
    divided = map_figures(moved, found.valid, truth, counted, FIELD_CELL_M)
    return replace(divided, transmittance_error=read.transmittance_error)


def _best_division(found: ShadeMap, is_shade: MaskMap) -> float:
    """Return the transmittance that divides a map into sun and shade most as in truth."""

    def agreement(least: float) -> float:
        called = found.valid & (found.transmittance < least)
        return float((called & is_shade).sum() / max(1, (called | is_shade).sum()))

    return max(CEILING_AT, key=agreement)


def main() -> int:
    """Print a row per method, seed and scenario."""
    options = _options()
    names = options.scenario.split(",")
    missing = [name for name in names if not (Path("scenarios") / f"{name}.toml").exists()]
    if missing:
        print(f"expected names of files in scenarios/ without .toml, got {', '.join(missing)}")
        return 2
    cv2.setNumThreads(1)
    print(HEAD)
    for name in names:
        sums: dict[str, list[Figures]] = {}
        for seed in _numbers(options.seeds):
            flight = Flight(
                name, seed, options.minutes, options.exposure, options.pose, options.cols,
                options.every_s,
            )  # fmt: skip
            for method, row in _rows(flight, options):
                sums.setdefault(method, []).append(row)
                if not options.brief:
                    print(_row(f"{name} {seed}", method, row), flush=True)
        for method, rows in sums.items():
            print(_row(f"{name} all", method, _pooled(rows)), flush=True)
    return 0


def _rows(flight: Flight, options: argparse.Namespace) -> Iterator[tuple[str, Figures]]:
    """Yield each method's name and figures."""
    if options.earlier > 0.0:
        start_s = 60.0 * options.earlier
        yield "anew", score(flight, "sunlit_reference", start_s, start_s)
        known = _learned(flight, start_s)
        yield "knowing", score(flight, "sunlit_reference", start_s, start_s, known)
        return
    for method in options.methods.split(","):
        yield method, score(flight, method, 60.0 * options.after, is_ceiling=options.ceiling)


def _learned(flight: Flight, until_s: float) -> DetectionState:
    """Return what a later flight starts from: the reference of a flight's first minutes."""
    state, settings = DetectionState(), _settings(flight)
    for moment in moments(flight):
        if moment.image.captured_at_ns >= seconds_to_ns(until_s):
            break
        state, _ = DETECTORS["sunlit_reference"](state, moment.image, settings)
        image = moment.image
    reference = sunlit_reference_of(state, image)
    return DetectionState(references=() if reference is None else (reference,))


def _settings(flight: Flight) -> DetectionSettings:
    return DetectionSettings(cell_m=FIELD_CELL_M, follows_exposure=flight.exposure != "locked")


def score(
    flight: Flight,
    method: str,
    after_s: float = 0.0,
    begins_s: float = 0.0,
    state: DetectionState | None = None,
    is_ceiling: bool = False,
) -> Figures:
    """Return the figures of a method on a flight, over the frames after a time.

    The flight begins at a moment of what was rendered, in a state: by default, of knowing nothing.
    """
    name, _, window_s = method.partition(":")
    state, settings = state or DetectionState(), _settings(flight)
    if window_s:
        seconds = float(window_s)
        samples = round(seconds / settings.window_s * settings.samples)
        settings = replace(settings, window_s=seconds, samples=samples)
    total, ms, first_right_s = ShadeFigures(), list[float](), float("inf")
    for moment in moments(flight):
        at_ns = moment.image.captured_at_ns
        if at_ns < seconds_to_ns(begins_s):
            continue
        started = time.process_time()
        state, found = DETECTORS[name](state, moment.image, settings)
        ms.append(1e3 * (time.process_time() - started))
        if at_ns < seconds_to_ns(after_s):
            continue
        shade = None if isinstance(found, RejectedFrame) else found
        counted = _counted(moment)
        figures = frame_figures(shade, moment.transmittance, counted, is_ceiling=is_ceiling)
        total += figures
        if figures.unknown + figures.wrong <= 0.1 * figures.cells:
            first_right_s = min(first_right_s, at_ns / 1e9 - begins_s)
    mixed, ms = total.mixed_ious or (np.nan,), ms or [0.0]
    mean, p10 = float(np.mean(mixed)), float(np.quantile(mixed, 0.1))
    return Figures(total, mean, p10, first_right_s / 60.0, float(np.mean(ms)), max(ms))


HEAD = (
    f"{'scenario seed':22} {'method':18} {'IoU':>5} {'mixed':>5} {'p10':>5} {'false':>6} "
    f"{'missed':>6} {'wrong':>6} {'unkn':>6} {'T err':>6} {'90% min':>7} {'ms':>5} {'max':>5}"
)


def _row(label: str, method: str, row: Figures) -> str:
    found, cells = row.shade, row.shade.cells
    iou = found.shade.both / max(1, found.shade.either)
    error = found.transmittance_error / max(1, found.known)
    return (
        f"{label:22} {method:18} {iou:5.3f} {row.mixed_iou:5.3f} {row.mixed_p10:5.3f} "
        f"{found.false / cells:6.1%} {found.missed / cells:6.1%} {found.wrong / cells:6.1%} "
        f"{found.unknown / cells:6.1%} {error:6.3f} {row.first_right_min:7.1f} "
        f"{row.mean_ms:5.1f} {row.most_ms:5.1f}"
    )


def _pooled(rows: Sequence[Figures]) -> Figures:
    """Return the sum of the counts, the means of the rest, and the longest time of a frame."""
    counts = sum((row.shade for row in rows), ShadeFigures())
    means = (_mean(each) for each in zip(*(row[1:5] for row in rows), strict=True))
    return Figures(counts, *means, max(row.most_ms for row in rows))


def _mean(values: Sequence[float]) -> float:
    return float(np.nanmean(values)) if np.isfinite(values).any() else np.nan


def moments(flight: Flight) -> Iterator[Moment]:
    """Yield a flight's frames, rendered at the first call and read from the cache later."""
    path = flight.folder
    grid = _grid(flight)
    if not (path / "done").exists():
        path.mkdir(parents=True, exist_ok=True)
        for number, moment in enumerate(_rendered(flight, grid)):
            _write(path / f"{number:04}.npz", moment)
        (path / "done").touch()
    for file in sorted(path.glob("*.npz")):
        yield _read(file, grid)


def _write(path: Path, moment: Moment) -> None:
    image = moment.image
    _, png = cv2.imencode(".png", image.rgb, [cv2.IMWRITE_PNG_COMPRESSION, 1])
    np.savez(
        path, rgb=png, valid=np.packbits(image.valid), at_ns=image.captured_at_ns,
        number=image.frame_id, rotation=image.pose.rotation_enu_camera,
        position=image.pose.position_enu_m, sun=image.toward_sun_enu, locked=image.exposure_locked,
        truth=moment.transmittance.astype(np.float16),
    )  # fmt: skip


def _read(path: Path, grid: GroundGrid) -> Moment:
    with np.load(path) as kept:
        rgb = cv2.imdecode(kept["rgb"], cv2.IMREAD_UNCHANGED).astype(np.uint8)
        size = grid.rows * grid.cols
        valid = np.unpackbits(kept["valid"])[:size].reshape(grid.rows, grid.cols).astype(np.bool_)
        pose = CameraPose(kept["rotation"], kept["position"])
        image = GroundImage(
            grid, int(kept["number"]), int(kept["at_ns"]), rgb, valid, pose, serial=SERIAL,
            toward_sun_enu=kept["sun"], exposure_locked=bool(kept["locked"]),
        )  # fmt: skip
        return Moment(image, kept["truth"].astype(np.float32))


def _scenario(flight: Flight) -> Scenario:
    return load_scenario(Path("scenarios") / f"{flight.scenario}.toml")


def _grid(flight: Flight) -> GroundGrid:
    scenario = _scenario(flight)
    east_m, north_m = scenario.imager.over_m
    half = round(scenario.imager.radius_m / FIELD_CELL_M) * FIELD_CELL_M
    cells = round(2.0 * half / IMAGE_CELL_M)
    return GroundGrid(scenario.frame, east_m - half, north_m + half, IMAGE_CELL_M, cells, cells)


def _rendered(flight: Flight, grid: GroundGrid) -> Iterator[Moment]:
    scenario = _scenario(flight)
    renderer = _renderer(scenario, flight)
    projector = GroundProjector(grid, renderer.camera, renderer.image_circle)
    field = replace(grid, cell_m=FIELD_CELL_M, rows=grid.rows // 2, cols=grid.cols // 2)
    imager = scenario.site.imager
    assert imager is not None
    reported = rig_of(scenario.frame, imager).marked_pose
    for number in range(round(flight.minutes * 60.0 / flight.every_s)):
        at_s = flight.every_s * number
        view = CameraView(at_s, number, reported)
        pose = renderer.true_pose(view) if flight.pose == "true" else reported
        rgb, valid = projector.project_pixels(renderer.render(view), pose)
        image = GroundImage(
            grid, number, seconds_to_ns(at_s), rgb, valid, pose, serial=SERIAL,
            toward_sun_enu=renderer.sky.sun_at(at_s).toward_enu,
            exposure_locked=flight.exposure == "locked",
        )  # fmt: skip
        yield Moment(image, renderer.sky.on_grid(field, at_s))


def _renderer(scenario: Scenario, flight: Flight) -> FieldRenderer:
    setup = simulation_of(scenario, flight.seed).imagers[IMAGER_SERIAL]
    assert setup is not None
    renderer = setup.source
    assert isinstance(renderer, FieldRenderer)
    camera = renderer.camera.scaled_to(round(flight.cols * FULL_ROWS / FULL_COLS), flight.cols)
    circle = renderer.image_circle
    settings = renderer.imager
    if flight.exposure == "locked":
        locked = replace(settings.exposure, follows=0.0, drift_stops=0.0, white_balance=0.0)
        settings = replace(settings, exposure=locked)
    return FieldRenderer(
        camera,
        None if circle is None else circle.scaled(flight.cols / FULL_COLS),
        renderer.seed,
        renderer.sky,
        settings,
        renderer.relief,
        renderer.light,
    )


def _counted(moment: Moment) -> MaskMap:
    """Return the field's cells that the lens shows."""
    seen = cv2.resize(
        moment.image.valid.astype(np.uint8), moment.transmittance.shape[::-1],
        interpolation=cv2.INTER_NEAREST,
    )  # fmt: skip
    return seen > 0


def _numbers(text: str) -> list[int]:
    first, _, last = text.partition("-")
    return list(range(int(first), int(last or first) + 1))


def _options() -> argparse.Namespace:
    parser = argparse.ArgumentParser(description="Shade methods on rendered frames.")
    parser.add_argument("--scenario", default="cumulus-40", help="names, with commas")
    parser.add_argument("--seeds", default="0-4", help="first-last; 1000 and above are for scores")
    parser.add_argument("--minutes", type=float, default=20.0)
    parser.add_argument("--after", type=float, default=0.0, help="minutes that do not count")
    parser.add_argument("--earlier", type=float, default=0.0, help="minutes of an earlier flight")
    parser.add_argument("--ceiling", action="store_true", help="with the true level of sun")
    parser.add_argument("--every-s", type=float, default=5.0)
    parser.add_argument("--cols", type=int, default=640, help="width of the rendered frames")
    parser.add_argument("--exposure", choices=("auto", "locked"), default="auto")
    parser.add_argument("--pose", choices=("true", "telemetry"), default="true")
    parser.add_argument("--methods", default="sunlit_reference,brightness_ratio")
    parser.add_argument("--brief", action="store_true", help="only the rows of all seeds")
    return parser.parse_args()


if __name__ == "__main__":
    raise SystemExit(main())
