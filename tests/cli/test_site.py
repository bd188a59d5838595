"""`recon site`: a folder is made, checked and imported into."""

import json
from pathlib import Path

import pytest
from typer.testing import CliRunner

from recon.cli.commands import app
from recon.cli.demo import DemoOptions, demo_command, rehearsed
from recon.cli.site import site_app
from recon.model.airspace import SiteLayer
from recon.model.errors import ReconError, SiteError
from recon.model.event import SiteRedrawn
from recon.model.geo import GeoPoint
from recon.record.files import file_set
from recon.record.mcap.codec import Codec
from recon.site import load_site
from recon.site.drawing import MOST_STAGED_FILES, read_drawing, stage_drawing
from recon.site.new_site import NewSiteFields, make_site
from recon.site.reading import HISTORY_FOLDER, MAPS_FOLDER, site_digest
from recon.site.schema import RehearsalTable

PLACE = ("--at", "41.9012,-93.6034", "--ground-altitude-m", "275")


def recon_site(*words: str) -> str:
    return CliRunner().invoke(site_app, words, catch_exceptions=False, standalone_mode=False).output


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    recon_site("new", str(tmp_path / "west field"), *PLACE)
    return tmp_path / "west field"


def layer_file(path: Path, *names: str, kind: str = "Polygon") -> Path:
    ring = [[-93.604, 41.901], [-93.602, 41.901], [-93.602, 41.902], [-93.604, 41.901]]
    shape = {"type": kind, "coordinates": [ring] if kind == "Polygon" else ring[0]}
    features = [
        {"type": "Feature", "properties": {"name": name}, "geometry": shape} for name in names
    ]
    path.write_text(json.dumps({"type": "FeatureCollection", "features": features}))
    return path


def test_a_new_folder_is_a_site_with_drones_to_rehearse_with(folder: Path) -> None:
    site = load_site(folder)
    assert (site.name, list(site.profiles)) == (
        "west field",
        ["SIM-1", "SIM-2", "SIM-3", "SIM-IMAGER"],
    )
    text = recon_site("check", str(folder))
    assert "site west field: 4 vehicle profiles" in text
    assert "warning: no boundary" in text
    with pytest.raises(SiteError, match="exists already"):
        recon_site("new", str(folder), *PLACE)


@pytest.mark.parametrize(
    ("words", "expected"),
    [
        (("--at", "41.9", "--ground-altitude-m", "275"), "LAT,LON"),
        (("--at", "91,0", "--ground-altitude-m", "275"), "latitude of -90 to 90"),
        (("--at", "41,nan", "--ground-altitude-m", "275"), "longitude"),
        ((*PLACE, "--name", "a\nb"), "printable"),
    ],
)
def test_values_that_no_site_has_make_no_folder(
    tmp_path: Path, words: tuple[str, ...], expected: str
) -> None:
    with pytest.raises(SiteError, match=expected):
        recon_site("new", str(tmp_path / "field"), *words)
    assert not (tmp_path / "field").exists()


@pytest.mark.parametrize("height", ["304,8m", "1000 ft"])
def test_the_grounds_height_is_that_of_a_map(tmp_path: Path, height: str) -> None:
    words = ("--at", "41.9012,-93.6034", "--ground-above-sea-level", height)
    recon_site("new", str(tmp_path / "field"), *words)
    frame = load_site(tmp_path / "field").frame
    assert frame is not None
    assert frame.origin.ellipsoid_height_m == pytest.approx(304.8 - 30.1, abs=1.0)


@pytest.mark.parametrize(
    ("words", "sentence"),
    [
        ((), "expected one of --ground-above-sea-level and --ground-altitude-m"),
        (("--ground-above-sea-level", "300"), "expected a height like 278m or 912ft"),
    ],
)
def test_a_height_without_its_unit_is_refused(
    tmp_path: Path, words: tuple[str, ...], sentence: str
) -> None:
    with pytest.raises(SiteError, match=sentence):
        recon_site("new", str(tmp_path / "field"), "--at", "41.9,-93.6", *words)


