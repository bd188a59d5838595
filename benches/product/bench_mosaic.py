"""How long `recon mosaic` takes with photos of 20 megapixels, and how much memory.

    python -m benches.product.bench_mosaic --photos 200

Baseline: `oty odm` of orthority 0.7, which makes an orthophoto of each photo and no mosaic of them.
It runs as a program in an environment of its own, on the same photos with the same
cameras, surface model and pixel size. The photos are one noise texture, seen from above by cameras
in rows over level ground; that both agree is checked in the pictures.
"""

import argparse
import csv
import json
import os
import resource
import subprocess
import sys
import time
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory

import cv2
import numpy as np
import rasterio
from rasterio.transform import Affine
from rasterio.warp import reproject
from tests.product.made_flight import (
    FRAME,
    START_NS,
    UTC_AHEAD_NS,
    Rows,
    flight,
    write_photo,
    write_record,
)

from recon.model.units import NS_PER_S
from recon.product.footprint import Aim, PhotoView
from recon.record.raster.geotiff import projected_crs

COLS, ROWS_PX = 5472, 3648
HEIGHT_M, ACROSS_DEG = 60.0, 66.0
TEXTURE_PX, TEXEL_M = 4096, 0.02
CAMERA_ID = "made camera 5472 3648 perspective 0.77"
DSM_CELL_M, MARGIN_M = 0.5, 100.0
SURFACE = "odm_dem/dsm.tif"
FASTER, LEANER = 2.0, 0.5
AGREE_LEVELS = 8.0


@dataclass(frozen=True, slots=True)
class Run:
    """What a program took: seconds, and its peak memory in MB."""

    seconds: float
    peak_mb: float


def main() -> None:
    """Make the photos, run both, and print the ratios."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--photos", type=int, default=20)
    parser.add_argument("--folder", type=Path, help="Folder to keep; default: a temporary one.")
    parser.add_argument("--alone", action="store_true", help="Without the baseline.")
    options = parser.parse_args()
    with TemporaryDirectory() as name:
        folder = options.folder or Path(name)
        card, record, run = _made(folder, options.photos)
        preview = _timed(_recon("mosaic", record, card, "--out", folder / "preview"))
        print(f"preview: {preview.seconds:.0f} s, {preview.peak_mb:.0f} MB", flush=True)
        ours = _timed(
            _recon("mosaic", record, card, "--odm", run, "--raw", "--out", folder / "ours")
        )
        print(f"recon mosaic --odm: {ours.seconds:.0f} s, {ours.peak_mb:.0f} MB", flush=True)
        if options.alone:
            return
        with rasterio.open(folder / "ours" / "mosaic.tif") as dataset:
            pixel_m = dataset.transform.a
        orthority = _orthority(folder)
        theirs = _timed(
            [
                orthority,
                "odm",
                "-dd",
                str(run),
                "-c",
                str(run / SURFACE),
                "-r",
                f"{pixel_m:g}",
                "-o",
            ]
        )
        print(f"oty odm: {theirs.seconds:.0f} s, {theirs.peak_mb:.0f} MB", flush=True)
        off = _difference(folder / "ours" / "mosaic.tif", run / "orthority")
        print(f"levels that the pictures differ by, median: {off:.1f}")
        faster, leaner = theirs.seconds / ours.seconds, ours.peak_mb / theirs.peak_mb
        print(f"{faster:.1f} times as fast (wanted {FASTER:g}), with {leaner:.2f} of its memory "
              f"(wanted at most {LEANER:g})")  # fmt: skip
        assert off < AGREE_LEVELS
        assert faster >= FASTER
        assert leaner <= LEANER


def _recon(*words: object) -> list[str]:
    return [sys.executable, "-m", "recon", *map(str, words)]


def _timed(command: list[str]) -> Run:
    """Run a program; return what it took. Its peak is its own, of the children since the last."""
    began_s = time.perf_counter()
    process = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    _pid, status, usage = os.wait4(process.pid, 0)
    if status:
        raise SystemExit(f"{command[0]} ended with {os.waitstatus_to_exitcode(status)}")
    return Run(time.perf_counter() - began_s, usage.ru_maxrss / 1024.0)


def _made(folder: Path, count: int) -> tuple[Path, Path, Path]:
    """Write photos, record and the run's folder; return them. Photos of an earlier run stay."""
    way = Rows()
    folder.mkdir(parents=True, exist_ok=True)
    record = folder / "flight.mcap"
    if not record.exists():
        write_record(flight(way, maps_every_s=5.0), record)
    run = folder / "run"
    card = run / "images"
    card.mkdir(parents=True, exist_ok=True)
    moments_s = np.linspace(way.starts_s + 1.0, way.starts_s + way.lasts_s - 2.0, count)
    aims = {}
    for number, at_s in enumerate(moments_s.tolist()):
        east, north, yaw = (float(each) for each in way.place(at_s))
        name = f"DJI_{number:04d}.JPG"
        aims[name] = Aim(east, north, HEIGHT_M, yaw)
        if not (card / name).exists():
            _write_photo(card / name, aims[name], at_s)
    _write_run(run, aims)
    return card, record, run


