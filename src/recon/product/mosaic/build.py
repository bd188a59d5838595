"""Making a mosaic: photos chosen, windows rendered, rasters put together, results put in place."""

import csv
import io
import json
import warnings
from collections.abc import Callable, Iterator, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, field
from hashlib import sha256
from pathlib import Path
from typing import Any

import numpy as np
import rasterio
import shapely  # type: ignore[import-untyped, unused-ignore]
from rasterio.errors import NotGeoreferencedWarning

from recon import version
from recon.model.units import NS_PER_S
from recon.product.flight import FlightData
from recon.product.mosaic.choice import (
    STEP_PX,
    ChoiceSettings,
    Light,
    PlacedPhoto,
    choose_photos,
)
from recon.product.mosaic.ground import MosaicGround
from recon.product.mosaic.pixels import MosaicBand, PhotoCuts, shrink_for
from recon.product.mosaic.plan import MosaicPlan, MosaicWindow
from recon.product.mosaic.preview import preview_png
from recon.product.mosaic.render import Renderer, camera_for, taken_of
from recon.product.mosaic.windows import CACHE_BYTES, PROVENANCE, Raster, RasterBand, WindowStore
from recon.product.progress import Item, Over, plainly
from recon.record.files.atomic_file import replace_file

FILE_MODE = 0o644
PHOTOS, REPORT, PREVIEW = "photos.csv", "mosaic.json", "preview.png"
FAILED = "failed.json"


@dataclass(frozen=True, slots=True)
class MosaicSettings:
    """What a person may set."""

    choice: ChoiceSettings = field(default_factory=ChoiceSettings)
    is_evened: bool = True
    """Whether brightness is evened to full sun by the transmittance of the shade maps."""
    direct_share: float = 0.75
    """Share of the direct beam in a clear sky's light, as detection of shade has it."""
    threads: int = 2


@dataclass(frozen=True, slots=True, eq=False)
class MosaicReport:
    """What a mosaic shows; areas are of its plan's area, in square metres."""

    resolution_m: float
    areas_m2: Mapping[Light, float]
    filled_m2: float
    """Area without a photo in sun that was filled all the same."""
    photos: int
    used: int
    failed: Mapping[str, str]
    """Why a photo's pixels could not be read, by its name; other photos were taken."""
    decoded: int
    """How often a photo was decoded, all bands together."""

    @property
    def total_m2(self) -> float:
        """The whole area."""
        return sum(self.areas_m2.values())

    def share(self, light: Light) -> float:
        """Return a light's share of the area."""
        return self.areas_m2[light] / self.total_m2 if self.total_m2 else 0.0


