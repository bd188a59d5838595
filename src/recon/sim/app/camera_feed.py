"""The app's video feed: when a frame is taken, and when it is sent.

Taking, rendering and sending are separate steps, because rendering is slow and `recon.sim.run` does
it in a thread: the feed hands out `Shot`s, gets packets back, and sends each at its own time.
"""

from collections import deque
from dataclasses import dataclass, field
from enum import Enum
from math import isfinite
from random import Random

import cv2

from recon import wire
from recon.model.imagery import CameraPose, RgbImage
from recon.model.units import NS_PER_S, seconds_to_ns
from recon.sim.camera.frames import CameraView, FrameFlaw, FrameSource
from recon.sim.errors import FrameSourceError

MOST_SHOTS_IN_HAND = 4
"""Most unrendered frames: beyond it new ones are skipped, as a busy phone does."""

SHORTEST_LATENCY_S = 0.2
LONGEST_LATENCY_S = 1.0
JITTER_S = 0.05
"""Plus or minus, for each frame: the phone's encoder and its queue."""
CAPTURES_KEPT = 4096
"""An hour at one frame per second."""


class ImageFormat(Enum):
    """Packet type of frames: Image (PID 2) or Compressed Image (PID 5)."""

    RAW = "raw"
    JPEG = "jpeg"


@dataclass(frozen=True, slots=True)
class FeedSettings:
    """Rate, format and latency; `latency_s` None draws one per vehicle between 0.2 and 1 s."""

    largest_fps_hz: float = 1.0
    image_format: ImageFormat = ImageFormat.RAW
    latency_s: float | None = None
    starts_on: bool = True
    jpeg_quality: int = 85


@dataclass(frozen=True, slots=True, eq=False)
class Shot:
    """A frame taken and not yet rendered."""

    view: CameraView
    target_fps_hz: float
    send_at_ns: int
    source: FrameSource
    settings: FeedSettings
    flaw: FrameFlaw | None = None

    def packet(self) -> bytes:
        """Render and encode: the slow part. Safe in any thread: depends on this shot only."""
        rgb = self.source.render(self.view)
        if self.flaw is not None:
            rgb = self.flaw.applied(rgb)
        if self.settings.image_format is ImageFormat.RAW:
            return wire.encode(wire.Image(target_fps_hz=self.target_fps_hz, pixels=rgb))
        jpeg = _jpeg(rgb, self.settings.jpeg_quality)
        return wire.encode(wire.CompressedImage(target_fps_hz=self.target_fps_hz, jpeg=jpeg))


@dataclass(frozen=True, slots=True, eq=False)
class CaptureTimes:
    """True capture time of a frame and when it is sent: for the score and for tests."""

    view: CameraView
    taken_at_ns: int
    send_at_ns: int


