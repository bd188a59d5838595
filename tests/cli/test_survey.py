"""`recon survey` at a real station with simulated drones."""

import json
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from tests.cli.station_process import StationProcess, station_process

from recon.station.host.http_servers import local_person

FLOWN = ("--height", "40", "--speed", "5")


@pytest.fixture(scope="module")
def station(tmp_path_factory: pytest.TempPathFactory) -> Iterator[StationProcess]:
    """Two drones on the ground, on their pads."""
    with station_process(tmp_path_factory.mktemp("audit"), 2, "--grounded") as made:
        yield made


def outline(station: StationProcess) -> list[list[float]]:
    areas = station.get("/api/state")["site"]["areas"]
    ring: list[list[float]] = next(a["rings"][0] for a in areas if a["name"] == "west field")
    return ring


def feature(name: str, ring: list[list[float]]) -> dict[str, object]:
    geometry = {"type": "Polygon", "coordinates": [ring]}
    return {"type": "Feature", "properties": {"name": name}, "geometry": geometry}


def written(path: Path, *features: dict[str, object]) -> Path:
    path.write_text(json.dumps({"type": "FeatureCollection", "features": features}))
    return path


def audited(station: StationProcess) -> list[Any]:
    """Return all audit entries, page by page."""
    entries: list[Any] = []
    while page := station.get(f"/api/audit?after={entries[-1]['n'] if entries else 0}")["entries"]:
        entries += page
    return entries


class TestCreate:
    def test_a_region_of_the_site_is_planned_and_nothing_flies(
        self, station: StationProcess
    ) -> None:
        result = station.recon("survey", "create", "west field", *FLOWN)
        assert result.code == 0
        number = station.recon("survey", "status", "--json").json[0]["id"]
        assert result.out.startswith(f"survey {number}: planned, west field. Start it with ")
        assert f"recon survey start {number} VEHICLE" in result.out
        assert not any(v["is_flying"]["value"] for v in station.get("/api/vehicles"))

    def test_a_height_above_ground_is_planned_and_shown(self, station: StationProcess) -> None:
        result = station.recon("survey", "create", "west field", *FLOWN, "--above-ground")
        assert result.code == 0, result.out
        assert "40 m above ground" in result.out
        newest = station.recon("survey", "status", "--json").json[0]
        assert (newest["height_above_takeoff_m"], newest["height_above_ground_m"]) == (None, 40.0)
        estimate = station.recon("survey", "estimate", newest["id"]).out
        assert "height above ground  40 m over the region" in estimate

    def test_what_it_takes_is_printed_before_a_start(self, station: StationProcess) -> None:
        created = station.recon("survey", "create", "west field", *FLOWN, "--camera", "mini3pro")
        number = created.out.split(":")[0].split()[1]
        result = station.recon("survey", "estimate", number, "SIM-1", "SIM-2")
        assert result.code == 0
        assert "pixel on the ground  1.38 cm" in result.out
        assert "batteries  2" in result.out
        alone = station.recon("survey", "estimate", number, "SIM-1", "--json").json
        both = station.recon("survey", "estimate", number, "SIM-1", "SIM-2", "--json").json
        assert both["time_s"] < alone["time_s"]
        assert [drone["serial"] for drone in both["drones"]] == ["SIM-1", "SIM-2"]
        assert not any(v["is_flying"]["value"] for v in station.get("/api/vehicles"))

    def test_a_file_is_planned_under_its_features_name(
        self, station: StationProcess, tmp_path: Path
    ) -> None:
        path = written(tmp_path / "own.geojson", feature("my corner", outline(station)))
        result = station.recon("survey", "create", path, *FLOWN, "--json")
        assert result.code == 0
        assert result.json["name"] == "my corner"
        assert result.json["figures"]["region_m2"] > 10_000.0

    @pytest.mark.parametrize(
        ("change", "words"),
        [
            ("nothing", "no such file"),
            ("text", "got another kind of file"),
            ("point", "expected a polygon, got points alone"),
            ("crossed", "bad: its outline touches itself at longitude"),
            ("far", "'bad': expected corners within 50 km"),
            ("two", "expected one region, got 2: choose one with --feature ('a', 'b')"),
        ],
    )
    def test_a_bad_file_is_located_and_no_survey_is_created(
        self, station: StationProcess, tmp_path: Path, change: str, words: str
    ) -> None:
        before = station.recon("survey", "status", "--json").json
        path = tmp_path / "bad.geojson"
        ring = outline(station)
        bad = feature("bad", ring)
        match change:
            case "text":
                path.write_text("fields")
            case "point":
                written(path, {**bad, "geometry": {"type": "Point", "coordinates": ring[0]}})
            case "crossed":
                written(path, feature("bad", [*ring[:-1], ring[1]]))
            case "far":
                written(path, feature("bad", [[lon + 3.0, lat] for lon, lat in ring]))
            case "two":
                written(path, feature("a", ring), feature("b", ring))
        result = station.recon("survey", "create", path, *FLOWN)
        assert result.code == 2
        assert path.name in result.err
        assert words.casefold() in result.err.casefold()
        assert station.recon("survey", "status", "--json").json == before

    @pytest.mark.parametrize(
        ("words", "reason"),
        [
            (
                ("no such field", *FLOWN),
                "Survey region 'no such field' not found; available: west field",
            ),
            (("west field", "--height", "40", "--speed", "14"), "fly at"),
            (
                ("west field", *FLOWN, "--planner", "best"),
                "Unknown planner best: choose lawnmower_once",
            ),
        ],
    )
    def test_an_impossible_survey_is_refused(
        self, station: StationProcess, words: tuple[str, ...], reason: str
    ) -> None:
        result = station.recon("survey", "create", *words)
        assert result.code == 1
        assert reason in result.out