def test_an_import_is_added_or_replaces(folder: Path, tmp_path: Path) -> None:
    first = layer_file(tmp_path / "a.geojson", "north", "south")
    second = layer_file(tmp_path / "b.geojson", "west")
    into = ("--as", "survey_regions")
    text = recon_site("import", str(folder), str(first), *into)
    assert text == "2 imported into survey_regions, 0 excluded\n"
    recon_site("import", str(folder), str(second), *into)
    assert list(load_site(folder).layers.survey_regions) == ["north", "south", "west"]
    recon_site("import", str(folder), str(second), *into, "--replace")
    assert [each.properties["name"] for each in read_drawing(folder)] == ["west"]
    change = file_set.last_change(folder)
    assert change is not None
    assert change.what == "import of b.geojson"


def drawn(path: Path, crs: str | None, **shapes: object) -> Path:
    features = [
        {"type": "Feature", "properties": {"name": name}, "geometry": shape}
        for name, shape in shapes.items()
    ]
    document: dict[str, object] = {"type": "FeatureCollection", "features": features}
    if crs is not None:
        document["crs"] = {"type": "name", "properties": {"name": crs}}
    path.write_text(json.dumps(document))
    return path


SQUARE = [[-93.6, 41.9], [-93.598, 41.9], [-93.598, 41.902], [-93.6, 41.902], [-93.6, 41.9]]
AREA = {"type": "Polygon", "coordinates": [SQUARE]}
CROSSED = {"type": "Polygon", "coordinates": [[SQUARE[0], *SQUARE[2:0:-1], *SQUARE[3:]]]}


def test_what_is_left_out_is_named_and_the_accuracy_stated(folder: Path, tmp_path: Path) -> None:
    file = drawn(tmp_path / "a.geojson", "urn:ogc:def:crs:EPSG::4269", good=AREA, eight=CROSSED)
    text = recon_site("import", str(folder), str(file), "--as", "survey_regions")
    assert "warning: NAD83: the transformation to WGS84 is accurate to 4 m" in text
    assert "warning: excluded: eight: its edges cross or overlap at longitude" in text
    assert "1 imported into survey_regions, 1 excluded" in text
    assert list(load_site(folder).layers.survey_regions) == ["good"]


def test_a_shape_of_another_kind_is_named(folder: Path, tmp_path: Path) -> None:
    well = {"type": "Point", "coordinates": SQUARE[0]}
    file = drawn(tmp_path / "a.geojson", None, good=AREA, well=well)
    text = recon_site("import", str(folder), str(file), "--as", "keep_out")
    assert "warning: excluded: well: a point, where keep_out takes polygons" in text
    assert "1 imported into keep_out, 1 excluded" in text


def test_a_plan_reads_the_same_file_alike(tmp_path: Path) -> None:
    file = drawn(tmp_path / "a.geojson", "urn:ogc:def:crs:EPSG::4269", good=AREA, eight=CROSSED)
    planned = CliRunner().invoke(app, ("plan", str(file), "--height", "60"))
    assert planned.exit_code == 0, planned.stderr
    assert "area  3.69 ha" in planned.stdout
    assert "warning: excluded: eight:" in planned.stderr


def test_some_of_many_are_chosen_by_name(folder: Path, tmp_path: Path) -> None:
    file = drawn(tmp_path / "farm.geojson", None, **{f"field {n}": AREA for n in range(300)})
    words = ("import", str(folder), str(file), "--as", "survey_regions")
    text = recon_site(*words, "--feature", "FIELD 7", "--feature", "field 299")
    assert list(load_site(folder).layers.survey_regions) == ["field 7", "field 299"]
    assert "2 imported into survey_regions, 0 excluded, 298 not chosen" in text
    with pytest.raises(SiteError, match="did you mean 'field 2"):
        recon_site(*words, "--feature", "feild 299")


