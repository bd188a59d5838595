"""`recon tag`: the photos of a flight, and which of them are in sun."""

import sys
from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import islice
from pathlib import Path
from typing import Annotated

import typer

from recon.cli.json_lines import report_facts
from recon.cli.nodeodm import opened_node, process
from recon.cli.opened_flight import opened_flight
from recon.cli.options import with_options
from recon.cli.output import print_line, print_warning, printable
from recon.cli.photo_cards import (
    MOST_NAMED,
    CameraOptions,
    ReadCard,
    main_reason,
    read_card,
    reasons_of,
)
from recon.cli.progress import progress_over, usable_cores
from recon.cli.tag_all import FlightLight, tag_all
from recon.model.errors import RecordError
from recon.model.units import HECTARE_M2
from recon.product.flight import FlightData
from recon.product.odm import write_odm_project
from recon.product.panels import PANELS, PanelShot, panels_on_ground, picture_of, write_panels
from recon.product.photos.card import begin_own
from recon.product.quality import quality_of
from recon.product.registration import read_grey, with_headings
from recon.product.shot_files import MAIN, ShotFiles, files_of
from recon.product.sun_at import SunHistory
from recon.product.sun_sensor import (
    agreement,
    agreement_lines,
    agreement_of,
    map_and_sensor,
    sun_by_sensor,
)
from recon.product.tag import (
    SUNLIT_SHARE,
    PhotoTag,
    Selection,
    ground_of_flight,
    select,
    sun_history,
)
from recon.product.timing import TimedPhoto
from recon.product.write import fly_again, table, write_text

NO_PHOTO_TAGGED = 1


@dataclass(frozen=True, slots=True, kw_only=True)
class TagOptions:
    """A flight's record and photos, and which of these are kept."""

    images: Annotated[
        list[Path], typer.Argument(metavar="IMAGES...", help="Photos, or folders with them.")
    ]
    flight: Annotated[Path, typer.Option("--flight", help="The flight record (MCAP).")]
    out: Annotated[Path, typer.Option("--out", help="Folder to write.")] = Path("tagged")
    overlap: Annotated[
        float,
        typer.Option(min=0.0, max=0.95, help="Overlap wanted of the chosen photos, 0 to 0.95."),
    ] = 0.6
    sunlit: Annotated[
        float, typer.Option(min=0.5, max=1.0, help="Share in sun to call a photo sunlit.")
    ] = SUNLIT_SHARE
    sun_sensor: Annotated[
        bool,
        typer.Option(
            "--sun-sensor",
            help="Let the camera's sun sensor tell where shade maps know too little.",
        ),
    ] = False
    odm: Annotated[
        bool, typer.Option("--odm/--no-odm", help="Write the chosen photos for OpenDroneMap.")
    ] = True
    nodeodm: Annotated[
        str,
        typer.Option(
            metavar="URL", help="Let this NodeODM make the mosaic, as http://localhost:3000."
        ),
    ] = ""


@with_options
def tag_command(options: TagOptions, camera: CameraOptions) -> None:
    """Tag the photos of a flight: sunlit share, masks, the photos to keep, what to fly again."""
    node = opened_node(options.nodeodm) if options.nodeodm else None
    flight = opened_flight(options.flight)
    read = read_card(options.images, options.out)
    files, panels, refused = _files(read, flight, camera)
    if not files.photos:
        read.print_left_out(refused)
        print(printable(f"no photo was tagged: {main_reason(refused)}"), file=sys.stderr)
        raise typer.Exit(NO_PHOTO_TAGGED)
    light, both = _light(options, flight, files)
    tags, selection = _written(options, light, files, panels)
    quality = quality_of(flight, files)
    names = [each.photo.name for each in files.of(selection.chosen)]
    rows = table(flight, files, tags, names, refused, quality, options.sunlit, both)
    write_text(options.out / "tags.csv", rows)
    write_text(options.out / "chosen.txt", "".join(f"{name}\n" for name in names))
    write_text(options.out / "fly-again.geojson", fly_again(flight, selection))
    read.print_left_out(refused)
    _print_beside(files)
    _print_quality(quality)
    leading = [tags[each.photo.name] for each in files.leading]
    _print_summary(options.out, leading, selection, options.sunlit)
    if node is not None:
        process(node, options.out / MAIN)


def _files(
    read: ReadCard, flight: FlightData, camera: CameraOptions
) -> tuple[ShotFiles, list[PanelShot], dict[str, str]]:
    """Return the files with a pose, the panels, and why other files are neither."""
    timed = read.timed(flight, camera)
    timed.photos = _with_headings(timed.photos)
    files = files_of(timed.photos, read.shots, timed.refused, camera.field)
    off = [shot for shot in read.shots if shot.lead.name in timed.refused]
    panels = [*read.panels, *panels_on_ground(flight, off, picture_of)]
    kept_apart = {name: f"{why}: in {PANELS}" for name, why in reasons_of(panels).items()}
    return files, panels, {**read.refused, **timed.refused, **files.refused, **kept_apart}


