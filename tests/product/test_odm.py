"""The folder for OpenDroneMap, read by the rules of its own reader, and a run that is ended."""

import re
from dataclasses import dataclass, replace
from errno import ENOSPC
from pathlib import Path

import pytest
from PIL import ExifTags, Image
from tests.product.made_flight import FRAME, START_NS, UTC_AHEAD_NS, flight, write_photo
from tests.product.photos.packets import packet

from recon.model.units import NS_PER_S
from recon.product import linked_folder
from recon.product.footprint import Aim, PhotoView
from recon.product.odm import write_odm_project
from recon.product.photos.photo import read_photo_facts
from recon.product.timing import TimedPhoto
from recon.product.write import masked_name

FLIGHT = flight()
RTK = {
    "drone-dji:AbsoluteAltitude": "+352.40",
    "drone-dji:AltitudeType": "RtkAlt",
    "drone-dji:GpsLatitude": "+41.9000000",
    "drone-dji:GpsLongitude": "-93.6000000",
    "drone-dji:GimbalYawDegree": "+31.0",
    "drone-dji:GimbalPitchDegree": "-88.00",
    "drone-dji:GimbalRollDegree": "+1.50",
    "drone-dji:RtkFlag": "50",
    "drone-dji:RtkStdLon": "0.0120",
    "drone-dji:RtkStdLat": "0.0150",
    "drone-dji:RtkStdHgt": "0.0310",
}
AS_ELEMENTS = re.sub(rb" (drone-dji:\w+)=\"([^\"]*)\"", rb"", packet(RTK)).replace(
    b"/>",
    b">"
    + b"".join(f"<{name}>{value}</{name}>".encode() for name, value in RTK.items())
    + b"</rdf:Description>",
    1,
)


@dataclass
class Read:
    """What OpenDroneMap knows of a photo."""

    place: tuple[float, float]
    altitude: float | None = None
    yaw: float | None = None
    pitch: float | None = None
    accuracy: tuple[float, float] | None = None


def read_by_its_rules(project: Path) -> dict[str, Read]:
    """EXIF, then attributes of XMP, then the lines of geo.txt, which replace all they can hold."""
    images = project / "images"
    photos = [path for path in sorted(images.iterdir()) if not path.stem.endswith("_mask")]
    found = {path.name: read_file(path) for path in photos}
    geo = project / "geo.txt"
    head, *lines = geo.read_text().splitlines() if geo.exists() else ["EPSG:4326"]
    assert head == "EPSG:4326"
    for line in lines:
        name, *parts = line.split()
        x, y, *rest = map(float, parts)
        each = found[name]
        each.place, each.altitude, each.accuracy = (y, x), rest[0] if rest else None, None
        if len(rest) >= 4:
            each.yaw, each.pitch = rest[1:3]
        if len(rest) >= 6:
            each.accuracy = rest[4], rest[5]
    return found


def read_file(path: Path) -> Read:
    with Image.open(path) as image:
        gps = image.getexif().get_ifd(ExifTags.IFD.GPSInfo)
        text = image.info.get("xmp", b"").decode()
    north, east = (sum(float(p) / 60**k for k, p in enumerate(gps[tag])) for tag in (2, 4))
    read = Read((-north if gps.get(1) == "S" else north, -east if gps.get(3) == "W" else east))
    read.altitude = float(gps[6]) if 6 in gps else None
    xmp = dict(re.findall(r' drone-dji:(\w+)="([^"]*)"', text))
    if "AbsoluteAltitude" in xmp:
        read.altitude = float(xmp["AbsoluteAltitude"])
    if "RtkStdLon" in xmp:
        across = max(float(xmp["RtkStdLon"]), float(xmp["RtkStdLat"]))
        read.accuracy = 2.0 * across, 2.0 * float(xmp["RtkStdHgt"])
    return read


