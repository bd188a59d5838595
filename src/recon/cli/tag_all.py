"""The long part of `recon tag`: each file's tag, mask and sidecar; an ended run goes on."""

import json
from collections.abc import Callable, Iterator, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from hashlib import sha256
from itertools import islice
from pathlib import Path

from recon import version
from recon.cli.progress import progress_over, usable_cores
from recon.product.coverage import Ground
from recon.product.flight import FlightData
from recon.product.photos.card import PROGRESS
from recon.product.shot_files import ShotFiles
from recon.product.sun_at import SunHistory
from recon.product.sun_sensor import lit_by_sensor, shown_by_sensor
from recon.product.tag import MASK_SCALE, PhotoTag, Shown, light_around, shown_by, tag_photo
from recon.product.timing import TimedPhoto
from recon.product.write import masked_name, write_photo_files

AHEAD = 8
"""Photos waiting for each thread."""


@dataclass(frozen=True, slots=True, eq=False)
class FlightLight:
    """What is known of the sun on a flight's photos."""

    flight: FlightData
    history: SunHistory
    ground: Ground
    sunlit_share: float
    """For a photo to be called sunlit."""
    sensor: Mapping[str, float]
    """Share of direct sun by the sun sensor, by the leading file's name, where it is to count."""


def tag_all(
    out: Path, files: ShotFiles, light: FlightLight
) -> tuple[dict[str, PhotoTag], list[Shown]]:
    """Return all tags, with masks and sidecars written, and what each leading photo shows.

    Files of an earlier run are kept.
    """
    stat = light.flight.path.stat()
    facts = version(), stat.st_size, stat.st_mtime_ns, light.sunlit_share, MASK_SCALE
    record = f"{facts} {sorted(light.sensor.items())}"
    keys = {each.photo.name: _key(record, each) for each in files.photos}
    done = _earlier(out, keys)

    def tag(timed: TimedPhoto) -> tuple[PhotoTag, Shown | None]:
        sun, share = light_around(timed, light.history), light.sensor.get(files.shot_of(timed))
        shown = None
        if files.leads(timed):
            shown = shown_by_sensor(shown_by(timed, sun, light.ground), share)
        if timed.photo.name in done:
            return lit_by_sensor(done[timed.photo.name], share), shown
        by_maps, mask = tag_photo(timed, sun)
        found = lit_by_sensor(by_maps, share)
        write_photo_files(out, light.flight, timed, found, mask, light.sunlit_share)
        return found, shown

    tags: dict[str, PhotoTag] = {}
    shown_by_each: list[Shown] = []
    with (out / PROGRESS).open("a", encoding="utf-8") as log:
        tagged = _in_threads(tag, files.photos)
        for found, shown in progress_over(tagged, "tagging", len(files.photos)):
            tags[found.name] = found
            if shown is not None:
                shown_by_each.append(shown)
            if found.name not in done:
                numbers = [found.sunlit, found.confidence, found.known]
                log.write(json.dumps([found.name, keys[found.name], *numbers]) + "\n")
                log.flush()
    if done:
        print(f"{len(done)} photos were tagged before")
    return tags, shown_by_each


def _in_threads(
    tag: Callable[[TimedPhoto], tuple[PhotoTag, Shown | None]], photos: Sequence[TimedPhoto]
) -> Iterator[tuple[PhotoTag, Shown | None]]:
    """Yield tags in order; no more photos are begun than are soon taken."""
    with ThreadPoolExecutor(usable_cores()) as pool:
        rest = iter(photos)
        waiting = [pool.submit(tag, each) for each in islice(rest, AHEAD * usable_cores())]
        while waiting:
            yield waiting.pop(0).result()
            waiting += (pool.submit(tag, each) for each in islice(rest, 1))


def _key(record: str, timed: TimedPhoto) -> str:
    stat = timed.photo.path.stat()
    facts = f"{record} {stat.st_size} {stat.st_mtime_ns} {timed.at_ns} {timed.view} {timed.photo}"
    return sha256(facts.encode()).hexdigest()[:16]


def _earlier(out: Path, keys: dict[str, str]) -> dict[str, PhotoTag]:
    """Return the tags of an earlier run with the same inputs, whose files are there."""
    done: dict[str, PhotoTag] = {}
    path = out / PROGRESS
    if not path.is_file():
        return done
    for line in path.read_text(encoding="utf-8", errors="replace").splitlines():
        try:
            name, key, sunlit, confidence, known = json.loads(line)
            tag = PhotoTag(str(name), float(sunlit), float(confidence), float(known))
        except (ValueError, TypeError):
            continue  # A killed run leaves half a line.
        files = (out / "masks" / masked_name(tag.name), out / "xmp" / f"{Path(tag.name).stem}.xmp")
        if keys.get(tag.name) == key and all(map(_is_written, files)):
            done[tag.name] = tag
    return done


def _is_written(path: Path) -> bool:
    """Return whether a file is there; one that a computer's crash left empty is not."""
    return path.is_file() and path.stat().st_size > 0
