"""What photos state, and hostile ones."""

import struct
from dataclasses import replace
from pathlib import Path

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from tests.product.made_flight import ACROSS_DEG, FRAME, write_photo
from tests.product.photos.made_bands import write_band
from tests.product.photos.packets import packet

from recon.model.units import NS_PER_S
from recon.product.photos.names import unique_names
from recon.product.photos.photo import GimbalAttitude, read_photo_facts
from recon.product.photos.photo_error import PhotoError

CLOCK_NS = 1_750_001_234 * NS_PER_S
DJI = b"""<x:xmpmeta xmlns:x="adobe:ns:meta/"><rdf:RDF
 xmlns:rdf="http://www.w3.org/1999/02/22-rdf-syntax-ns#"><rdf:Description
 xmlns:drone-dji="http://www.dji.com/drone-dji/1.0/"
 drone-dji:RelativeAltitude="+59.80" drone-dji:AbsoluteAltitude="+352.40"
 drone-dji:AltitudeType="RtkAlt" drone-dji:GimbalYawDegree="-92.10"
 drone-dji:GimbalPitchDegree="-89.90" drone-dji:GimbalRollDegree="+0.20"
 drone-dji:FlightYawDegree="-91.00" drone-dji:RtkFlag="50" drone-dji:RtkStdLon="0.012"
 drone-dji:RtkStdLat="0.015" drone-dji:RtkStdHgt="0.031" /></rdf:RDF></x:xmpmeta>"""


def photo(path: Path, **changes: object) -> Path:
    return write_photo(path, **{"place_m": (12.0, -34.0), "clock_ns": CLOCK_NS} | changes)


def test_time_place_camera_and_lens_are_read(tmp_path: Path) -> None:
    path = photo(tmp_path / "a.JPG", subsec="25", xmp=DJI, satellites_ns=CLOCK_NS, orientation=6)
    found = read_photo_facts(path, "a.JPG")
    assert (found.clock_ns, found.clock_step_s) == (CLOCK_NS + 250_000_000, 0.01)
    assert found.satellite_ns == CLOCK_NS
    assert found.camera == ("Made", "Camera", "CAM-1")
    assert found.across_deg == pytest.approx(ACROSS_DEG, abs=0.01)
    assert found.latitude_deg == pytest.approx(FRAME.origin.latitude_deg, abs=1e-3)
    assert found.longitude_deg < FRAME.origin.longitude_deg + 1e-3
    assert found.attitude == GimbalAttitude(-92.1, -89.9, 0.2)
    assert (found.height_above_takeoff_m, found.flight_yaw_deg) == (59.8, -91.0)
    assert (found.absolute_height_m, found.height_reference) == (352.4, "ellipsoid")
    assert (found.horizontal_sigma_m, found.vertical_sigma_m) == (0.015, 0.031)
    assert (found.cols, found.rows, found.orientation) == (640, 480, 6)


def test_whole_seconds_and_a_missing_lens_are_stated_as_such(tmp_path: Path) -> None:
    found = read_photo_facts(photo(tmp_path / "a.JPG", with_lens=False), "a.JPG")
    assert (found.clock_step_s, found.across_deg, found.attitude) == (1.0, None, None)


@pytest.mark.parametrize(
    ("changes", "sentence"),
    [
        ({"clock_ns": None}, "expected EXIF with the time"),
        ({"place_m": (1e7, 0.0)}, None),
    ],
)
def test_photos_without_time_are_refused(
    tmp_path: Path, changes: dict[str, object], sentence: str | None
) -> None:
    path = photo(tmp_path / "a.JPG", **changes)
    if sentence is None:
        read_photo_facts(path, "a.JPG")
        return
    with pytest.raises(PhotoError, match=sentence):
        read_photo_facts(path, "a.JPG")


def test_a_photo_without_exif_is_refused(tmp_path: Path) -> None:
    from PIL import Image

    Image.new("RGB", (64, 48)).save(tmp_path / "plain.jpg")
    with pytest.raises(PhotoError, match=r"plain.jpg: expected EXIF with the time"):
        read_photo_facts(tmp_path / "plain.jpg", "plain.jpg")
    (tmp_path / "text.jpg").write_text("no photo")
    with pytest.raises(PhotoError, match="expected a JPEG"):
        read_photo_facts(tmp_path / "text.jpg", "text.jpg")
    with pytest.raises(PhotoError, match="cannot be read"):
        read_photo_facts(tmp_path / "none.jpg", "none.jpg")


@pytest.fixture(scope="module")
def whole(tmp_path_factory: pytest.TempPathFactory) -> bytes:
    return photo(tmp_path_factory.mktemp("photo") / "a.JPG", xmp=DJI).read_bytes()


CALM = settings(
    max_examples=60, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture]
)


@CALM
@given(st.floats(0.0, 0.999))
def test_a_photo_cut_anywhere_is_refused(tmp_path: Path, whole: bytes, share: float) -> None:
    path = tmp_path / "cut.jpg"
    path.write_bytes(whole[: int(share * (len(whole) - 2))])
    with pytest.raises(PhotoError, match=r"cut off|expected a JPEG"):
        read_photo_facts(path, "cut.jpg")


