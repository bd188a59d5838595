"""The files of surveyed regions: rows, camera and when each cell was imaged; one a region and way.

A file is untrusted input: every number has a range, every list and array a limit, and a file that
violates one is not used. Arrays are deflated; the length they inflate to is known beforehand.
"""

import zlib
from collections.abc import Sequence
from datetime import datetime
from pathlib import Path
from typing import Annotated

import msgspec
import numpy as np
import numpy.typing as npt

from recon.model.airspace import Region
from recon.model.arrays import BoolArray, FloatArray
from recon.model.flown_before import KeptLattice
from recon.model.flown_region import FlownRegion, SecondsArray
from recon.model.geo import GeoPoint, GroundGrid, LocalFrame
from recon.model.methods import NAME
from recon.model.survey import Survey, SurveyBudget, SurveyCamera, WhenDone
from recon.record.files.atomic_file import replace_file
from recon.record.files.checked_file import CheckedFormat

FORMAT = CheckedFormat("recon-flown-region", "file of a surveyed region", 1, 64 * 1024 * 1024)
SUFFIX = ".json"
MOST_FILES = 100
"""The newest are read: a site has a few regions, each flown in one or two ways."""
MOST_CELLS = 4_000_000
"""As many as a survey may have."""
MOST_CORNERS = 100_000
MOST_HOLES = 1_000

Metres = Annotated[float, msgspec.Meta(ge=-1e6, le=1e6)]
Number = Annotated[float, msgspec.Meta(ge=0.0, le=1e6)]
Seconds = Annotated[int, msgspec.Meta(ge=0, le=2**32 - 1)]
Text = Annotated[str, msgspec.Meta(max_length=200)]
Ring = Annotated[list[tuple[Metres, Metres]], msgspec.Meta(min_length=3, max_length=MOST_CORNERS)]


class _Survey(msgspec.Struct, frozen=True, kw_only=True):
    """The survey as it was asked for, without the vehicles' serials."""

    region_name: Annotated[str, msgspec.Meta(min_length=1, max_length=200)]
    name: Text
    outline_m: Ring
    holes_m: Annotated[list[Ring], msgspec.Meta(max_length=MOST_HOLES)] = msgspec.field(
        default_factory=list
    )
    height_above_takeoff_m: Number | None = None
    height_above_ground_m: Number | None = None
    speed_mps: Number
    across_deg: Annotated[float, msgspec.Meta(ge=5.0, le=150.0)]
    along_deg: Annotated[float, msgspec.Meta(ge=5.0, le=150.0)]
    interval_s: Number
    across_px: Annotated[int, msgspec.Meta(ge=2, le=100_000)] | None = None
    front_overlap: Number
    side_overlap: Number
    row_bearing_deg: Annotated[float, msgspec.Meta(ge=-360.0, le=360.0)] | None = None
    planner: Text
    rounds: Annotated[int, msgspec.Meta(ge=1, le=1_000_000)]
    time_s: Number | None = None
    flown_m: Number | None = None
    counts_neighbours: bool = False
    cell_m: Annotated[float, msgspec.Meta(ge=0.5, le=50.0)]
    when_done: WhenDone
    side_step_allowed: bool = False
    upwind_allowed: bool = False
    relief_allowed: bool = False


class _Lattice(msgspec.Struct, frozen=True):
    """`KeptLattice`, within ranges."""

    bearing_deg: Annotated[float, msgspec.Meta(ge=0.0, lt=180.0)]
    first_row_m: Metres
    spacing_m: Annotated[float, msgspec.Meta(ge=0.1, le=10_000.0)]
    rows: Annotated[int, msgspec.Meta(ge=1, le=100_000)]
    first_mark_m: Metres


class _Region(msgspec.Struct, frozen=True, kw_only=True):
    """A surveyed region; arrays by row from the north-west, bits packed, times as u32."""

    survey: _Survey
    lattice: _Lattice
    latitude_deg: Annotated[float, msgspec.Meta(ge=-90.0, le=90.0)]
    longitude_deg: Annotated[float, msgspec.Meta(ge=-180.0, le=180.0)]
    ellipsoid_height_m: Annotated[float, msgspec.Meta(ge=-1_000.0, le=10_000.0)]
    west_m: Metres
    north_m: Metres
    rows: Annotated[int, msgspec.Meta(ge=1, le=MOST_CELLS)]
    cols: Annotated[int, msgspec.Meta(ge=1, le=MOST_CELLS)]
    is_reached: bytes
    is_light_known: bytes
    imaged_s: bytes
    in_sun_s: bytes
    begun_s: Seconds
    started_s: Seconds
    is_simulated: bool


