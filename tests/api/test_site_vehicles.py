"""A site's vehicles edited as a table: checked, saved with undo, in force at once."""

import asyncio
import tomllib
from pathlib import Path
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st
from tests.api.fake_station import FakeStation
from tests.api.site_editor import SiteEditor
from tests.link.approved import core, extended

from recon import wire
from recon.api.schema import SiteVehiclesRequest
from recon.model.event import LinkOpened, PacketReceived
from recon.model.geo import GeoPoint
from recon.model.person import Person, Role
from recon.model.vehicle import AltitudeReference
from recon.site import load_site
from recon.site.new_site import NewSiteFields, make_site
from recon.site.vehicle_rows import VehicleRow, VehicleRowError, read_vehicle_rows, stage_vehicles
from recon.vehicles.reports import to_report

PLACE = GeoPoint(41.9012, -93.6034, 275.0)
COMMENTED = """
# Anna's drone.
[[vehicles]]  # the first
serial = "A-1"  # on the box
name = "Alder"
endurance_min = 24  # measured

# Ben's drone.
[[vehicles]]
serial = "B-2"
pad.latitude_deg = 41.9012
pad.longitude_deg = -93.6034
pad.altitude_m = 275.0
waypoint_altitude = "takeoff"
"""


class Editor(SiteEditor):
    """A person who edits the table."""

    PART, ITEMS = "vehicles", "vehicles"

    def numbers(self) -> dict[str, int]:
        return {row["serial"]: row["number"] for row in self.read()["vehicles"]}


@pytest.fixture
def editor(tmp_path: Path) -> Editor:
    folder = tmp_path / "field"
    make_site(folder, PLACE, NewSiteFields(name="field", drones=2, has_imager=False))
    return Editor(folder, FakeStation(load_site(folder)))


def commented(tmp_path: Path) -> Path:
    folder = tmp_path / "commented"
    make_site(folder, PLACE, NewSiteFields(name="field", drones=0, has_imager=False))
    with (folder / "site.toml").open("a") as file:
        file.write(COMMENTED)
    return folder


def test_edited_vehicles_are_in_force_at_once_and_after_a_start(editor: Editor) -> None:
    one, two = editor.read()["vehicles"]
    assert (one["serial"], one["number"], one["waypoint_altitude"]) == ("SIM-1", 1, "takeoff")
    edited = {
        **one,
        "name": "Alder",
        "number": 7,
        "camera": "mini3pro",
        "waypoint_altitude": "wgs84",
    }
    answer = editor.save(edited, two, {"serial": "NEW-3", "name": "Never connected"})
    assert (answer["accepted"], answer["reason"]) == (True, None)
    assert answer["changes"] == [
        "SIM-1 name Drone 1 -> Alder, number unset -> 7, camera unset -> mini3pro, altitude "
        "reference takeoff -> wgs84",
        "NEW-3 added",
    ]
    in_force = editor.station.driver.station.fleet.profiles
    started = load_site(editor.folder).profiles
    assert in_force == started
    assert started["SIM-1"].waypoint_altitude is AltitudeReference.WGS84
    assert (started["SIM-1"].camera, started["SIM-1"].endurance_s) == ("mini3pro", 1500.0)
    assert editor.numbers() == {"SIM-1": 7, "SIM-2": 2, "NEW-3": 1}
    # A number that the station gave is not fixed by a save.
    assert started["SIM-2"].number is None


def test_undo_takes_back_one_change_after_the_other_also_of_the_layers_editor(
    editor: Editor,
) -> None:
    one, two = editor.read()["vehicles"]
    editor.save(one)
    editor.save({**one, "number": 9})
    assert editor.read()["undo"]["what"] == "vehicles"
    assert editor.client.get("/api/site/drawing").json()["undo"]["what"] == "vehicles"
    answer = editor.undo()
    assert (answer["accepted"], answer["layers"], answer["also"]) == (True, [], ["vehicles"])
    assert editor.numbers() == {"SIM-1": 1}
    editor.undo()
    assert editor.read()["vehicles"] == [one, two]
    assert set(editor.station.driver.station.fleet.profiles) == {"SIM-1", "SIM-2"}
    assert editor.undo()["reason"] == "No change of the site to undo"


@pytest.mark.parametrize(
    ("change", "expected"),
    [
        ({"number": 0}, "Number: expected a whole number of 1 to 9999, got 0"),
        ({"number": 2}, "Number: 2 is the number of Drone 2 too"),
        ({"name": "Drone 2"}, "Name: expected a name that no other vehicle has as its name"),
        ({"name": ""}, "Name: expected a text of 1 to 64 characters"),
        ({"name": "a\x7fb"}, "Name: expected a text of 1 to 64 characters without control"),
        ({"camera": "mini3"}, "Camera: expected a survey camera. Camera 'mini3' not found;"),
        ({"serial": "with space"}, "Serial: expected a text of 1 to 256 printable ASCII"),
        ({"serial": "00000"}, "Serial: expected an aircraft's own serial, got the placeholder"),
        ({"serial": "SIM-2"}, "Serial SIM-2 is in the table twice"),
    ],
)
@pytest.mark.parametrize("end", ["", "/check"])
def test_a_wrong_value_gives_one_sentence_about_its_row_and_changes_nothing(
    editor: Editor, change: dict[str, Any], expected: str, end: str
) -> None:
    before = (editor.folder / "site.toml").read_bytes()
    one, two = editor.read()["vehicles"]
    answer = editor.save(two, {**one, **change}, end=end)
    assert not answer["accepted"]
    assert answer["reason"].startswith(expected)
    assert "\n" not in answer["reason"]
    # SIM-2 comes second in the file also when it is first in the table.
    assert answer["row"] in (0, 1)
    assert (editor.folder / "site.toml").read_bytes() == before
    assert editor.read()["vehicles"] == [one, two]


