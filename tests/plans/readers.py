"""Readers of the formats that know nothing of the writers, by packages where one has them.

Each returns the waypoints of a file's one flight, and the seconds or metres between photos. What a
format does not hold is taken from `by_hand`, as the pilot sets it.
"""

import csv
import io
import json
import zipfile
from dataclasses import dataclass, replace
from pathlib import Path
from xml.etree import ElementTree

import pyogrio.raw  # type: ignore[import-untyped, unused-ignore]
import shapely  # type: ignore[import-untyped, unused-ignore]
from pymavlink import mavwp

from recon.model.mission import Waypoint

SPACES = {"k": "http://www.opengis.net/kml/2.2", "w": "http://www.dji.com/wpmz/1.0.2"}


@dataclass(frozen=True)
class Read:
    waypoints: tuple[Waypoint, ...]
    every_s: float | None = None
    every_m: float | None = None
    returns: bool | None = None
    """Whether it returns home at its end; None: the file does not say."""


def read_wpml(data: bytes) -> Read:
    archive = zipfile.ZipFile(io.BytesIO(data))
    root = ElementTree.fromstring(archive.read("wpmz/waylines.wpml"))
    waypoints = []
    every: dict[str, float] = {}
    for placemark in root.iterfind(".//k:Placemark", SPACES):
        assert int(_text(placemark, "w:index")) == len(waypoints)
        assert "Stop" in _text(placemark, ".//w:waypointTurnMode")
        place = placemark.findtext("k:Point/k:coordinates", "", SPACES)
        longitude_deg, latitude_deg = map(float, place.split(","))
        pitch = placemark.findtext(".//w:gimbalPitchRotateAngle", None, SPACES)
        stay = placemark.findtext(".//w:hoverTime", None, SPACES)
        waypoints.append(
            Waypoint(
                latitude_deg,
                longitude_deg,
                float(_text(placemark, "w:executeHeight")),
                float(_text(placemark, "w:waypointSpeed")),
                loiter_s=None if stay is None else float(stay),
                gimbal_pitch_deg=None if pitch is None else float(pitch),
            )
        )
        for trigger in placemark.iterfind(".//w:actionTrigger", SPACES):
            param = trigger.findtext("w:actionTriggerParam", None, SPACES)
            if param is not None:
                every[_text(trigger, "w:actionTriggerType")] = float(param)
    returns = _text(root, ".//w:finishAction") == "goHome"
    timed, spaced = every.get("multipleTiming"), every.get("multipleDistance")
    return Read(tuple(waypoints), timed, spaced, returns)


def read_waypoints(data: bytes, folder: Path) -> Read:
    path = folder / "read.waypoints"
    path.write_bytes(data)
    loader = mavwp.MAVWPLoader()
    loader.load(str(path))
    items = [loader.wp(number) for number in range(loader.count())]
    assert [item.seq for item in items] == list(range(len(items)))
    assert items[0].frame == 0
    assert items[0].current == 1
    return _of_items(
        (i.command, (i.param1, i.param2, i.param3, i.param4), (i.x, i.y, i.z)) for i in items[1:]
    )


def read_qgc(data: bytes) -> Read:
    document = json.loads(data)
    assert (document["fileType"], document["version"]) == ("Plan", 1)
    mission = document["mission"]
    assert mission["version"] == 2
    assert document["geoFence"]["version"] == document["rallyPoints"]["version"] == 2
    assert len(mission["plannedHomePosition"]) == 3
    items = []
    for item in mission["items"]:
        if item["type"] == "ComplexItem":
            assert (item["complexItemType"], item["version"]) == ("survey", 5)
            transects = item["TransectStyleComplexItem"]
            assert transects["version"] == transects["CameraCalc"]["version"] == 2
            assert len(item["polygon"]) >= 3
            items += transects["Items"]
        else:
            items.append(item)
    assert [item["doJumpId"] for item in items] == list(range(1, len(items) + 1))
    for item in items:
        assert item["frame"] == (3 if item["command"] in (16, 21, 22) else 2)
        assert len(item["params"]) == 7
    return _of_items((i["command"], i["params"][:4], i["params"][4:]) for i in items)


def _of_items(items) -> Read:  # type: ignore[no-untyped-def]
    """What an autopilot makes of MAVLink items: commands hold from where they stand."""
    waypoints: list[Waypoint] = []
    every_s = every_m = pitch_deg = None
    speed_mps, returns = 0.0, False
    for command, parameters, place in items:
        match command:
            case 16:
                here = Waypoint(*place, speed_mps, loiter_s=parameters[0] or None)
                waypoints.append(replace(here, gimbal_pitch_deg=pitch_deg))
                pitch_deg = None
            case 178:
                speed_mps = parameters[1]
                if waypoints:
                    waypoints[-1] = replace(waypoints[-1], speed_mps=speed_mps)
            case 205:
                pitch_deg = parameters[0]
                assert place[2] == 2
            case 2000:
                every_s = parameters[1]
            case 206 if parameters[0]:
                every_m = parameters[0]
            case 20:
                returns = True
            case _:
                assert command in (22, 206, 2001), command
    return Read(tuple(waypoints), every_s, every_m, returns)


def read_litchi(data: bytes) -> Read:
    rows = list(csv.DictReader(io.StringIO(data.decode("ascii"))))
    waypoints = []
    for row in rows:
        assert len(row) == 46
        assert row["altitudemode"] == "0"
        assert row["gimbalmode"] == "2"
        assert float(row["curvesize(m)"]) == 0.0
        stays = row["actiontype1"] == "0"
        waypoints.append(
            Waypoint(
                float(row["latitude"]),
                float(row["longitude"]),
                float(row["altitude(m)"]),
                float(row["speed(m/s)"]),
                loiter_s=float(row["actionparam1"]) / 1000.0 if stays else None,
                gimbal_pitch_deg=float(row["gimbalpitchangle"]),
            )
        )
    every_s, every_m = (float(rows[0][f"photo_{of}interval"]) for of in ("time", "dist"))
    return Read(tuple(waypoints), _set(every_s), _set(every_m))


def read_by_gdal(data: bytes, layer: str | None, height_m: float, speed_mps: float) -> Read:
    """KML's path, or GPX's route, with height and speed as the pilot sets them."""
    _, _, shapes, _ = pyogrio.raw.read(data, layer=layer)
    lines = [shape for shape in shapely.from_wkb(shapes) if shape.geom_type == "LineString"]
    (line,) = lines
    places = shapely.get_coordinates(line).tolist()
    return Read(tuple(Waypoint(lat, lon, height_m, speed_mps) for lon, lat in places))


def _text(element: ElementTree.Element, path: str) -> str:
    found = element.findtext(path, None, SPACES)
    assert found is not None, path
    return found.strip()


def _set(value: float) -> float | None:
    return None if value == -1.0 else value