def _light(
    options: TagOptions, flight: FlightData, files: ShotFiles
) -> tuple[FlightLight, dict[str, tuple[float, float]]]:
    """Return what is known of the sun, and the direct sun by shade maps and by sensor of each photo
    that has one, by name; print how both agree."""
    history = sun_history(flight, may_be_empty=options.sun_sensor)
    sensor = _sensor(flight, files, history)
    both = map_and_sensor(flight, files.leading, sensor, history)
    for line in agreement_lines(agreement_of(both.values())):
        print(line)
    if options.sun_sensor and not sensor:
        print_warning("--sun-sensor: no photo's sun sensor tells sun from shade")
    ground = ground_of_flight(flight, files.leading)
    counted = sensor if options.sun_sensor else {}
    return FlightLight(flight, history, ground, options.sunlit, counted), both


def _written(
    options: TagOptions, light: FlightLight, files: ShotFiles, panels: Sequence[PanelShot]
) -> tuple[dict[str, PhotoTag], Selection]:
    """Return tags and choice, with all written but the tables; raises `RecordError`."""
    out = options.out
    try:
        begin_own(out)
        for folder in (out / "masks", out / "xmp"):
            folder.mkdir(exist_ok=True)
        tags, shown = tag_all(out, files, light)
        selection = select(files.leading, shown, light.ground, options.overlap)
        if options.odm:
            _write_projects(out, light.flight, files, files.of(selection.chosen))
        if panels or (out / PANELS).exists():
            write_panels(out / PANELS, panels, min(each.photo.clock_ns for each in files.photos))
    except OSError as problem:
        # Of a copy that fails the first name is that of the photo.
        where = problem.filename2 or problem.filename or out
        raise RecordError(f"{where}: {problem.strerror}") from problem
    return tags, selection


def _print_quality(quality: Mapping[str, str]) -> None:
    """Print what speaks against photos, the first ones by name."""
    for name, reasons in islice(sorted(quality.items()), MOST_NAMED):
        print_line(f"poor: {name}: {reasons}")
    if len(quality) > MOST_NAMED:
        print(f"poor: {len(quality) - MOST_NAMED} more, in the column quality of tags.csv")


def _write_projects(
    out: Path, flight: FlightData, files: ShotFiles, chosen: Sequence[TimedPhoto]
) -> None:
    """Write a project of the chosen photos for each kind of file; raises OSError."""
    folders = files.folder_of_each()
    for folder in sorted(set(folders.values())):
        photos = [each for each in chosen if folders[each.photo.kind] == folder]
        if photos or (out / folder).exists():
            write_odm_project(out / folder, out / "masks", flight, photos)


def _with_headings(photos: Sequence[TimedPhoto]) -> list[TimedPhoto]:
    """Return the photos with the headings that their pictures show; print how they are known."""
    turned, headings = with_headings(photos, read_grey, progress_over, usable_cores())
    for each in headings:
        print_line(str(each))
        for warning in each.warnings:
            print_warning(warning)
    return turned


def _sensor(flight: FlightData, files: ShotFiles, history: SunHistory) -> dict[str, float]:
    """Return the direct sun by the camera's sun sensor; print how it agrees with the shade maps."""
    if all(each.photo.irradiance is None for each in files.photos):
        return {}
    sensor = sun_by_sensor(files)
    found = agreement(flight, files.leading, sensor, history)
    if not sensor:
        print("sun sensor: it saw only sun or only shade, or too little to tell which")
    elif found is None:
        print("sun sensor: the shade maps tell about too few of its photos to compare them")
    else:
        print(found)
    return sensor


def _print_beside(files: ShotFiles) -> None:
    """Print how many files stand beside the photos that lead their shots, and where they go."""
    folders = files.folder_of_each()
    beside = Counter(each.photo.kind for each in files.photos if not files.leads(each))
    for kind, count in beside.items():
        print(f"{count} {kind} files of the same shots: in {folders[kind]}")


def _print_summary(
    out: Path, tags: Sequence[PhotoTag], selection: Selection, sunlit: float
) -> None:
    states = Counter(tag.state(sunlit) for tag in tags)
    counts = ", ".join(
        f"{states[name]} {name}"
        for name in ("sunlit", "mixed", "shaded", "unknown")
        if states[name]
    )
    print(f"{len(tags)} photos: {counts}")
    by_light = {name: states[name] for name in ("sunlit", "mixed", "shaded", "unknown")}
    report_facts(counts={"photos": len(tags), **by_light})
    cells = len(selection.sunlit)
    in_sun = 100.0 * float((selection.sunlit > 0).mean()) if cells else 0.0
    print(
        f"{len(selection.chosen)} photos chosen, no list has fewer than {selection.bound}: "
        f"they show {in_sun:.1f} % of the ground in sun, on {selection.views} photos where there "
        "are as many"
    )
    area_m2 = sum(each.area for each in selection.again)
    report_facts(gaps={"area_m2": area_m2, "regions": len(selection.again)})
    if selection.again:
        area_ha = area_m2 / HECTARE_M2
        print(f"to fly again: {area_ha:.2f} ha in {len(selection.again)} regions")
    else:
        print("nothing to fly again")
    print(f"written to {out}")
