"""The feed's pace, latency and formats, and frames from files."""

from pathlib import Path
from random import Random

import cv2
import numpy as np
import pytest

from recon import wire
from recon.camera import decode_jpeg
from recon.model.units import NS_PER_S
from recon.sim.app.app import AppSettings, SimulatedApp
from recon.sim.app.camera_feed import CameraFeed, FeedSettings, ImageFormat
from recon.sim.camera.frames import CameraView, StillFrame, folder_frames, read_frame
from recon.sim.errors import FrameSourceError
from recon.sim.flight.aircraft import Aircraft

PICTURE = np.random.default_rng(1).integers(0, 255, (36, 64, 3), dtype=np.uint8)


class Numbered:
    """Pictures whose first pixel tells the shot's number and its time in tenths."""

    def prepare(self) -> None:
        return None

    def render(self, view: CameraView) -> np.ndarray:
        picture = PICTURE.copy()
        picture[0, 0] = (view.number, round(view.elapsed_s * 10), 0)
        return picture


def camera_bench(app_bench_type, home, settings: FeedSettings, source=None):
    feed = CameraFeed(source or Numbered(), settings, Random(5), 0)
    app = SimulatedApp(AppSettings("SIM-IMAGER", home, seed=4), Aircraft(0), feed)
    return app_bench_type(app)


@pytest.fixture
def bench(app_bench, flights):
    kind = type(app_bench())
    return lambda settings, source=None: camera_bench(kind, flights.home, settings, source)


def images(packets: list) -> list:
    return [p for p in packets if isinstance(p, wire.Image | wire.CompressedImage)]


def test_raw_frames_come_at_the_rate_and_after_the_latency(bench) -> None:
    feed = bench(FeedSettings(largest_fps_hz=2.0, latency_s=0.4))
    came = []
    for _ in range(500):
        came += [(feed.now_ns, p) for p in images(feed.run(0.01, step_s=0.01))]
    assert len(came) == 10
    for number, (now_ns, packet) in enumerate(came):
        assert packet.target_fps_hz == 2.0
        assert tuple(packet.pixels[0, 0]) == (number, number * 5, 0)
        assert np.array_equal(packet.pixels[1:], PICTURE[1:])
        latency_s = now_ns / NS_PER_S - number * 0.5
        assert 0.33 < latency_s < 0.47


def test_the_random_latency_is_0_2_to_1_s() -> None:
    latencies = []
    for seed in range(40):
        feed = CameraFeed(StillFrame(PICTURE), FeedSettings(), Random(seed), 0)
        feed.take(None)
        latencies.append(feed.take_shots()[0].send_at_ns / NS_PER_S)
    assert 0.2 <= min(latencies) < 0.4
    assert 0.8 < max(latencies) <= 1.0


def test_jpeg_frames(bench) -> None:
    smooth = cv2.GaussianBlur(PICTURE, (0, 0), 4)
    settings = FeedSettings(latency_s=0.2, image_format=ImageFormat.JPEG)
    packet = images(bench(settings, StillFrame(smooth)).run(1.0))[0]
    assert isinstance(packet, wire.CompressedImage)
    difference = np.abs(decode_jpeg(packet.jpeg).astype(int) - smooth)
    assert difference.mean() < 6.0


def test_camera_control_starts_stops_and_sets_the_rate(bench) -> None:
    feed = bench(FeedSettings(largest_fps_hz=4.0, latency_s=0.2, starts_on=False))
    assert images(feed.run(3.0)) == []
    assert feed.last(wire.ExtendedTelemetry).camera_state == 1
    feed.send(wire.CameraControl(action=1, target_fps_hz=2.0))
    assert len(images(feed.run(5.0))) == pytest.approx(10, abs=1)
    assert feed.last(wire.ExtendedTelemetry).camera_state == 2
    feed.send(wire.CameraControl(action=1, target_fps_hz=30.0))
    capped = images(feed.run(5.0))
    assert len(capped) == pytest.approx(20, abs=2)
    assert capped[-1].target_fps_hz == 4.0
    feed.send(wire.CameraControl(action=0, target_fps_hz=0.0))
    feed.run(0.5)
    assert images(feed.run(3.0)) == []
    assert feed.last(wire.ExtendedTelemetry).camera_state == 1