def test_a_path_becomes_an_area_when_asked(folder: Path, tmp_path: Path) -> None:
    file = drawn(
        tmp_path / "a.geojson", None, way={"type": "LineString", "coordinates": SQUARE[:4]}
    )
    words = ("import", str(folder), str(file), "--as", "boundary")
    with pytest.raises(SiteError, match="way: a path of 4 points, not an area: close paths"):
        recon_site(*words)
    recon_site(*words, "--close-paths")
    assert load_site(folder).layers.boundary is not None


def test_a_place_that_nobody_knows_becomes_no_fence(folder: Path, tmp_path: Path) -> None:
    file = drawn(tmp_path / "a.geojson", "+proj=longlat +ellps=clrk66 +no_defs", old=AREA)
    with pytest.raises(SiteError, match="expected coordinates whose place on the globe is known"):
        recon_site("import", str(folder), str(file), "--as", "keep_out")
    recon_site("import", str(folder), str(file), "--as", "survey_regions")


@pytest.fixture
def interrupted(folder: Path, tmp_path: Path) -> Path:
    """A site with the region north, and a crash while the region south was added to it."""
    for name in ("north", "south"):
        file = layer_file(tmp_path / f"{name}.geojson", name)
        recon_site("import", str(folder), str(file), "--as", "survey_regions")
    history = folder / HISTORY_FOLDER
    (history / "0002").rename(history / "0002.unfinished")
    return folder


UNDONE = "a change of the site that was interrupted is undone"


def test_an_import_begins_from_a_repaired_folder(interrupted: Path, tmp_path: Path) -> None:
    third = layer_file(tmp_path / "c.geojson", "west")
    text = recon_site("import", str(interrupted), str(third), "--as", "survey_regions")
    assert UNDONE in text
    assert [each.properties["name"] for each in read_drawing(interrupted)] == ["north", "west"]


def test_a_plan_uses_a_repaired_folder(interrupted: Path) -> None:
    words = ("plan", "south", "--site", str(interrupted), "--height", "60")
    planned = CliRunner().invoke(app, words)
    assert planned.exit_code == 2
    assert UNDONE in planned.stderr
    assert "Survey region 'south' not found, nor a file; available: north" in planned.stderr


def test_a_folder_that_cannot_be_repaired_is_a_sentence(interrupted: Path) -> None:
    (interrupted / HISTORY_FOLDER / "0002.unfinished" / "manifest.json").write_text("{")
    with pytest.raises(ReconError, match=r"0002\.unfinished"):
        recon_site("check", str(interrupted))


def test_pads_stand_on_the_sites_ground(folder: Path, tmp_path: Path) -> None:
    pads = layer_file(tmp_path / "p.geojson", "home", kind="Point")
    recon_site("import", str(folder), str(pads), "--as", "landing_pads")
    (pad,) = load_site(folder).layers.landing_pads
    assert (pad.name, pad.place.ellipsoid_height_m) == ("home", 275.0)
    expected = "expected polygons for boundary, got none: home: a point, where boundary takes"
    with pytest.raises(SiteError, match=expected):
        recon_site("import", str(folder), str(pads), "--as", "boundary")


def test_earlier_versions_are_no_part_of_what_a_flight_used(folder: Path, tmp_path: Path) -> None:
    assert file_set.HISTORY_FOLDER == HISTORY_FOLDER
    first = layer_file(tmp_path / "a.geojson", "north")
    recon_site("import", str(folder), str(first), "--as", "survey_regions")
    digest = site_digest(folder)
    (folder / HISTORY_FOLDER / "0001" / "manifest.json").unlink()
    assert site_digest(folder) == digest