@CALM
@given(st.data())
def test_damage_gives_a_photo_or_a_sentence(tmp_path: Path, whole: bytes, data) -> None:
    damaged = bytearray(whole)
    for at in data.draw(st.lists(st.integers(0, min(1500, len(whole) - 1)), max_size=12)):
        damaged[at] = data.draw(st.integers(0, 255))
    path = tmp_path / "damaged.jpg"
    path.write_bytes(bytes(damaged))
    try:
        found = read_photo_facts(path, "damaged.jpg")
    except PhotoError:
        return
    assert abs(found.latitude_deg) <= 90.0
    assert found.across_deg is None or 0.0 < found.across_deg < 180.0


@CALM
@given(st.data())
def test_a_damaged_tiff_gives_a_photo_or_a_sentence(tmp_path: Path, data) -> None:
    path = tmp_path / "band.tif"
    if not path.exists():
        like = photo(tmp_path / "like.JPG")
        write_band(path, like, packet({"Camera:BandName": "NIR", "Camera:Irradiance": "3.1"}))
        (tmp_path / "whole").write_bytes(path.read_bytes())
    damaged = bytearray((tmp_path / "whole").read_bytes())
    for at in data.draw(st.lists(st.integers(0, len(damaged) - 1), max_size=8)):
        damaged[at] = data.draw(st.integers(0, 255))
    kept = data.draw(st.sampled_from((1.0, 1.0, 0.95, 0.5, 0.1)))
    path.write_bytes(bytes(damaged[: int(kept * len(damaged))]))
    try:
        found = read_photo_facts(path, "band.tif")
    except PhotoError:
        return
    assert abs(found.latitude_deg) <= 90.0


def test_a_preview_behind_the_image_may_be_cut(tmp_path: Path, whole: bytes) -> None:
    path = tmp_path / "mpf.jpg"
    path.write_bytes(whole + b"\xff\xd8" + struct.pack(">H", 7) * 20)
    assert read_photo_facts(path, "mpf.jpg").cols == 640


@pytest.mark.parametrize("fill", [1, 14])
def test_fill_bytes_may_stand_before_any_marker(tmp_path: Path, whole: bytes, fill: int) -> None:
    """ISO/IEC 10918-1, B.1.1.2."""
    filled = bytearray(whole[:2])
    at = 2
    while True:
        size = 2 + int.from_bytes(whole[at + 2 : at + 4])
        if whole[at + 1] == 0xDA:
            break
        filled += b"\xff" * fill + whole[at : at + size]
        at += size
    filled += b"\xff" * fill + whole[at:-2] + b"\xff" * fill + whole[-2:]
    path = tmp_path / "filled.jpg"
    path.write_bytes(bytes(filled))
    plain = tmp_path / "plain.jpg"
    plain.write_bytes(whole)
    assert read_photo_facts(path, "a") == replace(
        read_photo_facts(plain, "a"), path=path, size_bytes=len(filled)
    )
    for share in (0.3, 0.6, 0.9, 0.99):
        path.write_bytes(bytes(filled[: int(share * len(filled))]))
        with pytest.raises(PhotoError, match="cut off"):
            read_photo_facts(path, "a")


@pytest.mark.parametrize(
    "more",
    [b"\xff\x01", b"\xff\xd0", b"\xff\x00", b"\xff\xd8", b"\xff\xfe\0\x06\xff\xd9ab", b"\0\0"],
    ids=["temporary", "restart", "stuffed", "start", "a comment like an end", "zeros"],
)
def test_what_decoders_pass_over_is_no_damage(tmp_path: Path, whole: bytes, more: bytes) -> None:
    at = whole.index(b"\xff\xdb")
    path = tmp_path / "odd.jpg"
    path.write_bytes(whole[:at] + more + whole[at:] + b"a film behind the photo" * 99)
    assert read_photo_facts(path, "a").cols == 640
    path.write_bytes(whole[:at] + more + whole[at:-2])
    with pytest.raises(PhotoError, match="cut off"):
        read_photo_facts(path, "a")


def test_the_aircrafts_serial_and_the_time_of_exposure_stand_in_for_the_cameras(
    tmp_path: Path,
) -> None:
    facts = {"DroneSerialNumber": "1581F", "UTCAtExposure": "2025-06-15T15:27:14.501234"}
    xmp = packet({f"drone-dji:{name}": value for name, value in facts.items()})
    found = read_photo_facts(photo(tmp_path / "a.JPG", xmp=xmp, camera=""), "a")
    assert found.camera == ("Made", "Camera", "1581F")
    assert found.satellite_ns == CLOCK_NS
    assert read_photo_facts(photo(tmp_path / "b.JPG", xmp=xmp), "b").camera[2] == "CAM-1"


def test_hostile_xmp_costs_what_it_states_and_is_named(tmp_path: Path) -> None:
    entities = b'<!DOCTYPE x [<!ENTITY a "aaaa">]>' + DJI.replace(b"+59.80", b"&a;")
    found = read_photo_facts(photo(tmp_path / "a.JPG", xmp=entities), "a")
    assert (found.attitude, found.height_above_takeoff_m) == (None, None)
    assert found.notes == ("its XMP is not read: a document type, which XMP never has",)


def test_names_are_unique_and_without_spaces() -> None:
    paths = [Path(p) for p in ("a/D 1.JPG", "100/X.JPG", "101/X.JPG", "b/101/X.JPG", "c/y.jpg")]
    names = unique_names(paths)
    assert names[paths[0]] == "D_1.JPG"
    assert [names[p] for p in paths[1:]] == ["100_X.JPG", "101_X.JPG", "101_X-2.JPG", "y.jpg"]
