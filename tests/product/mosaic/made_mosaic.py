"""A made flight whose photos are painted from a known ground and the known shade.

Red and green are waves to the east and to the north, so a pixel tells its place to a fraction of
the wave; blue is the transmittance when the photo was taken.
"""

from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
import numpy.typing as npt
from tests.product.made_flight import (
    ACROSS_DEG,
    COLS,
    FRAME,
    HEIGHT_M,
    ONE,
    OTHER,
    ROWS_PX,
    START_NS,
    Rows,
    flight,
    sun,
    times_s,
)

from recon.geo import geo_from_enu
from recon.model.units import NS_PER_S
from recon.product.flight import FlightData
from recon.product.footprint import Aim, PhotoView, projected
from recon.product.mosaic import (
    Camera,
    ChoiceSettings,
    LevelGround,
    MosaicBand,
    MosaicBuild,
    MosaicGround,
    MosaicSettings,
    placed_photos,
    plan_of,
    preview_cameras,
)
from recon.product.mosaic.pixels import Box, ReadPixels
from recon.product.photos.photo import Photo
from recon.product.progress import plainly
from recon.product.sun_at import SunHistory
from recon.product.timing import TimedPhoto

WAVE_M = 8.0
MIDDLE, SWING = 128.0, 100.0
BRIGHT = 200.0
"""Blue in full sun."""

FloatArray = npt.NDArray[np.float64]


def wave(place_m: FloatArray) -> FloatArray:
    return MIDDLE + SWING * np.sin(2.0 * np.pi * place_m / WAVE_M)


def painted(place_m: FloatArray, transmittance: FloatArray) -> npt.NDArray[np.uint8]:
    """Return the colours (..., 3) of places (..., 2), east and north."""
    parts = wave(place_m[..., 0]), wave(place_m[..., 1]), BRIGHT * transmittance
    return np.rint(np.stack(parts, axis=-1)).astype(np.uint8)


def ground_of_pixels(view: PhotoView, shrink: int = 1) -> FloatArray:
    """Return the ground (rows, cols, 2) under the pixels of a photo read at a smaller size."""
    cols, rows = view.cols // shrink, view.rows // shrink
    pixels = np.stack(np.meshgrid(np.arange(cols), np.arange(rows)), axis=-1)
    whole = (pixels + 0.5) * shrink - 0.5
    return projected(view.homography, whole.reshape(-1, 2)).reshape(rows, cols, 2)


@dataclass(slots=True)
class MadeMosaic:
    """A flight, its photos without files' pixels, and how a mosaic of them is made."""

    folder: Path
    ways: tuple[Rows, ...] = (ONE, OTHER)
    every: int = 3
    size: tuple[int, int] = (COLS, ROWS_PX)
    flight: FlightData = field(init=False)
    photos: list[TimedPhoto] = field(init=False)
    reads: list[int] = field(default_factory=list)
    """Photos in the order in which they were read."""

    def __post_init__(self) -> None:
        record = self.folder / "made.mcap"
        record.touch()
        self.flight = flight(*self.ways, path=record)
        self.photos = [
            self._photo(way, number, at_s)
            for way in self.ways
            for number, at_s in enumerate(times_s(way)[:: self.every].tolist())
        ]

    def _photo(self, way: Rows, number: int, at_s: float) -> TimedPhoto:
        east, north, yaw = (float(each) for each in way.place(at_s))
        path = self.folder / f"{way.serial}_{number:04d}.JPG"
        path.touch()
        latitude, longitude, _height = geo_from_enu(FRAME, (east, north, 0.0))
        at_ns = START_NS + round(at_s * NS_PER_S)
        photo = Photo(
            path, path.name, *self.size, 1, ("Made", "Camera", way.serial), at_ns, 1.0,
            float(latitude[0]), float(longitude[0]), None, ACROSS_DEG, None, HEIGHT_M,
        )  # fmt: skip
        view = PhotoView(Aim(east, north, HEIGHT_M, yaw), ACROSS_DEG, *self.size)
        return TimedPhoto(photo, way.serial, at_ns, 0.1, view, HEIGHT_M)

    def at_s(self, index: int) -> float:
        """Return a photo's time since the flight's start."""
        return (self.photos[index].at_ns - START_NS) / NS_PER_S

    def read(self, index: int, shrink: int, box: Box) -> npt.NDArray[np.uint8]:
        """Paint a photo."""
        self.reads.append(index)
        places = ground_of_pixels(self.photos[index].view, shrink)
        top, left, bottom, right = box
        places = places[top:bottom, left:right]
        return painted(places, sun(places[..., 0], places[..., 1], self.at_s(index)))

    def build(
        self,
        out: Path,
        *,
        resolution_m: float = 0.2,
        margin: float = 0.1,
        fills: bool = False,
        is_evened: bool = False,
        cameras: list[Camera] | None = None,
        ground: MosaicGround | None = None,
        read: ReadPixels | None = None,
        bands: list[MosaicBand] | None = None,
    ) -> MosaicBuild:
        ground = ground or LevelGround()
        views = [each.view for each in self.photos]
        cameras = cameras or preview_cameras(self.flight, self.photos, views, ground)
        assert self.flight.grid is not None
        history = SunHistory(self.flight.grid, self.flight.maps)
        placed = placed_photos(self.photos, cameras, history, ground, plainly)
        bands = bands or [MosaicBand("mosaic", ("red", "green", "blue"), read or self.read)]
        settings = MosaicSettings(ChoiceSettings(margin, fills), is_evened)
        plan = plan_of(self.flight, placed, ground, resolution_m)
        return MosaicBuild(out, self.flight, placed, ground, plan, bands, settings, "made")
