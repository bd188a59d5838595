"""`recon mosaic`: a mosaic of a flight's photos in which all ground is in sun."""

import shutil
import sys
from collections.abc import Iterator, Sequence
from contextlib import contextmanager, suppress
from ctypes import CDLL
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

import numpy as np
import typer

from recon.cli.json_lines import report_facts
from recon.cli.opened_flight import opened_flight
from recon.cli.options import with_options
from recon.cli.output import print_line, print_warning, printable
from recon.cli.photo_cards import (
    CameraOptions,
    main_reason,
    print_refused,
    read_card,
    reasons_of,
)
from recon.cli.progress import progress_over, usable_cores
from recon.geo import enu_from_points
from recon.model.errors import RecordError
from recon.model.geo import LocalFrame
from recon.model.units import HECTARE_M2
from recon.product.flight import FlightData
from recon.product.footprint import PhotoView
from recon.product.mosaic import (
    Camera,
    ChoiceSettings,
    LevelGround,
    Light,
    MosaicBand,
    MosaicBuild,
    MosaicGround,
    MosaicReport,
    MosaicSettings,
    SiteGround,
    opened_odm,
    placed_photos,
    plan_of,
    preview_cameras,
    read_jpeg,
)
from recon.product.mosaic.band_rasters import band_rasters
from recon.product.mosaic.pixels import Box, Pixels
from recon.product.mosaic.place import PREVIEW_PIXELS
from recon.product.photos.shots import CameraShot
from recon.product.sun_at import SunHistory
from recon.product.tag import sun_history
from recon.product.timing import TimedPhoto
from recon.site import load_site

MOST_THREADS = 2
"""More would decode more photos at once, 100 MB each."""
NO_PHOTO_USED = 1
M_MMAP_THRESHOLD, M_ARENA_MAX = -3, -8
"""Of glibc's malloc.h."""
SAME_ORIGIN_M = 0.1
"""Largest distance between the origins of a flight and of its site."""
COLOURS = ("red", "green", "blue")


@dataclass(frozen=True, slots=True, kw_only=True)
class MosaicOptions:
    """A flight's record and photos, where cameras and ground come from, and the picture."""

    flight: Annotated[Path, typer.Argument(metavar="FLIGHT", help="The flight record (MCAP).")]
    photos: Annotated[
        list[Path], typer.Argument(metavar="PHOTOS...", help="JPEG photos, or folders with them.")
    ]
    out: Annotated[Path, typer.Option("--out", help="Folder to write.")] = Path("mosaic")
    resolution_m: Annotated[
        float | None,
        typer.Option(
            help="Size of a pixel on the ground; default: the photos', without --odm four of them."
        ),
    ] = None
    site: Annotated[
        Path | None,
        typer.Option("--site", help="The site's folder: the ground's heights, if it has them."),
    ] = None
    odm: Annotated[
        Path | None,
        typer.Option(
            "--odm", help="Folder of a finished run of OpenDroneMap: cameras and surface model."
        ),
    ] = None
    fill: Annotated[
        bool, typer.Option("--fill", help="Take the least shaded photo where none is in sun.")
    ] = False
    raw: Annotated[
        bool,
        typer.Option("--raw", help="Keep brightness as photographed, not evened to full sun."),
    ] = False

    @property
    def settings(self) -> MosaicSettings:
        """The mosaic's settings, on this computer."""
        threads = min(MOST_THREADS, usable_cores())
        choice = ChoiceSettings(fills=self.fill)
        return MosaicSettings(choice, is_evened=not self.raw, threads=threads)


@with_options
def mosaic_command(options: MosaicOptions, camera: CameraOptions) -> None:
    """Make a mosaic of photos in sun, with what each pixel was taken from."""
    _return_memory()
    flight = opened_flight(options.flight)
    read = read_card(options.photos, options.out)
    timed = read.timed(flight, camera)
    read.print_left_out({**read.refused, **timed.refused, **reasons_of(read.panels)})
    if not timed.photos:
        print(
            printable(f"no photo is of this flight: {main_reason(timed.refused)}"), file=sys.stderr
        )
        raise typer.Exit(NO_PHOTO_USED)
    history = sun_history(flight)
    with _geometry(options, flight, timed.photos, read.shots) as found:
        report = _built(_build(options, flight, history, found))
    _print_report(options.out, report, options.settings)


def _return_memory() -> None:
    """Have arrays returned to the system when they are freed, where the C library is glibc.

    Otherwise each thread keeps tens of megabytes: a quarter of what a mosaic takes.
    """
    with suppress(OSError, AttributeError):
        libc = CDLL("libc.so.6")
        libc.mallopt(M_ARENA_MAX, 1)
        libc.mallopt(M_MMAP_THRESHOLD, 1024 * 1024)


@dataclass(frozen=True, slots=True, eq=False)
class _Geometry:
    """Photos with cameras over a ground, and where they come from in words."""

    photos: Sequence[TimedPhoto]
    cameras: Sequence[Camera]
    ground: MosaicGround
    bands: Sequence[MosaicBand]
    source: str
    pixels: float
    """Pixels of the photos, each way, in one of the mosaic, if no size is stated."""


