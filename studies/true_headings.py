"""Whether `recon tag` finds which way pictures look whose gimbal states another yaw."""

import csv
import re
from collections.abc import Iterator
from contextlib import redirect_stderr, redirect_stdout
from io import StringIO
from pathlib import Path

from PIL import Image

from recon.cli.tag import tag_command
from studies.survey_photos import SurveyFlown

DRONE = "SIM-1"
UNVERIFIED = ("is unverified", "degrees only")
YAW = re.compile(rb'(GimbalYawDegree=")([^"]+)')


def headings_off(flown: SurveyFlown, card: Path, folder: Path, off_deg: float) -> list[float]:
    """Tag one drone's photos with gimbal yaws that are off by so much.

    Return how far off each photo's heading is in degrees; none where a warning says that they could
    not be verified.
    """
    turned, tagged = folder / "card", folder / "tagged"
    turned.mkdir(parents=True)
    for path in sorted(card.glob(f"{DRONE}_*.JPG")):
        _turned(path, turned / path.name, off_deg)
    said = StringIO()
    with redirect_stdout(said), redirect_stderr(said):
        tag_command(images=[turned], flight=flown.record, out=tagged)
    if any(each in said.getvalue() for each in UNVERIFIED):
        return []
    return [
        abs((yaw_deg - flown.shots[name].yaw_deg + 180.0) % 360.0 - 180.0)
        for name, yaw_deg in _yaws(tagged)
    ]


def _turned(source: Path, target: Path, off_deg: float) -> None:
    """Copy a photo with another gimbal yaw; its pixels stay what they are."""

    def off(found: re.Match[bytes]) -> bytes:
        return found[1] + f"{(float(found[2]) + off_deg + 180.0) % 360.0 - 180.0:+.2f}".encode()

    with Image.open(source) as image:
        xmp, count = YAW.subn(off, image.info["xmp"])
        assert count == 1
        image.save(target, "JPEG", quality="keep", exif=image.getexif(), xmp=xmp)


def _yaws(tagged: Path) -> Iterator[tuple[str, float]]:
    with (tagged / "tags.csv").open(encoding="utf-8", newline="") as file:
        for row in csv.DictReader(file):
            if row["yaw_deg"]:
                yield row["name"], float(row["yaw_deg"])