def test_an_older_site_gets_an_imaging_drone(
    tmp_path: Path, capfd: pytest.CaptureFixture[str]
) -> None:
    folder = tmp_path / "old"
    make_site(
        folder, GeoPoint(41.9, -93.6, 245.0), NewSiteFields(name="old", drones=2, has_imager=False)
    )
    assert "--no-imager" in simulator_words(folder)
    told = capfd.readouterr().out
    assert "no ground image, sun or forecast" in told
    assert told.endswith(f"recon site imager {folder}\n")
    before = (folder / "site.toml").read_text()
    recon_site("imager", str(folder))
    assert list(load_site(folder).imagers) == ["SIM-IMAGER"]
    assert (folder / "site.toml").read_text().startswith(before.rstrip())
    words = simulator_words(folder)
    assert "--imager" in words
    assert words[words.index("--vehicles") + 1] == "3"
    assert "no imaging drone" not in capfd.readouterr().out
    with pytest.raises(SiteError, match="has an imaging drone already: SIM-IMAGER"):
        recon_site("imager", str(folder))


def test_a_rehearsals_sky_is_the_sites_unless_the_command_names_another(tmp_path: Path) -> None:
    folder = tmp_path / "new"
    sky = RehearsalTable(cloud_cover_percent=65.0, wind_mps=6.0, wind_from_deg=10.0)
    fields = NewSiteFields(name="new", drones=1, regions={}, rehearsal=sky)
    make_site(folder, GeoPoint(41.9, -93.6, 245.0), fields)
    words = simulator_words(folder)
    assert [words[words.index(key) + 1] for key in ("--cover", "--wind-mps", "--wind-to-deg")] == [
        "65",
        "6",
        "190",
    ]
    assert "--grounded" not in words
    words = simulator_words(folder, cover=20.0)
    assert words[words.index("--cover") + 1] == "20"


def test_without_a_field_all_wait_on_the_ground_so_that_it_can_be_drawn(folder: Path) -> None:
    assert "--grounded" in simulator_words(folder)


def simulator_words(folder: Path, cover: float | None = None) -> tuple[str, ...]:
    """What `recon demo --site` starts the simulator with."""
    asked = DemoOptions(site=folder, http_port=0, link_port=0, no_record=True, cover=cover)
    return rehearsed(folder, asked).simulator_words


def test_a_rehearsal_needs_simulated_drones(tmp_path: Path) -> None:
    folder = tmp_path / "real"
    recon_site("new", str(folder), *PLACE, "--drones", "0")
    with pytest.raises(SiteError, match="a serial that begins with SIM-"):
        demo_command(site=folder)


def test_a_record_keeps_a_drawing(folder: Path, tmp_path: Path) -> None:
    """Replayed, the event brings the same fence into force."""
    area = layer_file(tmp_path / "b.geojson", "field")
    recon_site("import", str(folder), str(area), "--as", "boundary")
    site = load_site(folder)
    airspace = site.airspace
    profiles = site.profiles
    drawn = (airspace.boundary, airspace.zones, airspace.landing_pads, profiles)
    event = SiteRedrawn(*drawn, (SiteLayer.BOUNDARY,), "anna")
    codec = Codec()
    again: SiteRedrawn = codec.decode(codec.encode(event, SiteRedrawn), SiteRedrawn)
    assert again.boundary is not None
    assert airspace.boundary is not None
    assert again.boundary.outline_m.tolist() == airspace.boundary.outline_m.tolist()
    assert (again.profiles, again.layers, again.by) == (profiles, (SiteLayer.BOUNDARY,), "anna")


def test_base_maps_are_no_part_of_what_a_site_is_known_by(folder: Path) -> None:
    digest = site_digest(folder)
    (folder / MAPS_FOLDER).mkdir()
    for number in range(MOST_STAGED_FILES + 1):
        (folder / MAPS_FOLDER / f"{number}.mbtiles").write_bytes(b"x")
    assert site_digest(folder) == digest
    # A map is not copied with a drawing, however many there are.
    assert stage_drawing(folder, read_drawing(folder)).changed == ()
