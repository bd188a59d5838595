"""`recon tag`: the photos of a flight, and which of them are in sun."""

import sys
from collections import Counter
from collections.abc import Iterable, Iterator, Mapping, Sequence
from itertools import islice
from pathlib import Path
from typing import Annotated

import typer

from recon.cli.nodeodm import opened_node, process
from recon.cli.opened_flight import opened_flight
from recon.cli.output import printable
from recon.cli.progress import progress_over, usable_cores
from recon.cli.tag_all import FlightLight, tag_all
from recon.cli.tag_cards import (
    MOST_NAMED,
    print_clocks,
    print_grouped,
    print_left,
    print_refused,
    read_photos,
    refuse_photos_below,
    warn,
)
from recon.model.errors import RecordError
from recon.model.units import HECTARE_M2
from recon.product.flight import FlightData
from recon.product.odm import write_odm_project
from recon.product.panels import (
    PANELS,
    PanelShot,
    marked_panels,
    panels_on_ground,
    picture_of,
    write_panels,
)
from recon.product.photos.card import begin_own, card_of
from recon.product.photos.shots import CameraShot, shots_of
from recon.product.quality import quality_of
from recon.product.registration import read_grey, with_headings
from recon.product.shot_files import MAIN, ShotFiles, files_of
from recon.product.sun_at import SunHistory
from recon.product.sun_sensor import agreement, sun_by_sensor
from recon.product.tag import (
    SUNLIT_SHARE,
    PhotoTag,
    Selection,
    ground_of_flight,
    select,
    sun_history,
)
from recon.product.timing import StatedCamera, TimedPhoto, timed_photos
from recon.product.write import (
    fly_again,
    table,
    write_text,
)

MOST_OFF_S = 1e9
"""Largest offset of a camera's clock: thirty years, as after an empty battery."""
NO_PHOTO_TAGGED = 1


def tag_command(
    images: Annotated[
        list[Path], typer.Argument(metavar="IMAGES...", help="Photos, or folders with them.")
    ],
    flight: Annotated[Path, typer.Option("--flight", help="The flight record (MCAP).")],
    out: Annotated[Path, typer.Option("--out", help="Folder to write.")] = Path("tagged"),
    overlap: Annotated[
        float,
        typer.Option(min=0.0, max=0.95, help="Overlap wanted of the chosen photos, 0 to 0.95."),
    ] = 0.6,
    sunlit: Annotated[
        float, typer.Option(min=0.5, max=1.0, help="Share in sun to call a photo sunlit.")
    ] = SUNLIT_SHARE,
    field: Annotated[
        float | None,
        typer.Option(min=10.0, max=120.0, help="Camera's field along the longer side, degrees."),
    ] = None,
    clock_offset: Annotated[
        float | None,
        typer.Option(
            min=-MOST_OFF_S,
            max=MOST_OFF_S,
            help="Seconds to add to the camera's clock for UTC; default: estimated.",
        ),
    ] = None,
    sun_sensor: Annotated[
        bool,
        typer.Option(
            "--sun-sensor",
            help="Let the camera's sun sensor tell where shade maps know too little.",
        ),
    ] = False,
    nodeodm: Annotated[
        str,
        typer.Option(
            metavar="URL", help="Let this NodeODM make the mosaic, as http://localhost:3000."
        ),
    ] = "",
) -> None:
    """Tag the photos of a flight: sunlit share, masks, the photos to keep, what to fly again."""
    node = opened_node(nodeodm) if nodeodm else None
    card = card_of(images)
    refuse_photos_below(out, card.photos)
    flown = opened_flight(flight)
    photos, refused = read_photos(card.photos)
    shots = shots_of(photos)
    panels = marked_panels(shots)
    shots = _without(shots, panels)
    timed = timed_photos(flown, [shot.lead for shot in shots], StatedCamera(clock_offset, field))
    print_grouped("", {each.name: note for each in photos for note in each.notes})
    print_clocks(timed)
    timed.photos = _with_headings(timed.photos)
    files = files_of(timed.photos, shots, timed.refused, field)
    panels += panels_on_ground(
        flown, [shot for shot in shots if shot.lead.name in timed.refused], picture_of
    )
    refused |= timed.refused | files.refused | _names_of(panels)
    if not timed.photos:
        print_left(card)
        print_refused(refused)
        print("no photo was tagged", file=sys.stderr)
        raise typer.Exit(NO_PHOTO_TAGGED)
    history = sun_history(flown, may_be_empty=sun_sensor)
    sensor = _sensor(flown, files, history)
    if sun_sensor and not sensor:
        warn("--sun-sensor: no photo's sun sensor tells sun from shade")
    try:
        begin_own(out)
        for folder in (out / "masks", out / "xmp"):
            folder.mkdir(exist_ok=True)
        ground = ground_of_flight(flown, timed.photos)
        light = FlightLight(flown, history, ground, sunlit, sensor if sun_sensor else {})
        tags, shown = tag_all(out, files, light)
        selection = select(timed.photos, shown, ground, overlap)
        chosen = files.of(selection.chosen)
        _write_projects(out, flown, files, chosen)
        if panels or (out / PANELS).exists():
            write_panels(out / PANELS, panels, min(each.photo.clock_ns for each in files.photos))
    except OSError as problem:
        # Of a copy that fails the first name is that of the photo.
        where = problem.filename2 or problem.filename or out
        raise RecordError(f"{where}: {problem.strerror}") from problem
    names = [each.photo.name for each in chosen]
    quality = quality_of(flown, files)
    write_text(out / "tags.csv", table(flown, files, tags, names, refused, quality, sunlit))
    write_text(out / "chosen.txt", "".join(f"{name}\n" for name in names))
    write_text(out / "fly-again.geojson", fly_again(flown, selection))
    print_left(card)
    print_refused(refused)
    _print_beside(files)
    _print_quality(quality)
    leading = [tags[each.photo.name] for each in timed.photos]
    _print_summary(out, leading, selection, sunlit)
    if node is not None:
        process(node, out / MAIN)


