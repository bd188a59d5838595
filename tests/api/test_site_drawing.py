"""The site drawn in the console: checked, saved with undo, in force at once, never in flight."""

import asyncio
import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import rasterio
from tests.api.client import Client
from tests.api.fake_station import FakeStation, application
from tests.api.site_editor import SiteEditor

from recon.api.schema import SiteDrawingRequest
from recon.model.command import Refusal
from recon.model.event import SiteRedrawn
from recon.model.geo import GeoPoint
from recon.model.person import Person, Role
from recon.record.files import file_set
from recon.site import load_site
from recon.site.new_site import NewSiteFields, make_site
from recon.station.control import site_drawing
from recon.station.state.steps import StepTaken

LON, LAT = -93.6034, 41.9012


def ring(half_deg: float, east_deg: float = 0.0) -> list[list[float]]:
    """A closed square round the origin, or east of it."""
    west, east = LON + east_deg - half_deg, LON + east_deg + half_deg
    south, north = LAT - half_deg, LAT + half_deg
    return [[west, south], [east, south], [east, north], [west, north], [west, south]]


def area(layer: str, *rings: list[list[float]], **properties: object) -> dict[str, Any]:
    geometry = {"type": "Polygon", "coordinates": list(rings)}
    return {"layer": layer, "geometry": geometry, "properties": properties}


def pad(name: str, altitude_m: float = 275.0) -> dict[str, Any]:
    geometry = {"type": "Point", "coordinates": [LON, LAT]}
    properties = {"name": name, "altitude_m": altitude_m}
    return {"layer": "landing_pads", "geometry": geometry, "properties": properties}


def add_elevation(folder: Path, half_deg: float) -> None:
    """Lay a flat elevation model around the origin."""
    cells = 200
    step_deg = 2 * half_deg / cells
    place = rasterio.Affine(step_deg, 0.0, LON - half_deg, 0.0, -step_deg, LAT + half_deg)
    shape = {"width": cells, "height": cells, "count": 1, "dtype": "float32"}
    with rasterio.open(
        folder / "ground.tif", "w", driver="GTiff", crs="EPSG:4979", transform=place, **shape
    ) as file:
        file.write(np.full((1, cells, cells), 275.0, np.float32))
    with (folder / "site.toml").open("a") as file:
        file.write('[elevation]\nfile = "ground.tif"\ndatum = "wgs84"\n')


BOUNDARY = area("boundary", ring(0.002), name="field")
REGION = area("survey_regions", ring(0.0012), ring(0.0003), name="north")


class Editor(SiteEditor):
    """A person who draws."""

    PART, ITEMS = "drawing", "features"

    def areas(self) -> list[str]:
        site = self.client.get("/api/state").json()["site"]
        return [each["kind"] for each in site["areas"]]


@pytest.fixture
def editor(tmp_path: Path) -> Editor:
    folder = tmp_path / "field"
    make_site(
        folder, GeoPoint(LAT, LON, 275.0), NewSiteFields(name="field", drones=2, has_imager=False)
    )
    return Editor(folder, FakeStation(load_site(folder)))


def test_a_drawing_is_in_force_at_once_and_after_a_start(editor: Editor) -> None:
    answer = editor.save(BOUNDARY, REGION, pad("home"))
    assert (answer["accepted"], answer["reason"]) == (True, None)
    assert answer["layers"] == ["boundary", "landing_pads", "survey_regions"]
    assert editor.areas() == ["boundary", "survey"]
    assert editor.station.driver.station.airspace.boundary is not None
    started = load_site(editor.folder)
    assert started.layers.boundary is not None
    assert len(started.layers.survey_regions["north"].holes_m) == 1
    assert [each.name for each in started.layers.landing_pads] == ["home"]
    assert editor.read()["features"] == [BOUNDARY, pad("home"), REGION]


def test_its_layers_are_named_alike_for_an_undo_and_in_the_audit(editor: Editor) -> None:
    entries: list[str] = []

    def observe(step: StepTaken) -> None:
        if isinstance(step.event, SiteRedrawn):
            entries.append(site_drawing.entry(step.before, step.event, step.now_ns).text)

    editor.station.driver.observe = observe
    editor.save(BOUNDARY, area("keep_out", ring(0.001), name="wood"))
    assert editor.read()["undo"]["what"] == "boundary, keep-out"
    assert entries == ["site drawn anew: boundary, keep-out"]


def test_undo_takes_back_one_change_after_the_other(editor: Editor) -> None:
    assert editor.read()["undo"] is None
    editor.save(BOUNDARY)
    editor.save(BOUNDARY, REGION)
    assert editor.read()["undo"]["what"] == "survey regions"
    assert editor.undo()["accepted"]
    assert editor.areas() == ["boundary"]
    assert editor.undo()["accepted"]
    assert editor.areas() == []
    assert editor.station.driver.station.airspace.boundary is None
    assert load_site(editor.folder).layers.files == {}
    assert editor.undo()["reason"] == "No change of the site to undo"