def day_of(moment_s: int) -> str:
    """Return the day of a moment in seconds since 1970, by the computer's calendar."""
    return datetime.fromtimestamp(moment_s).date().isoformat()


def encode_region(region: FlownRegion) -> bytes:
    """Return the content of a region's file; raises OSError for one that is too large."""
    grid, origin, lattice = region.grid, region.grid.frame.origin, region.lattice
    payload = _Region(
        survey=_saved(region.survey),
        lattice=_Lattice(
            lattice.bearing_deg,
            lattice.first_row_m,
            lattice.spacing_m,
            lattice.rows,
            lattice.first_mark_m,
        ),
        latitude_deg=origin.latitude_deg,
        longitude_deg=origin.longitude_deg,
        ellipsoid_height_m=origin.ellipsoid_height_m,
        west_m=grid.west_m,
        north_m=grid.north_m,
        rows=grid.rows,
        cols=grid.cols,
        is_reached=_deflated(np.packbits(region.is_reached)),
        is_light_known=_deflated(np.packbits(region.is_light_known)),
        imaged_s=_deflated(region.imaged_s.astype("<u4")),
        in_sun_s=_deflated(region.in_sun_s.astype("<u4")),
        begun_s=region.begun_s,
        started_s=region.started_s,
        is_simulated=region.is_simulated,
    )
    return FORMAT.encode(msgspec.json.encode(payload))


def decode_region(payload: bytes) -> FlownRegion:
    """Return the region of a checked payload; raises ValueError for anything out of range."""
    try:
        read = msgspec.json.decode(payload, type=_Region)
    except (msgspec.DecodeError, UnicodeError, RecursionError, OverflowError) as problem:
        raise ValueError(str(problem)) from problem
    if read.rows * read.cols > MOST_CELLS:
        raise ValueError(f"expected up to {MOST_CELLS} cells, got {read.rows} x {read.cols}")
    if not NAME.fullmatch(read.survey.planner):
        raise ValueError(f"expected the name of a planner, got {read.survey.planner!a:.80}")
    shape = read.rows, read.cols
    origin = GeoPoint(read.latitude_deg, read.longitude_deg, read.ellipsoid_height_m)
    kept = read.lattice
    return FlownRegion(
        _survey(read.survey),
        KeptLattice(
            kept.bearing_deg, kept.first_row_m, kept.spacing_m, kept.rows, kept.first_mark_m
        ),
        GroundGrid(
            LocalFrame(origin), read.west_m, read.north_m, read.survey.cell_m, read.rows, read.cols
        ),
        _bits(read.is_reached, shape),
        _bits(read.is_light_known, shape),
        _times(read.imaged_s, shape),
        _times(read.in_sun_s, shape),
        read.begun_s,
        read.started_s,
        read.is_simulated,
    )


def write_region(folder: Path, region: FlownRegion) -> None:
    """Replace a region's file in a folder; raises OSError."""
    content = encode_region(region)
    folder.mkdir(parents=True, exist_ok=True, mode=0o700)
    replace_file(folder / f"{region.key}{SUFFIX}", content)


def read_regions(folder: Path) -> tuple[tuple[FlownRegion, ...], tuple[str, ...]]:
    """Return the surveyed regions of a folder, and a sentence for each file that is not used."""
    found: list[FlownRegion] = []
    troubles: list[str] = []
    for path in _newest(folder, troubles):
        try:
            region = decode_region(FORMAT.read(path))
            if path.stem != region.key:
                raise ValueError("its name is not that of its content: it was renamed or changed")
        except (OSError, ValueError) as problem:
            reason = problem.strerror if isinstance(problem, OSError) else str(problem)
            troubles.append(f"surveyed region {path} not used: {reason}")
            continue
        found.append(region)
    return tuple(found), tuple(troubles)


