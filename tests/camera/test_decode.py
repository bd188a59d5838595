"""Pixels of frames, raw and from untrusted JPEG files."""

import cv2
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from recon.camera import FrameDecodeError, decode_frame, decode_jpeg, jpeg_size
from recon.camera.decode_png import decode_png, png_size
from recon.model.imagery import Frame


def picture(rows: int = 48, cols: int = 64) -> np.ndarray:
    """Red on the left, blue on the right, green growing downwards."""
    rgb = np.zeros((rows, cols, 3), dtype=np.uint8)
    rgb[:, : cols // 2, 0] = 200
    rgb[:, cols // 2 :, 2] = 200
    rgb[..., 1] = np.linspace(0, 150, rows).astype(np.uint8)[:, np.newaxis]
    return rgb


def jpeg_of(rgb: np.ndarray, *options: int) -> bytes:
    done, data = cv2.imencode(".jpg", rgb[..., ::-1], [cv2.IMWRITE_JPEG_QUALITY, 95, *options])
    assert done
    return data.tobytes()


JPEG = jpeg_of(picture())


@pytest.mark.parametrize("progressive", [0, 1])
def test_a_jpeg_gives_its_pixels_in_red_green_blue_order(progressive: int) -> None:
    data = jpeg_of(picture(), cv2.IMWRITE_JPEG_PROGRESSIVE, progressive)
    assert jpeg_size(data) == (48, 64)
    decoded = decode_jpeg(data)
    assert decoded.shape == (48, 64, 3)
    assert decoded.dtype == np.uint8
    inner = np.s_[4:-4, 4:24]
    assert np.abs(decoded[inner].astype(int) - picture()[inner]).mean() < 6.0


def test_a_grey_jpeg_gives_three_equal_channels() -> None:
    done, data = cv2.imencode(".jpg", picture()[..., 1])
    assert done
    decoded = decode_jpeg(data.tobytes())
    assert decoded.shape == (48, 64, 3)
    assert np.array_equal(decoded[..., 0], decoded[..., 2])


def test_an_orientation_tag_does_not_turn_the_frame() -> None:
    # A minimal Exif block: big-endian TIFF with the one tag 0x0112 = 6 (turn by 90 degrees).
    tiff = bytes.fromhex("4d4d002a00000008000101120003000000010006000000000000")
    block = b"Exif\0\0" + tiff
    turned = JPEG[:2] + b"\xff\xe1" + (len(block) + 2).to_bytes(2) + block + JPEG[2:]
    assert np.array_equal(decode_jpeg(turned), decode_jpeg(JPEG))


def frame(**pixels: object) -> Frame:
    return Frame(
        id=7, serial="S", received_at_ns=0, captured_at_ns=0, captured_sigma_s=0.1, **pixels
    )


def test_a_frame_gives_its_raw_pixels_or_its_jpegs() -> None:
    assert decode_frame(frame(rgb=picture())) is not None
    assert np.array_equal(decode_frame(frame(rgb=picture())), picture())
    assert np.array_equal(decode_frame(frame(jpeg=JPEG)), decode_jpeg(JPEG))
    with pytest.raises(FrameDecodeError, match="frame 7: expected pixels or a JPEG file"):
        decode_frame(frame())


def test_a_header_that_claims_a_huge_image_is_refused_before_decoding() -> None:
    at = JPEG.index(b"\xff\xc0") + 5
    bomb = JPEG[:at] + b"\xff\xff\xff\xff" + JPEG[at + 4 :]
    with pytest.raises(FrameDecodeError, match="expected 1 to 8294400 pixels, got 65535 x 65535"):
        decode_jpeg(bomb)
    with pytest.raises(FrameDecodeError, match="expected 1 to 100 pixels, got 64 x 48"):
        decode_jpeg(JPEG, most_pixels=100)
    with pytest.raises(FrameDecodeError, match="expected 1 to 100 pixels"):
        decode_frame(frame(rgb=picture()), most_pixels=100)


@pytest.mark.parametrize(
    ("data", "message"),
    [
        (b"", "starts with ffd8, got nothing"),
        (b"\x89PNG....", "starts with ffd8, got 89504e47"),
        (b"\xff\xd8\xff\xd9", "expected a frame header with the size"),
        (b"\xff\xd8" + b"\xff" * 500, "expected a frame header with the size"),
        (JPEG[:40], "expected a frame header with the size"),
        (JPEG[: len(JPEG) // 2], "expected the end-of-image marker"),
    ],
)
def test_an_incomplete_jpeg_is_refused(data: bytes, message: str) -> None:
    with pytest.raises(FrameDecodeError, match=message):
        decode_jpeg(data)


def test_raw_pixels_of_another_kind_are_refused() -> None:
    with pytest.raises(FrameDecodeError, match=r"expected \(rows, cols, 3\) of uint8"):
        decode_frame(frame(rgb=picture()[..., 0]))
    with pytest.raises(FrameDecodeError, match="expected 1 to"):
        decode_frame(frame(rgb=np.zeros((0, 5, 3), np.uint8)))


def outcome(data: bytes) -> tuple[int, ...] | None:
    """The shape that comes out, None for a refusal; anything else raised fails the test."""
    try:
        return decode_jpeg(data, most_pixels=10_000).shape
    except FrameDecodeError:
        return None


@given(st.binary(max_size=200))
def test_any_bytes_after_the_start_marker_are_refused(data: bytes) -> None:
    assert outcome(b"\xff\xd8" + data) is None


@given(st.lists(st.tuples(st.integers(0, len(JPEG) - 1), st.integers(0, 255)), max_size=6))
def test_a_damaged_jpeg_gives_pixels_or_a_refusal(damage: list[tuple[int, int]]) -> None:
    data = bytearray(JPEG)
    for at, value in damage:
        data[at] = value
    shape = outcome(bytes(data))
    assert shape is None or (len(shape) == 3 and shape[0] * shape[1] <= 10_000)


def png_of(rgb: np.ndarray) -> bytes:
    done, data = cv2.imencode(".png", rgb[..., ::-1])
    assert done
    return data.tobytes()


PNG = png_of(picture())


def test_a_png_has_its_pixels() -> None:
    assert png_size(PNG) == (48, 64)
    np.testing.assert_array_equal(decode_png(PNG, 48 * 64), picture())


@pytest.mark.parametrize(
    ("data", "expected"),
    [
        (PNG[:8], "its header first"),
        (PNG.replace(b"IHDR", b"IHDX"), "its header first"),
        (PNG[:16] + b"\xff" * 8 + PNG[24:], "expected 1 to 9000 pixels"),
        (PNG[:-5], "an end mark"),
        (PNG[: len(PNG) // 2], "an end mark"),
        # Its first chunk of pixels claims 4 GB, which OpenCV would allocate.
        (PNG[:33] + b"\xff\x00\x00\x51" + PNG[37:], "an end mark"),
    ],
)
def test_a_damaged_png_is_refused(data: bytes, expected: str) -> None:
    with pytest.raises(FrameDecodeError, match=expected):
        decode_png(data, 9_000)


def test_nothing_is_allocated_for_a_chunk_that_is_not_there(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(cv2, "imdecode", lambda *_: pytest.fail("decoded"))
    with pytest.raises(FrameDecodeError):
        decode_png(PNG[:33] + b"\xff\x00\x00\x51" + PNG[37:], 9_000)