def test_a_layer_without_features_leaves_the_folder_as_a_start_reads_it(editor: Editor) -> None:
    editor.save(BOUNDARY, REGION)
    editor.save(REGION)
    assert editor.areas() == ["survey"]
    assert load_site(editor.folder).layers.files == {"survey_regions": "survey_regions.geojson"}


@pytest.mark.parametrize(
    ("features", "expected"),
    [
        (
            [
                area(
                    "boundary",
                    [[LON, LAT], [LON + 0.001, LAT + 0.001], *ring(0.001)[1:3], [LON, LAT]],
                )
            ],
            "edges do not meet",
        ),
        ([BOUNDARY, BOUNDARY], "expected one polygon"),
        ([BOUNDARY, pad("a"), pad("a")], "each pad once"),
        ([area("boundary", ring(0.00001)), pad("a")], "inside the boundary"),
        ([area("height_zones", ring(0.001), name="a")], "floor_m, ceiling_m or both"),
        ([area("keep_out", ring(0.001), colour="red")], "only the keys"),
        ([area("boundary", ring(0.001, east_deg=5.0))], "within 50 km"),
    ],
)
@pytest.mark.parametrize("end", ["", "/check"])
def test_what_a_start_would_refuse_is_not_saved(
    editor: Editor, features: list[dict[str, Any]], expected: str, end: str
) -> None:
    answer = editor.save(*features, end=end)
    assert not answer["accepted"]
    assert expected in answer["reason"]
    assert "staged" not in answer["reason"]
    assert editor.read()["features"] == []
    assert sorted(path.name for path in editor.folder.iterdir()) == ["site.toml"]


def test_a_refusal_names_the_feature(editor: Editor) -> None:
    crossed = [[LON, LAT], [LON + 0.001, LAT + 0.001], *ring(0.001)[1:3], [LON, LAT]]
    bad = area("keep_out", crossed, name="barn (old)")
    answer = editor.save(pad("a"), area("keep_out", ring(0.001)), BOUNDARY, bad, end="/check")
    assert answer["feature"] == 3
    assert answer["reason"].startswith("Expected a polygon whose edges do not meet, but")
    unclear = area("height_zones", ring(0.001), name="a", floor_m="high")
    assert editor.save(BOUNDARY, unclear)["feature"] == 1
    assert editor.save(BOUNDARY, BOUNDARY)["feature"] is None


def test_a_check_saves_nothing(editor: Editor) -> None:
    answer = editor.save(BOUNDARY, end="/check")
    assert (answer["accepted"], answer["layers"]) == (True, ["boundary"])
    assert editor.areas() == []
    assert editor.read()["undo"] is None


def test_one_of_two_screens_saves_first(editor: Editor) -> None:
    seen = editor.read()["revision"]
    assert editor.save(BOUNDARY, revision=seen)["accepted"]
    assert "changed meanwhile" in editor.save(REGION, revision=seen)["reason"]


def test_a_file_changed_by_hand_is_not_overwritten(editor: Editor) -> None:
    with (editor.folder / "site.toml").open("a") as file:
        file.write("# checked by anna\n")
    assert "changed by hand" in editor.save(BOUNDARY)["reason"]


def test_an_undo_does_not_lose_what_was_edited_by_hand_before_a_restart(editor: Editor) -> None:
    editor.save(BOUNDARY)
    site_file = editor.folder / "site.toml"
    edited = site_file.read_text().replace("= 120.0", "= 60.0")
    site_file.write_text(edited)
    again = Editor(editor.folder, FakeStation(load_site(editor.folder)))
    answer = again.undo()
    assert "site.toml was edited since then" in answer["reason"]
    assert site_file.read_text() == edited
    assert again.areas() == ["boundary"]


def test_layers_that_cannot_be_read_lock_the_drawing(editor: Editor) -> None:
    editor.save(BOUNDARY)
    (editor.folder / "boundary.geojson").write_text("{")
    view = editor.read()
    assert "changed by hand" in view["locked_reason"]
    assert view["features"] == []
    assert "changed by hand" in editor.save(REGION)["reason"]


def test_a_hostile_history_writes_nothing_outside_the_folder(editor: Editor) -> None:
    editor.save(BOUNDARY)
    manifest = editor.folder / "history" / "0001" / file_set.MANIFEST
    text = manifest.read_text().replace('"boundary.geojson"', '"../../outside.txt"')
    manifest.write_text(text)
    assert "inside the folder" in editor.undo()["reason"]
    assert not (editor.folder.parent.parent / "outside.txt").exists()


