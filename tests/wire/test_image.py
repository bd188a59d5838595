"""Images: the pixels are a NumPy array over the bytes that arrived."""

import gc

import numpy as np
import pytest

from recon import wire

PIXELS = np.random.default_rng(7).integers(0, 256, (120, 160, 3), dtype=np.uint8)
FRAME = wire.encode(wire.Image(target_fps_hz=2.0, pixels=PIXELS))


def received(read_bytes: int) -> wire.Image:
    deframer = wire.Deframer()
    packets = []
    for start in range(0, len(FRAME), read_bytes):
        packets += deframer.feed(FRAME[start : start + read_bytes], 0)
    [image] = packets
    assert isinstance(image, wire.Image)
    return image


@pytest.mark.parametrize("read_bytes", [1, 4096, len(FRAME)])
def test_pixels_arrive_as_they_were_sent(read_bytes: int) -> None:
    image = received(read_bytes)
    assert image.pixels.dtype == np.uint8
    np.testing.assert_array_equal(image.pixels, PIXELS)
    assert image.target_fps_hz == 2.0


def test_pixels_are_read_only_and_the_same_array_each_time() -> None:
    image = received(4096)
    assert image.pixels is image.pixels
    with pytest.raises(ValueError, match="read-only"):
        image.pixels[0, 0, 0] = 1
    base = image.pixels.base
    while isinstance(base, np.ndarray):
        assert not base.flags.writeable
        base = base.base


def test_the_array_shows_the_frame_in_place_and_outlives_its_packet() -> None:
    image = received(4096)
    pixels = image.pixels
    whole = pixels.base
    assert isinstance(whole, np.ndarray)
    assert whole.nbytes == len(FRAME) - 2
    assert pixels.ctypes.data - whole.ctypes.data == 15
    del image, whole
    gc.collect()
    np.testing.assert_array_equal(pixels, PIXELS)


def test_a_packet_keeps_its_own_copy_of_what_it_is_given() -> None:
    mine = PIXELS[::2, ::-1]
    image = wire.Image(target_fps_hz=1.0, pixels=mine)
    changed = mine.copy()
    again = wire.Image(target_fps_hz=1.0, pixels=changed)
    changed[:] = 0
    assert again == image
    assert wire.decode(wire.encode(again)) == image


@pytest.mark.parametrize(
    "pixels",
    [
        np.zeros((2, 2), np.uint8),
        np.zeros((2, 2, 4), np.uint8),
        np.zeros((2, 2, 3), np.float32),
        b"bytes",
    ],
)
def test_other_arrays_are_refused(pixels: np.ndarray) -> None:  # type: ignore[type-arg]
    with pytest.raises(wire.FieldError, match="shape \\(rows, cols, 3\\) and type uint8"):
        wire.Image(target_fps_hz=1.0, pixels=pixels)


def test_images_larger_than_the_limits_are_refused() -> None:
    wide = wire.Image(target_fps_hz=1.0, pixels=np.zeros((1, 3841, 3), np.uint8))
    with pytest.raises(wire.FieldError, match="at most 3840 columns"):
        wire.encode(wide)
    with pytest.raises(wire.FieldError, match="0 to 65535"):
        wire.Image(target_fps_hz=1.0, pixels=np.zeros((1, 65536, 3), np.uint8))


def test_images_are_not_hashable() -> None:
    with pytest.raises(TypeError):
        hash(received(4096))