@pytest.mark.parametrize("fps_hz", [0.0, -1.0, float("nan"), float("inf")])
def test_an_invalid_rate_is_refused(bench, fps_hz: float) -> None:
    feed = bench(FeedSettings())
    answers = feed.send(wire.CameraControl(action=1, target_fps_hz=fps_hz))
    assert [p.positive for p in answers if isinstance(p, wire.Acknowledgment)] == [0]


def test_slow_rendering_skips_frames_instead_of_queueing() -> None:
    feed = CameraFeed(StillFrame(PICTURE), FeedSettings(latency_s=0.2), Random(1), 0)
    for _ in range(50):
        feed.take(None)
    shots = feed.take_shots()
    assert len(shots) == 4
    feed.lose()
    feed.add(shots[1], shots[1].packet())
    for _ in range(50):
        feed.take(None)
    assert len(feed.take_shots()) == 2


def test_frames_ready_after_the_feed_was_stopped_are_dropped() -> None:
    feed = CameraFeed(StillFrame(PICTURE), FeedSettings(latency_s=0.2), Random(1), 0)
    feed.take(None)
    (shot,) = feed.take_shots()
    feed.switch_off()
    feed.add(shot, shot.packet())
    assert feed.due(10 * NS_PER_S) == []


def test_no_frames_are_taken_without_a_connection(bench) -> None:
    feed = bench(FeedSettings(latency_s=0.2))
    feed.app.disconnected()
    feed.run(10.0)
    feed.app.connected(feed.now_ns)
    assert len(images(feed.run(5.0))) == 5


def write(folder: Path, name: str, rgb: np.ndarray) -> Path:
    path = folder / name
    assert cv2.imwrite(str(path), rgb[:, :, ::-1])
    return path


def test_a_folder_is_shown_by_name_in_a_loop(tmp_path: Path) -> None:
    for name, level in (("b.png", 20), ("a.png", 10), ("c.png", 30)):
        write(tmp_path, name, np.full((18, 32, 3), level, dtype=np.uint8))
    (tmp_path / "notes.txt").write_text("no image")
    frames = folder_frames(tmp_path, 18, 32)
    levels = [int(frames.render(CameraView(0.0, n, None))[0, 0, 0]) for n in range(4)]
    assert levels == [10, 20, 30, 10]


def test_shrinking_averages_whole_blocks_so_that_pixel_centres_agree(tmp_path: Path) -> None:
    large = np.random.default_rng(2).integers(0, 255, (54, 96, 3), dtype=np.uint8)
    small = read_frame(write(tmp_path, "f.png", large), 18, 32)
    blocks = large.reshape(18, 3, 32, 3, 3).mean(axis=(1, 3))
    assert np.abs(small - blocks).max() <= 1.0


def test_colours_keep_their_order(tmp_path: Path) -> None:
    red = np.zeros((18, 32, 3), dtype=np.uint8)
    red[:, :, 0] = 200
    for name in ("f.png", "f.jpg"):
        mean = read_frame(write(tmp_path, name, red), 18, 32).reshape(-1, 3).mean(axis=0)
        assert mean == pytest.approx((200, 0, 0), abs=4)


def test_an_invalid_frame_is_refused_with_a_message(tmp_path: Path) -> None:
    empty = tmp_path / "empty"
    empty.mkdir()
    broken, cut = tmp_path / "x.png", tmp_path / "x.jpg"
    broken.write_bytes(b"\x89PNG nothing")
    cut.write_bytes(b"\xff\xd8\xff\xe0")
    square = write(tmp_path, "square.png", np.zeros((20, 20, 3), dtype=np.uint8))
    for call in (
        lambda: folder_frames(tmp_path / "missing"),
        lambda: folder_frames(empty),
        lambda: read_frame(broken, 18, 32),
        lambda: read_frame(cut, 18, 32),
        lambda: read_frame(square, 18, 32),
        lambda: read_frame(tmp_path / "none.jpg", 18, 32),
    ):
        with pytest.raises(FrameSourceError, match="expected"):
            call()