@dataclass(slots=True)
class CameraFeed:
    """The feed's state: on or off, frame rate, and frames being rendered or waiting."""

    source: FrameSource
    settings: FeedSettings
    random: Random
    start_ns: int
    is_on: bool = False
    target_fps_hz: float = 0.0
    next_shot_ns: int = 0
    captures: deque[CaptureTimes] = field(default_factory=lambda: deque(maxlen=CAPTURES_KEPT))
    _latency_s: float = 0.0
    _jitter_seed: int = 0
    _shot_count: int = 0
    _last_view: CameraView | None = None
    _taken: deque[Shot] = field(default_factory=deque)
    _in_hand: int = 0
    _ready: list[tuple[int, int, bytes]] = field(default_factory=list)

    def __post_init__(self) -> None:
        drawn = self.random.uniform(SHORTEST_LATENCY_S + JITTER_S, LONGEST_LATENCY_S - JITTER_S)
        self._latency_s = drawn if self.settings.latency_s is None else self.settings.latency_s
        self._jitter_seed = self.random.getrandbits(64)
        if self.settings.starts_on:
            self.switch_on(self.settings.largest_fps_hz, self.start_ns)

    def switch_on(self, fps_hz: float, now_ns: int) -> None:
        """Send frames at this rate, capped at the app's own.

        Raises `FrameSourceError` unless the rate is positive and finite.
        """
        if not (isfinite(fps_hz) and fps_hz > 0.0):
            raise FrameSourceError(f"expected a positive frame rate, got {fps_hz}")
        self.target_fps_hz = min(fps_hz, self.settings.largest_fps_hz)
        self.next_shot_ns = (
            # A new rate must not delay the next frame, nor send one early.
            now_ns if not self.is_on else min(self.next_shot_ns, self._after(now_ns))
        )
        self.is_on = True

    def switch_off(self) -> None:
        """Send no more frames; those taken and not yet sent are lost."""
        self.is_on = False
        # Shots being rendered come back later by `add`, which then drops them.
        self._in_hand -= len(self._taken)
        self._taken.clear()
        self._ready.clear()

    def take(
        self,
        pose: CameraPose | None,
        flaw: FrameFlaw | None = None,
        is_repeated: bool = False,
    ) -> None:
        """Take the frame due at `next_shot_ns`, or queue the last one again."""
        now_ns = self.next_shot_ns
        self.next_shot_ns = self._after(now_ns)
        if self._in_hand >= MOST_SHOTS_IN_HAND:
            return
        view = CameraView((now_ns - self.start_ns) / NS_PER_S, self._shot_count, pose)
        self._shot_count += 1
        self._in_hand += 1
        send_at_ns = now_ns + seconds_to_ns(self._latency_at(now_ns))
        self.captures.append(CaptureTimes(view, now_ns, send_at_ns))
        self._last_view = self._last_view if is_repeated and self._last_view is not None else view
        self._taken.append(
            Shot(self._last_view, self.target_fps_hz, send_at_ns, self.source, self.settings, flaw)
        )

    def _latency_at(self, taken_at_ns: int) -> float:
        """Return seconds from taking to sending.

        Drawn from the time of taking, not from a running generator: skipped frames must not change
        the latency of later ones.
        """
        jitter = Random(f"{self._jitter_seed}/{taken_at_ns - self.start_ns}")
        return max(0.0, self._latency_s + jitter.uniform(-JITTER_S, JITTER_S))

    def miss(self) -> None:
        """Skip the frame due at `next_shot_ns`."""
        self.next_shot_ns = self._after(self.next_shot_ns)

    def skip_to(self, now_ns: int) -> None:
        """Take the next frame at this time, and none before."""
        self.next_shot_ns = max(self.next_shot_ns, now_ns)

    def take_shots(self) -> list[Shot]:
        """Return the shots to render; each comes back by `add` or `lose`."""
        shots = list(self._taken)
        self._taken.clear()
        return shots

    def add(self, shot: Shot, packet: bytes) -> None:
        """Take back a rendered frame."""
        self._in_hand -= 1
        if self.is_on:
            self._ready.append((shot.send_at_ns, shot.view.number, packet))
            # Rendering threads finish in any order.
            self._ready.sort()

    def lose(self) -> None:
        """Take back a shot that could not be rendered."""
        self._in_hand -= 1

    @property
    def next_send_ns(self) -> int | None:
        """Return when the next frame is sent, None without one."""
        return self._ready[0][0] if self._ready else None

    def due(self, now_ns: int) -> list[bytes]:
        """Return the packets due by now."""
        packets = []
        while self._ready and self._ready[0][0] <= now_ns:
            packets.append(self._ready.pop(0)[2])
        return packets

    def _after(self, now_ns: int) -> int:
        return now_ns + seconds_to_ns(1.0 / self.target_fps_hz)


def _jpeg(rgb: RgbImage, quality: int) -> bytes:
    bgr = cv2.cvtColor(rgb, cv2.COLOR_RGB2BGR)
    # Optimised code tables change no pixel and save an eighth.
    options = [cv2.IMWRITE_JPEG_QUALITY, quality, cv2.IMWRITE_JPEG_OPTIMIZE, 1]
    is_done, data = cv2.imencode(".jpg", bgr, options)
    if not is_done:
        raise FrameSourceError(f"expected an image that fits JPEG, got {rgb.shape}")
    return data.tobytes()
