"""`recon survey` at a real station with simulated drones: from a region to rows that are flown."""

import json
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from tests.cli.flown import Flown, flown

FLOWN = ("--height", "40", "--speed", "5")


@pytest.fixture(scope="module")
def here(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Flown]:
    """Two drones on the ground, on their pads."""
    with flown(tmp_path_factory.mktemp("audit"), 2, "--grounded") as made:
        yield made


def outline(here: Flown) -> list[list[float]]:
    areas = here.get("/api/state")["site"]["areas"]
    ring: list[list[float]] = next(a["rings"][0] for a in areas if a["name"] == "west field")
    return ring


def feature(name: str, ring: list[list[float]]) -> dict[str, object]:
    geometry = {"type": "Polygon", "coordinates": [ring]}
    return {"type": "Feature", "properties": {"name": name}, "geometry": geometry}


def written(path: Path, *features: dict[str, object]) -> Path:
    path.write_text(json.dumps({"type": "FeatureCollection", "features": features}))
    return path


def audited(here: Flown) -> list[Any]:
    """All that the audit has, page by page."""
    entries: list[Any] = []
    while page := here.get(f"/api/audit?after={entries[-1]['n'] if entries else 0}")["entries"]:
        entries += page
    return entries


class TestCreate:
    def test_a_region_of_the_site_is_planned_and_nothing_flies(self, here: Flown) -> None:
        said = here.recon("survey", "create", "west field", *FLOWN)
        assert said.code == 0
        number = here.recon("survey", "status", "--json").json[0]["id"]
        assert said.out.startswith(f"survey {number}: planned, west field. Nothing flies by this")
        assert f"recon survey start {number} VEHICLE" in said.out
        assert not any(v["is_flying"]["value"] for v in here.get("/api/vehicles"))

    def test_a_file_is_planned_under_its_features_name(self, here: Flown, tmp_path: Path) -> None:
        path = written(tmp_path / "own.geojson", feature("my corner", outline(here)))
        said = here.recon("survey", "create", path, *FLOWN, "--json")
        assert said.code == 0
        assert said.json["name"] == "my corner"
        assert said.json["figures"]["region_m2"] > 10_000.0

    @pytest.mark.parametrize(
        ("change", "words"),
        [
            ("nothing", "no such file"),
            ("text", "no JSON at line 1"),
            ("point", "feature 1 ('bad'): expected a Polygon or MultiPolygon, got 'Point'"),
            ("open", "feature 1 ('bad'): expected each ring to end where it starts"),
            ("far", "feature 1 ('bad'): expected corners within 50 km"),
            ("two", "expected one feature, got 2: name one with --feature ('a', 'b')"),
        ],
    )
    def test_a_bad_file_is_told_with_its_place_and_nothing_is_begun(
        self, here: Flown, tmp_path: Path, change: str, words: str
    ) -> None:
        before = here.recon("survey", "status", "--json").json
        path = tmp_path / "bad.geojson"
        ring = outline(here)
        bad = feature("bad", ring)
        match change:
            case "text":
                path.write_text("fields")
            case "point":
                written(path, {**bad, "geometry": {"type": "Point", "coordinates": ring[0]}})
            case "open":
                written(path, feature("bad", [*ring[:-1], ring[1]]))
            case "far":
                written(path, feature("bad", [[lon + 3.0, lat] for lon, lat in ring]))
            case "two":
                written(path, feature("a", ring), feature("b", ring))
        said = here.recon("survey", "create", path, *FLOWN)
        assert said.code == 2
        assert str(path) in said.err
        assert words.casefold() in said.err.casefold()
        assert here.recon("survey", "status", "--json").json == before

    @pytest.mark.parametrize(
        ("words", "told"),
        [
            (("no such field", *FLOWN), "the site has no survey region 'no such field'"),
            (("west field", "--height", "40", "--speed", "14"), "fly at"),
            (("west field", *FLOWN, "--planner", "best"), "no planner best"),
        ],
    )
    def test_what_cannot_be_flown_is_refused(
        self, here: Flown, words: tuple[str, ...], told: str
    ) -> None:
        said = here.recon("survey", "create", *words)
        assert said.code == 1
        assert told in said.out


class TestStart:
    @pytest.fixture
    def number(self, here: Flown) -> int:
        made = here.recon("survey", "create", "west field", *FLOWN, "--json").json
        asked: int = made["id"]
        return asked

    @pytest.mark.parametrize("vehicles", [(), ("SIM-9",)])
    def test_nobody_and_strangers_are_wrong_use(
        self, here: Flown, number: int, vehicles: tuple[str, ...]
    ) -> None:
        assert here.recon("survey", "start", number, *vehicles).code == 2

    def test_it_takes_off_flies_holds_and_is_on_record(self, here: Flown, number: int) -> None:
        """From the word to the first row's way, and to the hold: who said what is in the audit."""
        started = here.recon("survey", "start", number, "SIM-1", "--takeoff")
        assert started.code == 0
        assert "running" in started.out
        here.until(lambda told: any(v["is_flying"]["value"] for v in told))
        flying = here.recon("survey", "status", number, "--json").json[0]
        assert flying["vehicles"][0]["is_flying_rows"]
        assert here.recon("survey", "abort", number).code == 0
        assert here.recon("survey", "start", number, "SIM-1").code == 1
        entries = audited(here)
        kinds = {entry["kind"]: entry for entry in entries}
        assert kinds["survey.started"]["by"] == "api 127.0.0.1"
        assert kinds["survey.started"]["details"]["serials"] == ["SIM-1"]
        assert kinds["survey.aborted"]["details"]["id"] == number
        assert kinds["survey.refused"]["details"]["asked"] == "started"
        authorities = [e["details"]["holder"] for e in entries if e["kind"] == "authority.taken"]
        assert authorities[-2:] == ["guidance", "operator"]

    def test_what_its_vehicles_do_then_is_said(self, here: Flown) -> None:
        asked = ("survey", "create", "west field", *FLOWN, "--json")
        assert here.recon(*asked).json["when_done"] == "return_home"
        assert here.recon(*asked, "--when-done", "hover").json["when_done"] == "hover"
        assert here.recon(*asked, "--when-done", "dance").code == 2


def test_a_survey_that_is_not_there_is_told_with_those_there_are(here: Flown) -> None:
    made = here.recon("survey", "create", "west field", *FLOWN, "--json").json["id"]
    looked, paused = here.recon("survey", "status", 9_999), here.recon("survey", "pause", 9_999)
    assert (looked.code, paused.code) == (2, 1)
    for told in (looked.err, paused.out):
        assert "Survey 9999 not found; available: " in told
        assert f"{made} west field (created)" in told
