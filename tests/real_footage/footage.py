"""Footage made of one real fisheye frame: its ground under moving shade, from a wobbling camera.

Truth is by construction: the clouds are drawn, the camera's poses are drawn, and the light of the
real frame is only multiplied. What is real: the ground, its colours and texture, the lens, the tone
curve, saturation, the hot spot. Limits: cloud shadow that becker-1 itself shows counts as dark
land; vignetting moves with the ground by the degree or so that the camera wobbles; the rim there
is filled with the outermost pixels of the real frame.
"""

from collections.abc import Iterator
from dataclasses import dataclass, replace

import cv2
import numpy as np
from tests.real_footage.clouds import DrawnClouds
from tests.real_footage.light import levels_of, relit
from tests.real_footage.places import SOURCE_FINER, Place

from recon.camera import GroundProjector, ImageCircle
from recon.model.arrays import FloatArray
from recon.model.geo import GroundGrid
from recon.model.imagery import CameraPose, Frame, GroundImage
from recon.model.units import NS_PER_S

GREEN = 1
WAVES = 6
RIM_SHARE = 0.985
"""Of the image circle's radius: pixels farther out are dark in the real frames."""


@dataclass(frozen=True, slots=True)
class FootageSettings:
    """Sky, camera and encoding of made footage; standard deviations per axis."""

    seed: int = 0
    cover: float = 0.4
    """Share of the ground in shade; 0: no clouds at all."""
    velocity_mps: tuple[float, float] = (6.0, 3.0)
    period_s: float = 5.0
    wobble_deg: float = 0.12
    wobble_s: float = 1.5
    drift_m: float = 0.5
    drift_s: float = 40.0
    exposure_follows: float = 0.0
    """Share of a brightness change, in stops, that auto exposure compensates; 0: locked."""
    white_balance: float = 0.0
    """Standard deviation of the gains of red and blue against green; changes within minutes."""
    noise: float = 0.004
    """Standard deviation of light 1; grows with the root of the light."""
    jpeg_quality: int | None = 85
    """None: frames are sent as pixels."""


@dataclass(frozen=True, slots=True, eq=False)
class MadeFrame:
    """A frame with its truth."""

    frame: Frame
    believed_pose: CameraPose
    """What telemetry gives: the camera hovers, so it is the marked pose."""
    true_pose: CameraPose
    time_s: float
    gains: FloatArray
    """Exposure times white balance (3,), 1 in the real frame."""
    clouds: DrawnClouds | None
    exposure_locked: bool

    def transmittance(self, grid: GroundGrid) -> np.ndarray:
        """Return the truth: the direct beam's share at each cell of a grid, (rows, cols)."""
        if self.clouds is None:
            return np.ones((grid.rows, grid.cols), dtype=np.float32)
        return self.clouds.on_grid(grid, self.time_s)


def footage(place: Place, settings: FootageSettings, count: int) -> Iterator[MadeFrame]:
    """Yield the frames of a hover over a place, the first at time 0; the same for the same seed."""
    clouds = None
    if settings.cover > 0.0:
        clouds = DrawnClouds(settings.seed, settings.cover, settings.velocity_mps)
    painter = _Painter(place)
    for number in range(count):
        yield painter.frame(settings, clouds, number)


def ground_images(
    place: Place, frames: Iterator[MadeFrame], grid: GroundGrid, *, is_pose_true: bool = False
) -> Iterator[tuple[GroundImage, MadeFrame]]:
    """Yield the frames on a grid, by their believed poses or by their true ones.

    The images have what a station knows: the sun's direction, and whether exposure is locked.
    """
    projector = GroundProjector(grid, place.camera, place.circle)
    for made in frames:
        pose = made.true_pose if is_pose_true else made.believed_pose
        image = projector.project(made.frame, pose)
        yield (
            replace(
                image,
                toward_sun_enu=place.toward_sun_enu,
                exposure_locked=made.exposure_locked,
            ),
            made,
        )


def drawn_pose(place: Place, settings: FootageSettings, time_s: float) -> CameraPose:
    """Return the camera's true pose at a time."""
    lean, shift_m = (
        np.array([_drawn((settings.seed, stream, axis), time_s, life_s) for axis in range(3)])
        for stream, life_s in ((2, settings.wobble_s), (3, settings.drift_s))
    )
    turn, _ = cv2.Rodrigues(np.radians(settings.wobble_deg) * lean)
    marked = place.marked_pose
    return CameraPose(
        marked.rotation_enu_camera @ turn, marked.position_enu_m + settings.drift_m * shift_m
    )


def _drawn(stream: tuple[int, ...], time_s: float, life_s: float) -> float:
    """A smooth random function of time, of mean 0 and deviation 1."""
    rng = np.random.default_rng(stream)
    phase = rng.uniform(0.0, 2.0 * np.pi, WAVES)
    turns = rng.uniform(0.3, 1.2, WAVES) * time_s / life_s
    return float(np.sqrt(2.0 / WAVES) * np.sin(phase + turns).sum())


