"""A finished mosaic's figures and preview, read back for a page. The folder may be another's."""

from base64 import b64encode
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Literal

import msgspec
from msgspec import Meta, Struct

from recon.model.errors import RecordError
from recon.product.mosaic.build import PREVIEW, REPORT
from recon.product.mosaic.choice import Light

LARGEST_REPORT_BYTES = 16_000_000
LARGEST_PREVIEW_BYTES = 16_000_000
PNG_START = b"\x89PNG\r\n\x1a\n"

Area = Annotated[float, Meta(ge=0.0, le=1e9)]


class _Areas(Struct, frozen=True):
    sun: Area
    shade: Area
    unknown: Area
    missing: Area


class _MosaicFile(Struct, frozen=True):
    format: Literal["recon-mosaic"]
    version: Literal[1]
    resolution_m: Annotated[float, Meta(gt=0.0, le=100.0)]
    photos: Annotated[int, Meta(ge=0)]
    photos_used: Annotated[int, Meta(ge=0)]
    areas_m2: _Areas
    filled_m2: Area
    recon_flight_record: str
    recon_brightness: str


@dataclass(frozen=True, slots=True)
class FinishedMosaic:
    """What a page shows of a mosaic."""

    preview: str
    """The picture as a data URI."""
    resolution_m: float
    photos: int
    photos_used: int
    brightness: str
    areas_m2: dict[Light, float]
    filled_m2: float

    def percent(self, light: Light) -> float:
        """Return a light's share of the area."""
        return 100.0 * self.areas_m2[light] / max(sum(self.areas_m2.values()), 1e-9)


def finished_mosaic(folder: Path, record: str) -> FinishedMosaic:
    """Return the mosaic in a folder, made of a flight's record; raises `RecordError`."""
    path = folder / REPORT
    try:
        found = msgspec.json.decode(_bounded(path, LARGEST_REPORT_BYTES), type=_MosaicFile)
    except (msgspec.MsgspecError, UnicodeError, RecursionError) as problem:
        raise RecordError(
            f"{path}: expected the report of recon mosaic, got: {problem}"
        ) from problem
    if found.recon_flight_record != record:
        raise RecordError(
            f"{path}: expected a mosaic of {record}, got one of {found.recon_flight_record!a:.100}"
        )
    preview = _bounded(folder / PREVIEW, LARGEST_PREVIEW_BYTES)
    if not preview.startswith(PNG_START):
        raise RecordError(f"{folder / PREVIEW}: expected a PNG, got another file")
    return FinishedMosaic(
        f"data:image/png;base64,{b64encode(preview).decode()}",
        found.resolution_m,
        found.photos,
        found.photos_used,
        found.recon_brightness,
        {light: getattr(found.areas_m2, light.name.lower()) for light in Light},
        found.filled_m2,
    )


def _bounded(path: Path, most_bytes: int) -> bytes:
    try:
        with path.open("rb") as file:
            data = file.read(most_bytes + 1)
    except OSError as problem:
        raise RecordError(f"{path}: {problem.strerror}: run recon mosaic first") from problem
    if len(data) > most_bytes:
        raise RecordError(f"{path}: expected at most {most_bytes} bytes, got more")
    return data