def _write_photo(path: Path, aim: Aim, at_s: float) -> None:
    view = PhotoView(aim, ACROSS_DEG, COLS, ROWS_PX)
    texels = np.array(
        [
            [1.0 / TEXEL_M, 0.0, TEXTURE_PX / 2.0],
            [0.0, -1.0 / TEXEL_M, TEXTURE_PX / 2.0],
            [0.0, 0.0, 1.0],
        ]
    )
    pixels = cv2.warpPerspective(
        _texture(),
        texels @ view.homography,
        (COLS, ROWS_PX),
        flags=cv2.INTER_LINEAR | cv2.WARP_INVERSE_MAP,
        borderMode=cv2.BORDER_WRAP,
    )
    clock_ns = UTC_AHEAD_NS + START_NS + round(at_s * NS_PER_S)
    place = aim.east_m, aim.north_m
    write_photo(path, place_m=place, clock_ns=clock_ns, subsec="000", size=(COLS, 8))
    head = path.read_bytes()
    at = head.index(b"\xff\xe1")
    exif = head[at : at + 2 + int.from_bytes(head[at + 2 : at + 4])]
    body = cv2.imencode(".jpg", pixels, [cv2.IMWRITE_JPEG_QUALITY, 85])[1].tobytes()
    path.write_bytes(b"\xff\xd8" + exif + body[2:])


def _texture() -> np.ndarray:
    random = np.random.default_rng(1)
    coarse, fine = (
        cv2.resize(
            random.integers(0, 256, (TEXTURE_PX // by, TEXTURE_PX // by, 3), dtype=np.uint8),
            (TEXTURE_PX, TEXTURE_PX),
            interpolation=cv2.INTER_CUBIC,
        )
        for by in (64, 4)
    )
    return cv2.addWeighted(coarse, 0.6, fine, 0.3, 20.0)


def _write_run(run: Path, aims: dict[str, Aim]) -> None:
    """Write what a finished run of OpenDroneMap has, of the cameras as they were."""
    for part in ("opensfm", "odm_dem", "odm_georeferencing"):
        (run / part).mkdir(exist_ok=True)
    focal = 0.5 / np.tan(np.deg2rad(ACROSS_DEG / 2.0))
    camera = {"projection_type": "perspective", "width": COLS, "height": ROWS_PX}
    camera |= {"focal": focal, "k1": 0.0, "k2": 0.0}
    origin = FRAME.origin
    shots = {}
    for name, aim in aims.items():
        to_camera = aim.rotation.T
        place = np.array([aim.east_m, aim.north_m, aim.height_m])
        rotation = cv2.Rodrigues(to_camera)[0].ravel().tolist()
        translation = (-to_camera @ place).tolist()
        shots[name] = {"camera": CAMERA_ID, "rotation": rotation, "translation": translation}
    reference = {"latitude": origin.latitude_deg, "longitude": origin.longitude_deg}
    reference["altitude"] = origin.ellipsoid_height_m
    part = {"cameras": {CAMERA_ID: camera}, "shots": shots, "reference_lla": reference}
    (run / "cameras.json").write_text(json.dumps({CAMERA_ID: camera}))
    (run / "opensfm" / "reconstruction.json").write_text(json.dumps([part]))
    _write_surface(run / SURFACE, aims)


def _write_surface(path: Path, aims: dict[str, Aim]) -> None:
    # In a projection about the site: the baseline takes poses in it as they are, also in UTM, where
    # grid north is not true north.
    x, y = np.array([(aim.east_m, aim.north_m) for aim in aims.values()]).T
    west, north = np.floor(x.min() - MARGIN_M), np.ceil(y.max() + MARGIN_M)
    cols = int(np.ceil((x.max() + MARGIN_M - west) / DSM_CELL_M))
    rows = int(np.ceil((north - y.min() + MARGIN_M) / DSM_CELL_M))
    with rasterio.open(
        path, "w", driver="GTiff", width=cols, height=rows, count=1, dtype="float32",
        nodata=-9999.0, crs=projected_crs(FRAME), tiled=True, compress="deflate",
        transform=Affine(DSM_CELL_M, 0.0, west, 0.0, -DSM_CELL_M, north),
    ) as dataset:  # fmt: skip
        dataset.write(np.full((rows, cols), FRAME.origin.ellipsoid_height_m, np.float32), 1)


def _orthority(folder: Path) -> str:
    """Return the baseline's program, installed beside the photos."""
    place = folder / "orthority"
    if not (place / "bin" / "oty").exists():
        subprocess.run([sys.executable, "-m", "venv", "--clear", str(place)], check=True)
        python = str(place / "bin" / "python")
        install = [python, "-m", "pip", "install", "--quiet", "orthority==0.7.*"]
        subprocess.run(install, check=True)
    return str(place / "bin" / "oty")


def _difference(mosaic: Path, orthophotos: Path) -> float:
    """Return the median difference to the orthophoto of the photo that most is taken of."""
    with (mosaic.parent / "photos.csv").open(encoding="utf-8", newline="") as file:
        most = max(csv.DictReader(file), key=lambda row: float(row["taken_m2"]))
    (path,) = orthophotos.glob(f"{Path(most['name']).stem}*.tif")
    with rasterio.open(mosaic) as ours, rasterio.open(path) as theirs:
        found = np.zeros((theirs.height, theirs.width), dtype=np.uint8)
        alpha = np.zeros_like(found)
        for band, target in ((1, found), (4, alpha)):
            reproject(
                rasterio.band(ours, band), target, dst_crs=theirs.crs,
                dst_transform=theirs.transform, resampling=rasterio.enums.Resampling.bilinear,
            )  # fmt: skip
        both = (alpha == 255) & (theirs.dataset_mask() == 255)
        off = np.abs(found.astype(float) - theirs.read(1))[both]
    return float(np.median(off))


if __name__ == "__main__":
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
    main()