def _without(shots: Sequence[CameraShot], panels: Sequence[PanelShot]) -> list[CameraShot]:
    taken = {panel.shot.lead.name for panel in panels}
    return [shot for shot in shots if shot.lead.name not in taken]


def _names_of(panels: Sequence[PanelShot]) -> dict[str, str]:
    """Return why the files of panels are not tagged, by name."""
    return {
        photo.name: f"shows a reflectance panel, by {panel.found_by}: in {PANELS}"
        for panel in panels
        for photo in panel.shot.files
    }


def _print_quality(quality: Mapping[str, str]) -> None:
    """Print what speaks against photos, the first ones by name."""
    for name, reasons in islice(sorted(quality.items()), MOST_NAMED):
        print(f"poor: {name}: {reasons}")
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

    def over(read: Iterable[TimedPhoto]) -> Iterator[TimedPhoto]:
        few = list(read)
        return progress_over(few, "registering neighbours", len(few))

    turned, headings = with_headings(photos, read_grey, over, usable_cores())
    for each in headings:
        print(printable(str(each)))
        for warning in each.warnings:
            warn(warning)
    return turned


def _sensor(flight: FlightData, files: ShotFiles, history: SunHistory) -> dict[str, float]:
    """Return the direct sun by the camera's sun sensor; print how it agrees with the shade maps."""
    if all(each.photo.irradiance is None for each in files.photos):
        return {}
    sensor = sun_by_sensor(files)
    leads = [each for each in files.photos if files.leads(each)]
    found = agreement(flight, leads, sensor, history)
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
    cells = len(selection.sunlit)
    in_sun = 100.0 * float((selection.sunlit > 0).mean()) if cells else 0.0
    print(
        f"{len(selection.chosen)} photos chosen, no list has fewer than {selection.bound}: "
        f"they show {in_sun:.1f} % of the ground in sun, on {selection.views} photos where there "
        "are as many"
    )
    area_ha = sum(each.area for each in selection.again) / HECTARE_M2
    if selection.again:
        print(f"to fly again: {area_ha:.2f} ha in {len(selection.again)} regions")
    else:
        print("nothing to fly again")
    print(f"written to {out}")