class _Painter:
    """Paints frames of one place; what does not change between frames is computed once."""

    def __init__(self, place: Place) -> None:
        self._place = place
        camera, circle = place.camera, place.circle
        self._window = _window(circle, camera.rows, camera.cols)
        pixels = np.mgrid[self._window][::-1].astype(np.float64)
        self._shown = circle.contains(*pixels)
        rays = camera.unproject(pixels.reshape(2, -1).T).reshape(*self._shown.shape, 3)
        self._rays = np.where(self._shown[..., np.newaxis], rays, (0.0, 0.0, 1.0))
        self._fine = camera.scaled_to(SOURCE_FINER * camera.rows, SOURCE_FINER * camera.cols)
        self._in_sun = self._metered(self._light(place.marked_pose, None, 0.0))

    def frame(
        self, settings: FootageSettings, clouds: DrawnClouds | None, number: int
    ) -> MadeFrame:
        time_s = settings.period_s * number
        pose = drawn_pose(self._place, settings, time_s)
        light = self._light(pose, clouds, time_s)
        gains = self._gains(settings, self._metered(light), time_s)
        light *= gains.astype(np.float32)
        rng = np.random.default_rng([settings.seed, 4, number])
        noise = rng.standard_normal(light.shape, dtype=np.float32) * np.float32(settings.noise)
        light += noise * np.sqrt(np.maximum(light, 0.0))
        rgb = np.zeros((self._place.camera.rows, self._place.camera.cols, 3), dtype=np.uint8)
        rgb[self._window] = np.where(self._shown[..., np.newaxis], levels_of(light), 0)
        at_ns = round(time_s * NS_PER_S)
        frame = _sent(Frame(number, self._place.name, at_ns, at_ns, 0.0, rgb=rgb), settings)
        is_locked = settings.exposure_follows == 0.0 and settings.white_balance == 0.0
        return MadeFrame(frame, self._place.marked_pose, pose, time_s, gains, clouds, is_locked)

    def _light(self, pose: CameraPose, clouds: DrawnClouds | None, time_s: float) -> np.ndarray:
        """(R, C, 3): the light of the window's pixels, before exposure."""
        place = self._place
        directions = self._rays @ pose.rotation_enu_camera.T
        # Rays near the horizon meet the ground far outside: the circle ends well below it.
        far_m = pose.position_enu_m[2] / np.maximum(-directions[..., 2:], 0.05)
        ground_m = pose.position_enu_m + directions * far_m
        sunlit = cv2.remap(place.sunlit, *self._source_maps(ground_m), cv2.INTER_LINEAR)
        hot = np.zeros(3) if place.hot_spot is None else place.hot_spot.at(directions)
        shares = np.ones(self._shown.shape, dtype=np.float32)
        if clouds is not None:
            shares = clouds.at(ground_m[..., 0], ground_m[..., 1], time_s)
        return relit(sunlit, shares, hot).astype(np.float32)

    def _source_maps(self, ground_m: FloatArray) -> tuple[np.ndarray, np.ndarray]:
        """Where the real frame shows ground points (R, C, 3), moved into its image circle."""
        marked = self._place.marked_pose
        rays = (ground_m - marked.position_enu_m) @ marked.rotation_enu_camera
        circle = self._place.circle.scaled(SOURCE_FINER)
        middle = np.array([circle.centre_col_px, circle.centre_row_px])
        off = self._fine.project_beyond_range(rays) - middle
        radius = np.linalg.norm(off, axis=-1, keepdims=True)
        off *= np.minimum(1.0, RIM_SHARE * circle.radius_px / np.maximum(radius, 1.0))
        pixels = (middle + off).astype(np.float32)
        return pixels[..., 0], pixels[..., 1]

    def _metered(self, light: np.ndarray) -> float:
        return float(light[..., GREEN][self._shown].mean())

    def _gains(self, settings: FootageSettings, metered: float, time_s: float) -> FloatArray:
        exposure = (metered / self._in_sun) ** -settings.exposure_follows
        red, blue = (
            1.0 + settings.white_balance * _drawn((settings.seed, 5, axis), time_s, 90.0)
            for axis in range(2)
        )
        return exposure * np.array([red, 1.0, blue])


def _window(circle: ImageCircle, rows: int, cols: int) -> tuple[slice, slice]:
    """The rows and columns of a frame that hold the image circle."""
    parts = ((circle.centre_row_px, rows), (circle.centre_col_px, cols))
    first, last = zip(
        *(
            (max(0, int(at - circle.radius_px)), min(size, int(at + circle.radius_px) + 2))
            for at, size in parts
        ),
        strict=True,
    )
    return slice(first[0], last[0]), slice(first[1], last[1])


def _sent(frame: Frame, settings: FootageSettings) -> Frame:
    """Return the frame as it is sent, encoded or not."""
    if settings.jpeg_quality is None:
        return frame
    assert frame.rgb is not None
    bgr = cv2.cvtColor(frame.rgb, cv2.COLOR_RGB2BGR)
    is_done, jpeg = cv2.imencode(".jpg", bgr, [cv2.IMWRITE_JPEG_QUALITY, settings.jpeg_quality])
    assert is_done
    return replace(frame, rgb=None, jpeg=jpeg.tobytes())