def test_attributes_are_plain_values(editor: Editor) -> None:
    body = {"revision": "", "features": [area("keep_out", ring(0.001), name=[["a"]])]}
    assert editor.client.post("/api/site/drawing", json=body).status_code == 422


def test_comments_and_other_tables_of_the_site_file_stay(editor: Editor) -> None:
    before = (editor.folder / "site.toml").read_text()
    editor.save(BOUNDARY)
    after = (editor.folder / "site.toml").read_text()
    added = 'boundary = "boundary.geojson"\n'
    assert after.replace(added, "", 1) == before


def test_without_a_folder_nothing_is_saved() -> None:
    client = Client(application(FakeStation()))
    assert "recon site new" in client.get("/api/site/drawing").json()["locked_reason"]
    body = {"revision": "", "features": [BOUNDARY]}
    answer = client.post("/api/site/drawing", json=body).json()
    assert "recon site new" in answer["reason"]


def test_fences_are_an_administrators_and_regions_an_operators(editor: Editor) -> None:
    anna = Person("anna", Role.OPERATOR)
    folder = editor.station.drawing

    def saved(*features: dict[str, Any]) -> str | None:
        body = {"revision": editor.read()["revision"], "features": list(features)}
        asked = SiteDrawingRequest.model_validate(body)
        return asyncio.run(folder.save(asked, anna, is_check=False)).reason

    assert saved(REGION) is None
    assert saved(REGION, BOUNDARY) == (
        "anna has the role operator; boundary, zones, pads and vehicles need admin"
    )


@pytest.mark.parametrize("is_undo", [False, True])
def test_a_drone_that_takes_off_while_the_disk_is_busy_keeps_its_fence(
    editor: Editor, is_undo: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    editor.save(BOUNDARY)
    before = (editor.folder / "boundary.geojson").read_bytes()
    in_force = editor.station.driver.station.airspace
    answers = iter([None, Refusal("site_drawing", "SIM-1 has taken off")])
    monkeypatch.setattr(site_drawing, "refusal", lambda *_: next(answers))
    answer = editor.undo() if is_undo else editor.save(area("boundary", ring(0.01)))
    assert answer["reason"] == "SIM-1 has taken off"
    assert (editor.folder / "boundary.geojson").read_bytes() == before
    assert editor.station.driver.station.airspace is in_force
    assert editor.areas() == ["boundary"]
    # What was refused is no change: the newest one to undo is still the boundary.
    assert editor.read()["undo"]["what"] == "boundary"
    monkeypatch.undo()
    assert editor.undo()["accepted"]
    assert editor.areas() == []


def test_a_larger_boundary_brings_the_ground_around_it(editor: Editor) -> None:
    add_elevation(editor.folder, 0.02)
    editor = Editor(editor.folder, FakeStation(load_site(editor.folder)))
    editor.save(BOUNDARY)
    before = editor.station.driver.station.airspace.airspace.elevation
    editor.save(area("boundary", ring(0.01)))
    after = editor.station.driver.station.airspace.airspace.elevation
    assert before is not None
    assert after is not None
    assert after.grid == load_site(editor.folder).airspace.elevation.grid  # type: ignore[union-attr]
    assert after.grid.west_m < before.grid.west_m


def test_one_file_is_imported_at_a_time(editor: Editor) -> None:
    folder = editor.station.drawing

    async def both() -> list[str | None]:
        asked = (
            folder.import_features("a.zip", b"PK\x03\x04", close_paths=False) for _ in range(2)
        )
        return [view.reason for view in await asyncio.gather(*asked)]

    first, second = asyncio.run(both())
    assert "zip archive" in (first or "")
    assert second == "Another file is being read; try again when it is done"


def test_a_full_disk_changes_nothing(editor: Editor, monkeypatch: pytest.MonkeyPatch) -> None:
    def fails(*_: object, **__: object) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(file_set, "replace_file", fails)
    answer = editor.save(BOUNDARY)
    assert "No space left" in answer["reason"]
    assert editor.areas() == []
    assert load_site(editor.folder).layers.files == {}


def test_an_import_is_only_shown(editor: Editor) -> None:
    shape = {"type": "Polygon", "coordinates": [ring(0.001)]}
    feature = {"type": "Feature", "properties": {"name": "west"}, "geometry": shape}
    data = json.dumps({"type": "FeatureCollection", "features": [feature]})
    path = "/api/site/import?name=west.geojson"
    answer = editor.client.post(path, content=data).json()
    (found,) = answer["features"]
    assert (found["name"], answer["excluded"], answer["reason"]) == ("west", [], None)
    assert np.allclose(found["geometry"]["coordinates"], [ring(0.001)], atol=1e-8)
    refused = editor.client.post("/api/site/import?name=a.zip", content=b"PK\x03\x04").json()
    assert "zip archive that can be read" in refused["reason"]
    assert editor.read()["features"] == []
