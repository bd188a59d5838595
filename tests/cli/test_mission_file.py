"""Missions from files: read as they are, or one sentence that names the file and what is wrong."""

import contextlib
import json
from pathlib import Path
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from recon.cli.mission_file import MissionFileError, read_mission
from recon.client import Mission, Waypoint

WAYPOINT = {
    "latitude_deg": 41.9,
    "longitude_deg": -93.6,
    "height_above_takeoff_m": 40.0,
    "speed_mps": 5.0,
}
LINE = {"type": "LineString", "coordinates": [[-93.6, 41.9], [-93.6, 41.901, 55.0]]}


def written(folder: Path, value: Any) -> Path:
    path = folder / "mission.json"
    path.write_text(value if isinstance(value, str) else json.dumps(value), encoding="utf-8")
    return path


def test_recons_own_form_is_read_whole(tmp_path: Path) -> None:
    second = {**WAYPOINT, "loiter_s": 3, "gimbal_pitch_deg": None, "corner_radius_m": 2.0}
    value = {"waypoints": [WAYPOINT, second], "land_at_end": True}
    assert read_mission(written(tmp_path, value), None, None) == Mission(
        (
            Waypoint(41.9, -93.6, 40.0, 5.0),
            Waypoint(41.9, -93.6, 40.0, 5.0, corner_radius_m=2.0, loiter_s=3.0),
        ),
        land_at_end=True,
    )


@pytest.mark.parametrize(
    "value",
    [
        LINE,
        {"type": "Feature", "geometry": LINE, "properties": {}},
        {"type": "FeatureCollection", "features": [{"type": "Feature", "geometry": LINE}]},
    ],
)
def test_a_line_is_a_mission_with_height_and_speed(tmp_path: Path, value: Any) -> None:
    mission = read_mission(written(tmp_path, value), 30.0, 4.0)
    assert mission.waypoints == (
        Waypoint(41.9, -93.6, 30.0, 4.0),
        Waypoint(41.901, -93.6, 30.0, 4.0),
    )


def test_heights_of_a_line_are_above_takeoff(tmp_path: Path) -> None:
    line = {"type": "LineString", "coordinates": [[-93.6, 41.9, 20.0], [-93.6, 41.901, 55.0]]}
    mission = read_mission(written(tmp_path, line), None, 4.0)
    assert [w.height_above_takeoff_m for w in mission.waypoints] == [20.0, 55.0]


@pytest.mark.parametrize(
    ("value", "sentence"),
    [
        ("", "expected a mission: Recon's own JSON"),
        ("{", "expected a mission: Recon's own JSON"),
        ("[" * 100_000, "expected a mission: Recon's own JSON"),
        ('{"waypoints": [NaN]}', "NaN is not a JSON number"),
        ("[1]", "expected a JSON object"),
        ({}, "got neither"),
        ({"type": "Polygon"}, '"Polygon"'),
        ({"waypoints": 5}, "waypoints: expected a list, got 5"),
        ({"waypoints": [5]}, "waypoint 1: expected an object"),
        ({"waypoints": [{**WAYPOINT, "speed": 5}]}, 'got "speed"'),
        ({"waypoints": [{**WAYPOINT, "speed_mps": "5"}]}, "speed_mps: expected a number"),
        ({"waypoints": [{**WAYPOINT, "speed_mps": True}]}, "expected a number, got true"),
        ({"waypoints": [{"latitude_deg": 1.0}]}, "expected height_above_takeoff_m"),
        ({"waypoints": [WAYPOINT], "land": True}, 'got "land"'),
        ({"waypoints": [WAYPOINT], "curved": 1}, "expected true or false"),
        ({"waypoints": [WAYPOINT] * 5_001}, "up to 5000 waypoints"),
        ({"type": "FeatureCollection", "features": []}, "one LineString, got 0"),
        ({"type": "FeatureCollection", "features": [LINE, LINE]}, "one LineString, got 2"),
        ({"type": "LineString", "coordinates": [[1.0]]}, "position 1: expected longitude"),
        ({"type": "LineString", "coordinates": 5}, "coordinates: expected a list"),
    ],
)
def test_an_invalid_file_is_one_sentence(tmp_path: Path, value: Any, sentence: str) -> None:
    path = written(tmp_path, value)
    with pytest.raises(MissionFileError) as caught:
        read_mission(path, 30.0, 4.0)
    assert sentence in str(caught.value)
    assert str(path) in str(caught.value)


def test_a_line_without_speed_or_height_asks_for_them(tmp_path: Path) -> None:
    path = written(tmp_path, LINE)
    with pytest.raises(MissionFileError, match="use --speed"):
        read_mission(path, 30.0, None)
    with pytest.raises(MissionFileError, match="position 1 has no height: use --height"):
        read_mission(path, None, 4.0)


def test_a_huge_file_is_not_read(tmp_path: Path) -> None:
    path = tmp_path / "huge.json"
    with path.open("wb") as file:
        file.truncate(1 << 32)
    with pytest.raises(MissionFileError, match="got more"):
        read_mission(path, None, None)


JSON_VALUES = st.recursive(
    st.none() | st.booleans() | st.floats() | st.text(max_size=5),
    lambda inner: (
        st.lists(inner, max_size=4)
        | st.dictionaries(
            st.sampled_from(["type", "waypoints", "coordinates", "features", "geometry", *WAYPOINT])
            | st.text(max_size=3),
            inner,
            max_size=4,
        )
    ),
    max_leaves=20,
)


@given(value=JSON_VALUES)
def test_any_json_is_a_mission_or_a_sentence(
    tmp_path_factory: pytest.TempPathFactory, value: Any
) -> None:
    path = tmp_path_factory.getbasetemp() / "any.json"
    path.write_text(json.dumps(value), encoding="utf-8")
    with contextlib.suppress(MissionFileError):
        assert isinstance(read_mission(path, 30.0, 4.0), Mission)