def test_two_vehicles_swap_their_numbers(editor: Editor) -> None:
    one, two = editor.read()["vehicles"]
    assert editor.save({**one, "number": 2}, {**two, "number": 1})["accepted"]
    assert editor.numbers() == {"SIM-1": 2, "SIM-2": 1}


def test_a_number_of_a_connected_vehicle_outside_the_table_stays_its_own(editor: Editor) -> None:
    driver = editor.station.driver
    driver.handle(LinkOpened(1, "10.0.0.1:5"))
    for packet in (extended(b"UNLISTED"), core()):
        driver.handle(PacketReceived(1, to_report(wire.decode(packet))))
    (known,) = editor.client.get("/api/state").json()["vehicles"]
    assert (known["serial"], known["number"]) == ("UNLISTED", 3)
    one, two = editor.read()["vehicles"]
    answer = editor.save(one, {**two, "number": 3})
    assert answer["reason"] == (
        "Number: 3 belongs to UNLISTED, which has connected and is not in the table; add it, or "
        "choose another number"
    )
    assert answer["row"] == 1


def test_a_check_saves_nothing(editor: Editor) -> None:
    one, two = editor.read()["vehicles"]
    answer = editor.save({**one, "name": "Alder"}, two, end="/check")
    assert (answer["accepted"], answer["changes"]) == (True, ["SIM-1 name Drone 1 -> Alder"])
    assert editor.read()["vehicles"] == [one, two]


def test_one_of_two_screens_saves_first(editor: Editor) -> None:
    table = editor.read()
    one, two = table["vehicles"]
    assert editor.save(one, revision=table["revision"])["accepted"]
    assert "changed meanwhile" in editor.save(two, revision=table["revision"])["reason"]


def test_the_table_is_an_administrators(editor: Editor) -> None:
    table = editor.read()
    rows = [{**table["vehicles"][0], "name": "Alder"}]
    body = {"revision": table["revision"], "vehicles": rows}
    asked = SiteVehiclesRequest.model_validate(body)
    anna = Person("anna", Role.OPERATOR)
    vehicles = editor.station.site_vehicles
    answer = asyncio.run(vehicles.save(asked, anna, is_check=False))
    assert answer.reason == (
        "anna has the role operator; boundary, zones, pads and vehicles need admin"
    )


def test_comments_and_other_keys_stay_with_their_vehicle(tmp_path: Path) -> None:
    folder = commented(tmp_path)
    before = (folder / "site.toml").read_text()
    one, two = read_vehicle_rows(folder)
    assert (one, two) == (
        VehicleRow("A-1", "Alder"),
        VehicleRow("B-2", waypoint_altitude="takeoff"),
    )
    assert stage_vehicles(folder, (one, two)).files == {}
    edited = VehicleRow("A-1", 'The "old" Älder', 4, None, "wgs84")
    text = _text(folder, edited, two)
    added = 'number = 4\nwaypoint_altitude = "wgs84"\n'
    assert text == before.replace('"Alder"', '"The \\"old\\" Älder"').replace(
        "24  # measured\n", f"24  # measured\n{added}"
    )
    # Without Anna's drone the comment about Ben's stays.
    text = _text(folder, two)
    assert "# Ben's drone.\n[[vehicles]]" in text
    assert "A-1" not in text


def test_vehicles_in_another_form_are_refused_not_damaged(tmp_path: Path) -> None:
    folder = tmp_path / "inline"
    make_site(folder, PLACE, NewSiteFields(name="field", drones=0, has_imager=False))
    text = (folder / "site.toml").read_text()
    (folder / "site.toml").write_text('vehicles = [{ serial = "A-1" }]\n' + text)
    with pytest.raises(Exception, match=r"\[\[vehicles\]\] section with one key a line"):
        stage_vehicles(folder, [VehicleRow("A-1", "Alder")])


NAMES = st.text(max_size=70)
ROWS = st.lists(
    st.builds(
        VehicleRow,
        serial=st.sampled_from(["A-1", "B-2", "C]=\"'#"]),
        name=st.none() | NAMES,
        number=st.none() | st.integers(0, 10),
        waypoint_altitude=st.sampled_from([None, "wgs84", "takeoff"]),
    ),
    max_size=4,
)


@pytest.fixture(scope="module")
def hostile_folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return commented(tmp_path_factory.mktemp("hostile"))


@given(ROWS)
def test_what_is_saved_is_what_was_asked_or_one_row_is_named(
    hostile_folder: Path, rows: list[VehicleRow]
) -> None:
    try:
        staged = stage_vehicles(hostile_folder, rows)
    except VehicleRowError as problem:
        found = problem.index
        assert 0 <= found < len(rows)
        return
    text = staged.files.get("site.toml") or (hostile_folder / "site.toml").read_bytes()
    tables = {table["serial"]: table for table in tomllib.loads(text.decode()).get("vehicles", [])}
    for row in rows:
        values = (row.name, row.number, row.waypoint_altitude)
        keys = ("name", "number", "waypoint_altitude")
        assert tuple(tables[row.serial].get(key) for key in keys) == values
    assert len(tables) == len(rows)
    assert set(staged.site.profiles) == set(tables)


def _text(folder: Path, *rows: VehicleRow) -> str:
    content = stage_vehicles(folder, rows).files["site.toml"]
    assert content is not None
    return content.decode()
