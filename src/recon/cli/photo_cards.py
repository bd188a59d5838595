"""The photos of a flight's cards, as `recon tag` and `recon mosaic` read them, and what is said of
files that they leave out."""

from collections import Counter
from collections.abc import Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

import typer

from recon.cli.json_lines import report_facts
from recon.cli.output import print_line, print_warning
from recon.cli.progress import progress_over, usable_cores
from recon.model.errors import RecordError
from recon.model.names import first_names
from recon.product.flight import FlightData
from recon.product.panels import PanelShot, marked_panels
from recon.product.photos.card import Card, card_of
from recon.product.photos.copies import without_copies
from recon.product.photos.names import unique_names
from recon.product.photos.photo import Photo, read_photo_facts
from recon.product.photos.photo_error import PhotoError
from recon.product.photos.shots import CameraShot, shots_of
from recon.product.timing import CameraClock, StatedCamera, Timed, timed_photos

MOST_OFF_S = 1e9
"""Largest offset of a camera's clock: thirty years, as after an empty battery."""
MOST_NAMED = 5
"""Photos named for one reason; all are in the table."""
COPY = "a copy, which counts once, of"


@dataclass(frozen=True, slots=True, kw_only=True)
class CameraOptions:
    """What a person states of the camera."""

    field: Annotated[
        float | None,
        typer.Option(min=10.0, max=120.0, help="Camera's field along the longer side, degrees."),
    ] = None
    clock_offset: Annotated[
        float | None,
        typer.Option(
            min=-MOST_OFF_S,
            max=MOST_OFF_S,
            help="Seconds to add to the camera's clock for UTC; default: estimated.",
        ),
    ] = None


@dataclass(frozen=True, slots=True, eq=False)
class ReadCard:
    """Shots and panels below the folders of a person, and by a photo's name why it is neither."""

    card: Card
    shots: Sequence[CameraShot]
    panels: Sequence[PanelShot]
    refused: Mapping[str, str]

    def timed(self, flight: FlightData, camera: CameraOptions) -> Timed:
        """Return the shots' leading files with time and pose; print the cameras' clocks."""
        stated = StatedCamera(camera.clock_offset, camera.field)
        timed = timed_photos(flight, [shot.lead for shot in self.shots], stated)
        for clock in timed.clocks:
            print_line(str(clock))
        report_facts(clocks=[_facts(clock) for clock in timed.clocks])
        for warning in timed.warnings:
            print_warning(warning)
        return timed

    def print_left_out(self, refused: Mapping[str, str]) -> None:
        """Print what was left alone and what is refused since, by reason."""
        for reason, paths in self.card.left.items():
            names = first_names([path.name for path in paths], MOST_NAMED)
            print_line(f"left out: {names}: {reason}")
        print_refused(refused)


def read_card(images: Sequence[Path], out: Path) -> ReadCard:
    """Return what files and folders hold, with notes on photos printed; raises `RecordError`.

    `out` is the folder to write: the cards' own is refused, for it would never be read again.
    """
    card = card_of(images)
    whole = out.resolve()
    for path in card.photos:
        if whole in path.resolve().parents:
            raise RecordError(f"--out: expected a folder without photos, got {out} with {path}")
    photos, refused = _read_photos(card.photos)
    _print_grouped("", {each.name: note for each in photos for note in each.notes})
    shots = shots_of(photos)
    panels = marked_panels(shots)
    of_panels = {panel.shot.lead.name for panel in panels}
    shots = [shot for shot in shots if shot.lead.name not in of_panels]
    return ReadCard(card, shots, panels, refused)


def _read_photos(paths: Sequence[Path]) -> tuple[list[Photo], dict[str, str]]:
    """Return the photos without copies, and by name why others are none; raises `RecordError`."""
    names, photos, refused = unique_names(paths), list[Photo](), dict[str, str]()

    def read(path: Path) -> Photo | str:
        try:
            return read_photo_facts(path, names[path])
        except PhotoError as problem:
            return str(problem)

    with ThreadPoolExecutor(usable_cores()) as pool:
        for path, found in zip(
            paths, progress_over(pool.map(read, paths), "reading photos", len(paths)), strict=True
        ):
            if isinstance(found, str):
                refused[names[path]] = found
            else:
                photos.append(found)
    try:
        photos, copies = without_copies(photos)
    except OSError as problem:
        raise RecordError(f"{problem.filename}: {problem.strerror}") from problem
    refused.update({name: f"{COPY} {first}" for name, first in copies.items()})
    return photos, refused


def main_reason(refused: Mapping[str, str]) -> str:
    """Return why most of the refused photos are."""
    reasons = Counter(
        reason.removeprefix(f"{name}: ")
        for name, reason in refused.items()
        if not reason.startswith(COPY)
    )
    return next((reason for reason, _count in reasons.most_common(1)), "there was none")


def _facts(clock: CameraClock) -> dict[str, str | float | bool]:
    """Return a clock as the API has it."""
    return {
        "camera": clock.camera,
        "vehicle": clock.vehicle,
        "photos": clock.photos,
        "offset_s": clock.offset_s,
        "sigma_s": clock.sigma_s,
        "distance_m": clock.distance_m,
        "is_stated": clock.is_stated,
        "is_reported": clock.is_reported,
    }


def reasons_of(panels: Sequence[PanelShot]) -> dict[str, str]:
    """Return why the files of panels are not used, by name."""
    return {
        photo.name: f"shows a reflectance panel, by {panel.found_by}"
        for panel in panels
        for photo in panel.shot.files
    }


def print_refused(refused: Mapping[str, str]) -> None:
    """Print each reason once; copies together, for each has its own photo."""
    copies = [name for name, reason in sorted(refused.items()) if reason.startswith(COPY)]
    if copies:
        print_line(
            f"left out: {first_names(copies, MOST_NAMED)}: copies of other photos, which count once"
        )
    rest = {name: reason for name, reason in refused.items() if name not in copies}
    _print_grouped("not used: ", rest)


def _print_grouped(before: str, refused: Mapping[str, str]) -> None:
    """Print each reason once, with some of the photos."""
    by_reason: dict[str, list[str]] = {}
    for name, reason in sorted(refused.items()):
        by_reason.setdefault(reason.removeprefix(f"{name}: "), []).append(name)
    for reason, names in by_reason.items():
        print_warning(f"{before}{first_names(names, MOST_NAMED)}: {reason}")