def timed(folder: Path, name: str, xmp: bytes | None, **changes: object) -> TimedPhoto:
    clock_ns = UTC_AHEAD_NS + START_NS + 60 * NS_PER_S
    facts = {"place_m": (0.0, 0.0), "clock_ns": clock_ns, "size": (16, 12)} | changes
    photo = read_photo_facts(write_photo(folder / name, xmp=xmp, **facts), name)
    (folder / masked_name(name)).write_bytes(b"mask")
    view = PhotoView(Aim(0.0, 0.0, 60.0, 34.0, -88.0), 66.0, 16, 12)
    return TimedPhoto(photo, "SIM-1", 60 * NS_PER_S, 0.1, view, 60.0)


def test_each_photos_height_and_accuracy_arrive_as_the_photo_has_them(tmp_path: Path) -> None:
    sides = {"sides": None}
    photos = [
        timed(tmp_path, "plain.JPG", packet(RTK)),
        timed(tmp_path, "elements.JPG", AS_ELEMENTS),
        timed(tmp_path, "no-sides.JPG", packet(RTK), **sides),
        timed(tmp_path, "no-height.JPG", packet({k: RTK[k] for k in list(RTK)[2:4]}), **sides),
        timed(tmp_path, "exif.JPG", None, altitude_m=352.4),
    ]
    write_odm_project(tmp_path / "odm", tmp_path, FLIGHT, photos)
    found = read_by_its_rules(tmp_path / "odm")
    assert found.keys() == {each.photo.name for each in photos}
    place = FRAME.origin.latitude_deg, FRAME.origin.longitude_deg
    for name, read in found.items():
        assert read.place == pytest.approx(place, abs=1e-6), name
        assert read.altitude == (None if name == "no-height.JPG" else pytest.approx(352.4))
        if name in ("plain.JPG", "elements.JPG", "no-sides.JPG"):
            share = 2.0 if name == "plain.JPG" else 1.0
            assert read.accuracy == pytest.approx((0.015 * share, 0.031 * share))
    assert (found["elements.JPG"].yaw, found["elements.JPG"].pitch) == (34.0, 2.0)


def test_photos_that_say_it_all_need_no_file_and_an_older_one_goes(tmp_path: Path) -> None:
    project = tmp_path / "odm"
    project.mkdir()
    (project / "geo.txt").write_text("EPSG:4326\na.JPG 1 2\n")
    (project / "odm_orthophoto.tif").write_text("kept")
    photos = [timed(tmp_path, "a.JPG", packet(RTK)), timed(tmp_path, "b.JPG", None)]
    write_odm_project(project, tmp_path, FLIGHT, photos)
    assert sorted(path.name for path in project.iterdir()) == ["images", "odm_orthophoto.tif"]


def test_a_full_disk_leaves_the_older_project_whole(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    project = tmp_path / "odm"
    old, new = (timed(tmp_path, name, None) for name in ("old.JPG", "new.JPG"))
    write_odm_project(project, tmp_path, FLIGHT, [old])
    full = OSError(ENOSPC, "No space left on device")

    def only_photos(source: Path, target: Path) -> None:
        if "_mask" in target.name:
            raise full

    monkeypatch.setattr(linked_folder, "_link", only_photos)
    with pytest.raises(OSError, match="No space left"):
        write_odm_project(project, tmp_path, FLIGHT, [new])
    files = sorted(path.relative_to(project).as_posix() for path in project.rglob("*"))
    assert files == ["images", "images/old.JPG", "images/old_mask.JPG"]


@pytest.mark.parametrize("left", [("images.old",), ("images.old", "images.new"), ("images.new",)])
def test_a_run_goes_on_from_any_place_where_one_was_killed(
    tmp_path: Path, left: tuple[str, ...]
) -> None:
    project = tmp_path / "odm"
    photo = timed(tmp_path, "a.JPG", None)
    for name in left:
        (project / name).mkdir(parents=True)
        (project / name / "rest.JPG").touch()
    write_odm_project(project, tmp_path, FLIGHT, [photo])
    files = sorted(path.relative_to(project).as_posix() for path in project.rglob("*"))
    assert files == ["images", "images/a.JPG", "images/a_mask.JPG"]
    again = replace(photo, sigma_s=0.2)
    write_odm_project(project, tmp_path, FLIGHT, [again])
    assert sorted(path.relative_to(project).as_posix() for path in project.rglob("*")) == files