@dataclass(slots=True)
class MosaicBuild:
    """One run: its inputs, and where it writes. `run` raises OSError."""

    out: Path
    flight: FlightData
    photos: Sequence[PlacedPhoto]
    ground: MosaicGround
    plan: MosaicPlan
    bands: Sequence[MosaicBand]
    settings: MosaicSettings
    geometry: str
    """Where cameras and ground come from, for the report."""
    over: Over = plainly
    _store: WindowStore = field(init=False)
    _failed: dict[int, str] = field(default_factory=dict)
    _decoded: int = 0

    def run(self) -> MosaicReport:
        """Make the mosaic; the files of an earlier one are replaced when all is complete."""
        self._store = WindowStore.begin(self.out, self.plan, self._key())
        windows = self.plan.windows()
        self._failed = self._read_failed()
        while True:
            self._choose(windows)
            failed = dict[int, str]()
            for band in self.bands:
                failed |= self._render(windows, band)
            if not failed:
                break
            self._leave_out(windows, failed)
        return self._finish(windows)

    def _choose(self, windows: Sequence[MosaicWindow]) -> None:
        todo = [each for each in windows if not self._store.has(each, "provenance")]
        tree = shapely.STRtree([photo.footprint for photo in self.photos])
        seconds = [self._seconds(photo) for photo in self.photos]

        def choose(window: MosaicWindow) -> None:
            near = tree.query(self.plan.box(window), predicate="intersects").tolist()
            candidates = [index for index in sorted(near) if index not in self._failed]
            east_m, north_m = self.plan.cells_m(window)
            inside = self.plan.inside(window)
            choice = choose_photos(
                self.photos, candidates, east_m, north_m, self.ground, inside, self.settings.choice
            )
            self._store.save_choice(window, choice, seconds)

        for _done in self._in_threads(choose, todo, "choosing photos"):
            pass

    def _render(self, windows: Sequence[MosaicWindow], band: MosaicBand) -> dict[int, str]:
        """Render the windows of a band that are not there yet; return why photos failed."""
        todo = [each for each in windows if not self._store.has(each, band.name)]
        if not todo:
            return {}
        choices = self._store.choices(todo)
        taken = taken_of(self.plan, choices, self.photos, self.ground, band)
        cuts = PhotoCuts(band.read, self._shrink(band), taken)
        share = self.settings.direct_share if self.settings.is_evened else None
        renderer = Renderer(self.plan, self.photos, self.ground, cuts, band, share)

        def render(numbered: tuple[int, MosaicWindow]) -> Mapping[int, str]:
            number, window = numbered
            picture, failed = renderer.window(number, window, self._store.choice(window))
            if not failed:
                turned = None if picture is None else np.moveaxis(picture, -1, 0)
                self._store.save(window, band.name, turned)
            return failed

        failed: dict[int, str] = {}
        for found in self._in_threads(render, list(enumerate(todo)), f"mosaic, {band.name}"):
            failed |= found
        self._decoded += cuts.decoded
        return failed

    def _in_threads(
        self, work: Callable[[Item], Any], items: Sequence[Item], title: str
    ) -> Iterator[Any]:
        with (
            # Photos have no place of their own.
            warnings.catch_warnings(action="ignore", category=NotGeoreferencedWarning),
            rasterio.Env(GDAL_CACHEMAX=CACHE_BYTES),
            ThreadPoolExecutor(self.settings.threads) as pool,
        ):
            try:
                yield from self.over(pool.map(work, items), title, len(items))
            except BaseException:
                pool.shutdown(cancel_futures=True)
                raise

    def _shrink(self, band: MosaicBand) -> int:
        low_m = self.ground.bounds_m[0]
        cameras = (camera_for(band, self.photos, index) for index in range(len(self.photos)))
        sizes_m = [each.metres_per_pixel(low_m) for each in cameras if each is not None]
        return shrink_for(self.plan.grid.cell_m / float(np.median(sizes_m)))

    def _leave_out(self, windows: Sequence[MosaicWindow], failed: Mapping[int, str]) -> None:
        """Forget the windows that took failed photos: they are chosen and rendered again."""
        self._failed |= failed
        names = {self.photos[index].timed.photo.name: why for index, why in self._failed.items()}
        replace_file(self._store.folder / FAILED, json.dumps(names).encode(), FILE_MODE)
        for window, choice in self._store.choices(windows):
            if not set(choice.indices()).isdisjoint(failed):
                self._store.drop(window)

    def _read_failed(self) -> dict[int, str]:
        path = self._store.folder / FAILED
        known = json.loads(path.read_bytes()) if path.exists() else {}
        names = {each.timed.photo.name: index for index, each in enumerate(self.photos)}
        return {names[name]: why for name, why in known.items()}

    def _finish(self, windows: Sequence[MosaicWindow]) -> MosaicReport:
        report, used_m2 = self._report(windows)
        tags = self._tags()
        rasters = [self._store.write_cog(PROVENANCE, windows, tags)]
        for band in self.over(self.bands, "writing rasters", len(self.bands)):
            rasters.append(self._store.write_cog(_raster(band), windows, tags))
        folder = self._store.folder
        replace_file(folder / PHOTOS, self._table(used_m2).encode(), FILE_MODE)
        replace_file(folder / REPORT, self._json(report).encode(), FILE_MODE)
        replace_file(folder / PREVIEW, preview_png(rasters[1]), FILE_MODE)
        for path in (*rasters, folder / PHOTOS, folder / REPORT, folder / PREVIEW):
            path.replace(self.out / path.name)
        self._store.finish()
        return report

    def _report(self, windows: Sequence[MosaicWindow]) -> tuple[MosaicReport, Mapping[int, float]]:
        """Return the report, and the area taken of each photo."""
        cells = dict.fromkeys(Light, 0)
        filled, used = 0, dict[int, int]()
        for _window, choice in self._store.choices(windows):
            for light in Light:
                cells[light] += int((choice.light == light).sum())
            is_taken = choice.photo >= 0
            filled += int((is_taken & (choice.light != Light.SUN)).sum())
            for index in choice.indices():
                used[index] = used.get(index, 0) + int((choice.photo == index).sum())
        cell_m2 = (self.plan.grid.cell_m * STEP_PX) ** 2
        names = {self.photos[index].timed.photo.name: why for index, why in self._failed.items()}
        report = MosaicReport(
            self.plan.grid.cell_m,
            {light: count * cell_m2 for light, count in cells.items()},
            filled * cell_m2,
            len(self.photos),
            len(used),
            names,
            self._decoded,
        )
        return report, {index: count * cell_m2 for index, count in used.items()}

    def _seconds(self, photo: PlacedPhoto) -> float:
        return (photo.timed.at_ns - self.flight.span_ns[0]) / NS_PER_S

    def _tags(self) -> dict[str, str]:
        choice = self.settings.choice
        evened = f"evened to full sun, direct beam {self.settings.direct_share:g} of its light"
        return {
            "RECON_FLIGHT_RECORD": self.flight.path.name,
            "RECON_START_UTC": self.flight.utc(self.flight.span_ns[0]),
            "RECON_GEOMETRY": self.geometry,
            "RECON_BRIGHTNESS": evened if self.settings.is_evened else "as photographed",
            "RECON_TRANSMITTANCE_MARGIN": f"{choice.margin:g}",
            "RECON_SHADE": "least shaded photo" if choice.fills else "empty",
            "RECON_VERSION": version(),
        }

    def _json(self, report: MosaicReport) -> str:
        value = {
            "format": "recon-mosaic",
            "version": 1,
            "resolution_m": report.resolution_m,
            "provenance_resolution_m": report.resolution_m * STEP_PX,
            "areas_m2": {
                light.name.lower(): round(area, 1) for light, area in report.areas_m2.items()
            },
            "filled_m2": round(report.filled_m2, 1),
            "photos": report.photos,
            "photos_used": report.used,
            "photos_not_read": dict(report.failed),
            "bands": [band.name for band in self.bands],
            **{name.lower(): text for name, text in self._tags().items()},
        }
        return json.dumps(value, indent=1) + "\n"

    def _table(self, used_m2: Mapping[int, float]) -> str:
        out = io.StringIO()
        rows = csv.writer(out, lineterminator="\n")
        rows.writerow(("number", "name", "file", "vehicle", "utc", "taken_m2"))
        for index, placed in enumerate(self.photos):
            timed = placed.timed
            name, path = (
                f"'{text}" if text[:1] in "=+-@\t\r" else text
                for text in (timed.photo.name, str(timed.photo.path))
            )
            utc = self.flight.utc(timed.at_ns)
            rows.writerow((index, name, path, timed.serial, utc, f"{used_m2.get(index, 0.0):.1f}"))
        return out.getvalue()

    def _key(self) -> str:
        """Return what tells runs with other inputs apart."""
        digest = sha256(f"{version()} {self.settings} {self.plan.grid} {self.geometry}".encode())
        digest.update(shapely.to_wkb(self.plan.area))
        files = [photo.timed.photo.path for photo in self.photos]
        for path in (self.flight.path, *files):
            stat = path.stat()
            digest.update(f"{path} {stat.st_size} {stat.st_mtime_ns}".encode())
        for photo in self.photos:
            camera = photo.camera
            digest.update(f"{photo.timed.at_ns} {camera.lens} {camera.cols} {camera.rows}".encode())
            digest.update(camera.place_m.tobytes() + camera.rotation.tobytes())
        return digest.hexdigest()[:16]


def _raster(band: MosaicBand) -> Raster:
    """Return a band's raster: a picture has alpha, another band 0 where nothing is.

    Programs that calculate with bands leave out what is no data, and know nothing of alpha.
    """
    colours = ("Red", "Green", "Blue") if len(band.channels) == 3 else ("Gray",)
    bands = [
        RasterBand(name, colour=colour) for name, colour in zip(band.channels, colours, strict=True)
    ]
    if not band.is_picture:
        return Raster(band.name, bands, band.dtype, nodata=0)
    alpha = RasterBand("alpha: 0 where the mosaic is empty", colour="Alpha")
    return Raster(band.name, [*bands, alpha], band.dtype)