def _newest(folder: Path, troubles: list[str]) -> Sequence[Path]:
    try:
        dated = [(path.stat().st_mtime, path) for path in folder.glob(f"*{SUFFIX}")]
    except OSError as problem:
        troubles.append(f"surveyed regions of {folder} not used: {problem.strerror}")
        return ()
    if len(dated) > MOST_FILES:
        troubles.append(
            f"{folder} has {len(dated)} surveyed regions; the newest {MOST_FILES} are used"
        )
    return [path for _, path in sorted(dated, reverse=True)[:MOST_FILES]]


def _saved(survey: Survey) -> _Survey:
    camera, budget = survey.camera, survey.budget
    return _Survey(
        region_name=survey.region_name or "",
        name=survey.name[:200],
        outline_m=_ring(survey.region.outline_m),
        holes_m=[_ring(hole_m) for hole_m in survey.region.holes_m],
        height_above_takeoff_m=survey.height_above_takeoff_m,
        height_above_ground_m=survey.height_above_ground_m,
        speed_mps=survey.speed_mps,
        across_deg=camera.across_deg,
        along_deg=camera.along_deg,
        interval_s=camera.interval_s,
        across_px=camera.across_px,
        front_overlap=survey.front_overlap,
        side_overlap=survey.side_overlap,
        row_bearing_deg=survey.row_bearing_deg,
        planner=survey.planner,
        rounds=budget.rounds,
        time_s=budget.time_s,
        flown_m=budget.flown_m,
        counts_neighbours=survey.counts_neighbours,
        cell_m=survey.cell_m,
        when_done=survey.when_done,
        side_step_allowed=survey.side_step_allowed,
        upwind_allowed=survey.upwind_allowed,
        relief_allowed=survey.relief_allowed,
    )


def _survey(saved: _Survey) -> Survey:
    return Survey(
        id=0,
        name=saved.name,
        region=Region(
            np.array(saved.outline_m), tuple(np.array(hole_m) for hole_m in saved.holes_m)
        ),
        height_above_takeoff_m=saved.height_above_takeoff_m,
        speed_mps=saved.speed_mps,
        camera=SurveyCamera(saved.across_deg, saved.along_deg, saved.interval_s, saved.across_px),
        front_overlap=saved.front_overlap,
        side_overlap=saved.side_overlap,
        row_bearing_deg=saved.row_bearing_deg,
        planner=saved.planner,
        budget=SurveyBudget(saved.rounds, saved.time_s, saved.flown_m),
        counts_neighbours=saved.counts_neighbours,
        cell_m=saved.cell_m,
        when_done=saved.when_done,
        side_step_allowed=saved.side_step_allowed,
        upwind_allowed=saved.upwind_allowed,
        relief_allowed=saved.relief_allowed,
        height_above_ground_m=saved.height_above_ground_m,
        region_name=saved.region_name,
    )


def _ring(ring_m: FloatArray) -> list[tuple[float, float]]:
    return [(float(east_m), float(north_m)) for east_m, north_m in ring_m]


def _deflated(array: npt.NDArray[np.generic]) -> bytes:
    return zlib.compress(array.tobytes(), 1)


def _inflated(data: bytes, size: int) -> bytes:
    """Inflate what is known to become `size` bytes; one more is never made."""
    try:
        inflater = zlib.decompressobj()
        found = inflater.decompress(data, size + 1)
    except zlib.error as problem:
        raise ValueError("an array of cells is damaged") from problem
    if len(found) != size or not inflater.eof:
        raise ValueError(f"expected an array of cells of {size} bytes, got another length")
    return found


def _bits(data: bytes, shape: tuple[int, int]) -> BoolArray:
    count = shape[0] * shape[1]
    packed = np.frombuffer(_inflated(data, (count + 7) // 8), dtype=np.uint8)
    return np.unpackbits(packed, count=count).astype(np.bool_).reshape(shape)


def _times(data: bytes, shape: tuple[int, int]) -> SecondsArray:
    count = shape[0] * shape[1]
    return np.frombuffer(_inflated(data, 4 * count), dtype="<u4").astype(np.uint32).reshape(shape)