class TestStart:
    @pytest.fixture
    def number(self, station: StationProcess) -> int:
        made = station.recon("survey", "create", "west field", *FLOWN, "--json").json
        asked: int = made["id"]
        return asked

    @pytest.mark.parametrize("vehicles", [(), ("SIM-9",)])
    def test_missing_and_unknown_vehicles_are_wrong_use(
        self, station: StationProcess, number: int, vehicles: tuple[str, ...]
    ) -> None:
        assert station.recon("survey", "start", number, *vehicles).code == 2

    def test_it_takes_off_flies_holds_and_is_audited(
        self, station: StationProcess, number: int
    ) -> None:
        """From the start command to the first row, and to the hold; all in the audit."""
        started = station.recon("survey", "start", number, "SIM-1", "--takeoff")
        assert started.code == 0
        assert "running" in started.out
        station.until(lambda vehicles: any(v["is_flying"]["value"] for v in vehicles))
        flying = station.recon("survey", "status", number, "--json").json[0]
        assert flying["vehicles"][0]["is_flying_rows"]
        assert station.recon("survey", "abort", number).code == 0
        assert station.recon("survey", "start", number, "SIM-1").code == 1
        entries = audited(station)
        kinds = {entry["kind"]: entry for entry in entries}
        assert kinds["survey.started"]["by"] == local_person().label
        assert kinds["survey.started"]["details"]["serials"] == ["SIM-1"]
        assert kinds["survey.aborted"]["details"]["id"] == number
        assert kinds["survey.refused"]["details"]["asked"] == "started"
        authorities = [e["details"]["holder"] for e in entries if e["kind"] == "authority.taken"]
        assert authorities[-2:] == ["guidance", "operator"]

    def test_the_action_when_done_is_an_option(self, station: StationProcess) -> None:
        asked = ("survey", "create", "west field", *FLOWN, "--json")
        assert station.recon(*asked).json["when_done"] == "return_home"
        assert station.recon(*asked, "--when-done", "hover").json["when_done"] == "hover"
        assert station.recon(*asked, "--when-done", "dance").code == 2


def test_an_unknown_survey_number_lists_the_known_ones(station: StationProcess) -> None:
    made = station.recon("survey", "create", "west field", *FLOWN, "--json").json["id"]
    looked, paused = (
        station.recon("survey", "status", 9_999),
        station.recon("survey", "pause", 9_999),
    )
    assert (looked.code, paused.code) == (2, 1)
    for text in (looked.err, paused.out):
        assert "Survey 9999 not found; available: " in text
        assert f"{made} west field (created)" in text


def test_a_refusal_is_json_too_where_that_is_asked_for(station: StationProcess) -> None:
    refused = station.recon("survey", "pause", 9_999, "--json")
    assert refused.code == 1
    assert refused.json["rule"] == "survey"
    assert "Survey 9999 not found" in refused.json["reason"]


def test_numbers_that_are_not_finite_are_refused_by_the_options_name(
    station: StationProcess,
) -> None:
    made = station.recon("survey", "create", "west field", "--height", "nan")
    assert made.code == 2
    assert made.err.splitlines()[-1].endswith("'--height': expected a number, got nan")
