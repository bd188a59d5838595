"""Speed of the wire as Python sees it, each beside a baseline of the same run; floors asserted."""

from collections.abc import Callable
from time import perf_counter

import numpy as np
import pytest

from recon import wire

READ_BYTES = 64 * 1024


def shortest_s(rounds: int, *steps: Callable[[], object]) -> list[float]:
    """Shortest time of each step; they take turns, so that all meet the machine's same noise."""
    shortest = [float("inf")] * len(steps)
    for _ in range(rounds):
        for i, step in enumerate(steps):
            start = perf_counter()
            step()
            shortest[i] = min(shortest[i], perf_counter() - start)
    return shortest


def reads_of(stream: bytes) -> list[bytes]:
    return [stream[i : i + READ_BYTES] for i in range(0, len(stream), READ_BYTES)]


def report(capsys: pytest.CaptureFixture[str], line: str) -> None:
    with capsys.disabled():
        print(f"\n{line}", flush=True)


def test_core_telemetry_packets_per_second(capsys: pytest.CaptureFixture[str]) -> None:
    core = wire.CoreTelemetry(
        is_flying=1,
        latitude_deg=44.97,
        longitude_deg=-93.23,
        altitude_m=287.0,
        height_above_takeoff_m=61.0,
        velocity_north_mps=3.5,
        velocity_east_mps=-1.25,
        velocity_down_mps=0.1,
        yaw_deg=92.5,
        pitch_deg=-4.0,
        roll_deg=1.5,
    )
    count = 100_000
    reads = reads_of(wire.encode(core) * count)
    deframer = wire.Deframer()

    def receive() -> None:
        assert sum(len(deframer.feed(data)) for data in reads) == count

    def objects() -> list[object]:
        return [object() for _ in range(count)]

    wire_s, objects_s = shortest_s(20, receive, objects)
    rate = count / wire_s
    report(
        capsys,
        f"core telemetry in Python: {rate / 1e6:.2f} million packets/s (at least 1.5); "
        f"{wire_s / objects_s:.1f} x making as many empty objects",
    )
    assert rate >= 1.5e6


def test_images_as_arrays(capsys: pytest.CaptureFixture[str]) -> None:
    pixels = np.random.default_rng(3).integers(0, 256, (1080, 1920, 3), dtype=np.uint8)
    frame = wire.encode(wire.Image(target_fps_hz=5.0, pixels=pixels))
    reads = reads_of(frame * 3)
    deframer = wire.Deframer()
    to = np.empty(3 * len(frame), np.uint8)
    source = np.frombuffer(frame * 3, np.uint8)

    def receive() -> None:
        images = [packet for data in reads for packet in deframer.feed(data)]
        arrays = [image.pixels for image in images if isinstance(image, wire.Image)]
        assert [array[-1, -1, 2] for array in arrays] == [pixels[-1, -1, 2]] * 3

    wire_s, copy_s = shortest_s(15, receive, lambda: np.copyto(to, source))
    speed_gbps = 3 * len(frame) / wire_s / 1e9
    report(
        capsys,
        f"1920x1080 images in Python: {speed_gbps:.2f} GB/s (at least 2); "
        f"{copy_s / wire_s:.2f} of one memcpy",
    )
    assert speed_gbps >= 2