@contextmanager
def _geometry(
    options: MosaicOptions,
    flight: FlightData,
    photos: Sequence[TimedPhoto],
    shots: Sequence[CameraShot],
) -> Iterator[_Geometry]:
    if options.odm is None:
        ground, name = site_ground(options.site, flight.frame)
        cameras = preview_cameras(flight, photos, _registered(photos), ground)
        bands = [*_colours(photos), *band_rasters(shots, photos, cameras)]
        source = f"photos registered to each other over {name}"
        yield _Geometry(photos, cameras, ground, bands, source, PREVIEW_PIXELS)
        return
    if options.site is not None:
        raise RecordError(
            "expected --odm or --site, got both: with --odm its surface is the ground"
        )
    with opened_odm(options.odm, flight.frame) as run:
        by_index = run.cameras(photos)
        if len(by_index) < len(photos):
            print_line(f"{len(photos) - len(by_index)} photos are not in {options.odm}: left out")
        placed = [photos[index] for index in by_index]
        source = f"OpenDroneMap's cameras and surface model in {options.odm.name}"
        cameras = list(by_index.values())
        yield _Geometry(placed, cameras, run.surface, _colours(placed), source, 1.0)


def site_ground(site: Path | None, frame: LocalFrame) -> tuple[MosaicGround, str]:
    """Return the ground of a flight with this frame, and what it is in words."""
    if site is None:
        return LevelGround(), "level ground"
    # Only read: a change that the station is making meanwhile is not for this command to undo.
    model = load_site(site).elevation
    if model is None:
        raise RecordError(f"{site}: expected a site with an [elevation], got none in its site.toml")
    place_m = enu_from_points(frame, [model.grid.frame.origin])
    if float(np.hypot(*place_m[0, :2])) > SAME_ORIGIN_M:
        print_warning(f"the flight is of another site than {site.name}: over level ground instead")
        return LevelGround(), "level ground"
    return SiteGround(model), "the site's elevation"


def _registered(photos: Sequence[TimedPhoto]) -> Sequence[PhotoView]:
    """Return the photos' views, registered to their neighbours; print how well."""

    # Imported here: a mosaic of OpenDroneMap's cameras has no need of it, nor room for it.
    from recon.product.registration import read_grey, register

    found = register(photos, read_grey, progress_over, usable_cores())
    for line in (*map(str, found.headings), *found.warnings):
        print_line(line)
    if found.links:
        print_line(
            f"{len(photos)} photos registered by {found.links} links, {found.residual_m:.2f} m "
            "typically left between two"
        )
    return found.views


def _colours(photos: Sequence[TimedPhoto]) -> list[MosaicBand]:
    """Return the raster in colour; none where a camera's bands lead its shots."""
    if photos[0].photo.kind == "band":
        return []

    def read(index: int, shrink: int, box: Box) -> Pixels:
        return read_jpeg(photos[index].photo.path, shrink, box)

    return [MosaicBand("mosaic", COLOURS, read)]


def _build(
    options: MosaicOptions, flight: FlightData, history: SunHistory, found: _Geometry
) -> MosaicBuild:
    settings = options.settings
    placed = placed_photos(
        found.photos, found.cameras, history, found.ground, progress_over, settings.threads
    )
    plan = plan_of(flight, placed, found.ground, options.resolution_m, found.pixels)
    return MosaicBuild(
        *(options.out, flight, placed, found.ground, plan, found.bands, settings),
        found.source,
        progress_over,
    )


def _built(build: MosaicBuild) -> MosaicReport:
    """Return the finished mosaic's report; raises `RecordError` where it cannot be written."""
    try:
        return build.run()
    except OSError as problem:
        free_mb = shutil.disk_usage(build.out).free // 1_000_000 if build.out.exists() else 0
        raise RecordError(
            f"{problem.filename or build.out}: cannot be written: {problem.strerror or problem}, "
            f"{free_mb} MB are free; what is finished is kept: the same command goes on from there"
        ) from problem


def _print_report(out: Path, report: MosaicReport, settings: MosaicSettings) -> None:
    print_refused(dict(report.failed))
    areas_m2 = {f"{light.name.lower()}_m2": report.areas_m2[light] for light in Light}
    report_facts(mosaic={"resolution_m": report.resolution_m, **areas_m2})
    print_line(
        f"{report.used} of {report.photos} photos make a mosaic of "
        f"{report.total_m2 / HECTARE_M2:.2f} ha, {100.0 * report.resolution_m:g} cm a pixel"
    )
    for light, text in (
        (Light.SUN, "in sun"),
        (Light.SHADE, "photographed in shade only"),
        (Light.UNKNOWN, "photographed in unknown light only"),
        (Light.MISSING, "on no photo"),
    ):
        area_ha = report.areas_m2[light] / HECTARE_M2
        print_line(f"{100.0 * report.share(light):5.1f} %  {area_ha:.2f} ha {text}")
    if settings.choice.fills:
        print_line(f"filled without sun: {report.filled_m2 / HECTARE_M2:.2f} ha")
    print_line(
        "brightness: "
        + ("evened to full sun by the shade maps" if settings.is_evened else "as photographed")
    )
    print_line(f"written to {out}")
