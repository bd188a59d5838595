"""`recon plan`: no station is needed; figures, picture and GeoJSON of a region."""

import contextlib
import json
from dataclasses import replace
from math import atan, cos, degrees, radians
from pathlib import Path
from shutil import copytree
from typing import Any

import cv2
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from shapely.geometry import shape  # type: ignore[import-untyped, unused-ignore]
from tests.guidance.survey.fields import FLOWN_S, flown
from tests.site.terrain import geotiff, load, plane
from typer.testing import CliRunner

from recon.cli.commands import app
from recon.cli.plan import PlanError, _exposure_s, _gsd_m, least_enduring
from recon.cli.plan_picture import INK, Theme, picture_png
from recon.guidance.survey import Surveyor, SurveyPlan, SurveySurroundings, plan_survey
from recon.guidance.survey.estimate import Batteries, SurveyEstimate, estimate
from recon.model.airspace import Region
from recon.model.arrays import FloatArray
from recon.model.geo import GeoPoint, LocalFrame
from recon.model.survey import Survey
from recon.model.survey_camera import camera_named
from recon.model.units import Stamped
from recon.model.vehicle import VehicleProfile, VehicleState
from recon.record.files.flown_region_file import day_of, write_region
from recon.safety import PreparedAirspace
from recon.safety.settings import EnergySettings
from recon.site import Site, demo_site_folder, load_site
from recon.site.reading import FLOWN_FOLDER
from recon.station.operations.survey.availability import time_left_s

LATITUDE, LONGITUDE = 41.9, -93.6
M_PER_LATITUDE = 111_070.0
M_PER_LONGITUDE = 111_320.0 * cos(radians(LATITUDE))


def recon(*words: object) -> tuple[int, str]:
    result = CliRunner().invoke(app, ["plan", *(str(word) for word in words)])
    assert result.exception is None or isinstance(result.exception, SystemExit), result.exception
    return result.exit_code, result.output


def written(folder: Path, *corners_m: tuple[float, float]) -> Path:
    ring = [
        [LONGITUDE + east / M_PER_LONGITUDE, LATITUDE + north / M_PER_LATITUDE]
        for east, north in (*corners_m, corners_m[0])
    ]
    geometry = {"type": "Polygon", "coordinates": [ring]}
    feature = {"type": "Feature", "properties": {"name": "north 40"}, "geometry": geometry}
    path = folder / "region.geojson"
    path.write_text(json.dumps({"type": "FeatureCollection", "features": [feature]}))
    return path


@pytest.fixture
def field(tmp_path: Path) -> Path:
    return written(tmp_path, (0, 0), (400, 0), (400, 300), (0, 300))


def figures(*words: object) -> dict[str, Any]:
    code, out = recon(*words, "--json")
    assert code in (0, 1), out
    read: dict[str, Any] = json.loads(out)
    return read


def test_a_field_is_planned_by_pixel_size(field: Path) -> None:
    code, out = recon(field, "--camera", "mavic3m", "--gsd", "2cm")
    assert code == 0
    assert "area  12.0" in out
    assert "height  75 m above takeoff" in out
    assert "speed limit  10.00 m/s: blur of 0.5 pixel at an exposure of 1/1000 s" in out
    assert "batteries  1, full, of 25 min hovering each" in out
    found = figures(field, "--camera", "mavic3m", "--gsd", "2cm")
    assert found["gsd_m"] == pytest.approx(0.02, rel=0.001)
    assert found["region_m2"] == pytest.approx(120_000.0, rel=0.005)
    assert found["front_overlap"] >= 0.7
    assert found["side_overlap"] >= 0.6
    assert found["warnings"] == []


NEAR_THE_SLOPE = ((-280, 100), (-130, 100), (-130, 200), (-280, 200))
"""150 x 100 m at the origin of the site with the slope."""


@pytest.fixture
def sloping(tmp_path: Path) -> Path:
    """A site whose ground rises by 2 % eastwards and falls by 3 % northwards."""
    folder = tmp_path / "sloping"
    folder.mkdir()
    load(folder, geotiff(plane))
    return folder


def test_above_ground_follows_the_sites_elevation_model(tmp_path: Path, sloping: Path) -> None:
    field = written(tmp_path, *NEAR_THE_SLOPE)
    code, out = recon(field, "--site", sloping, "--height", 40, "--above-ground")
    assert code == 0, out
    assert "height  40 m above ground" in out
    assert "height above ground  40 m over the region" in out
    found = figures(field, "--site", sloping, "--height", 40, "--above-ground")
    assert (found["height_above_takeoff_m"], found["height_above_ground_m"]) == (None, 40.0)


def test_heights_above_ground_are_exported_above_takeoff_or_refused(
    tmp_path: Path, sloping: Path
) -> None:
    field = written(tmp_path, *NEAR_THE_SLOPE)
    words = (field, "--site", sloping, "--height", 40, "--above-ground", "--export")
    code, out = recon(*words, tmp_path / "slope.waypoints")
    assert code == 0, out
    lines = (tmp_path / "slope.waypoints").read_text().splitlines()[2:]
    items = [line.split("\t") for line in lines]
    heights_m = {float(item[10]) for item in items if item[3] == "16"}
    assert len(heights_m) > 1
    # The takeoff point is at the south-west corner, and rows keep 40 m above this slope.
    assert all(abs(height_m - 40.0) < 8.0 for height_m in heights_m)
    code, out = recon(*words, tmp_path / "slope.kml")
    assert code == 2
    assert ".kml cannot hold heights that follow the ground" in out


def test_above_takeoff_it_states_the_range_above_ground(tmp_path: Path, sloping: Path) -> None:
    """Without pads the takeoff is at the south-west corner."""
    field = written(tmp_path, *NEAR_THE_SLOPE)
    _, out = recon(field, "--site", sloping, "--height", 40)
    assert "height  40 m above takeoff" in out
    assert "height above ground  37 to 43 m over the region" in out


def test_above_ground_without_an_elevation_model_is_one_sentence(field: Path) -> None:
    code, out = recon(field, "--height", 40, "--above-ground")
    assert code == 2
    assert "--above-ground needs the ground's heights" in out
    assert "height above ground" not in recon(field, "--height", 40)[1]


def test_more_drones_take_less_time_and_as_many_photos_but_for_cut_rows(field: Path) -> None:
    one, three = (figures(field, "--height", 60, "--drones", count) for count in (1, 3))
    assert len(three["drones"]) == three["batteries"] == 3
    assert three["time_s"] < 0.6 * one["time_s"]
    assert one["photos"] <= three["photos"] <= one["photos"] + 4


def test_drones_for_which_no_rows_are_left_are_named(tmp_path: Path) -> None:
    small = written(tmp_path, (0, 0), (100, 0), (100, 60), (0, 60))
    found = figures(small, "--height", 60, "--drones", 16)
    assert found["drones_without_rows"] == 16 - len(found["drones"]) > 0
    idle, out = found["drones_without_rows"], recon(small, "--height", 60, "--drones", 16)[1]
    assert f"not needed  {idle} drones: no rows are left" in out
    assert "not needed" not in recon(small, "--height", 60)[1]


KML = """<?xml version="1.0" encoding="UTF-8"?>
<kml xmlns="http://www.opengis.net/kml/2.2"><Document>
<Placemark><name>gate</name><Point><coordinates>-93.6,41.9</coordinates></Point></Placemark>
<Placemark><name>north 40</name><Polygon><outerBoundaryIs><LinearRing><coordinates>
{corners}
</coordinates></LinearRing></outerBoundaryIs></Polygon></Placemark>
</Document></kml>
"""


def test_a_field_from_kml_or_with_a_mark_of_utf_8_is_the_same_plan(field: Path) -> None:
    ring = json.loads(field.read_text())["features"][0]["geometry"]["coordinates"][0]
    kml, marked = field.with_name("field.kml"), field.with_name("marked.geojson")
    corners = " ".join(f"{east},{north},0" for east, north in ring)
    kml.write_text(KML.format(corners=corners))
    marked.write_bytes(b"\xef\xbb\xbf" + field.read_bytes())
    plans = [figures(path, "--height", 60) for path in (field, kml, marked)]
    assert plans[0]["title"] == "north 40"
    assert plans[0]["rows"] > 5
    for other in plans[1:]:
        assert (other["title"], other["rows"], other["photos"]) == (
            plans[0]["title"],
            plans[0]["rows"],
            plans[0]["photos"],
        )
        assert other["time_s"] == pytest.approx(plans[0]["time_s"])


@pytest.mark.parametrize(
    ("data", "words"),
    [
        (b"", "got another kind of file"),
        (b"PK\x03\x04", "field.kml: "),
        (
            b'<kml xmlns="http://www.opengis.net/kml/2.2"><Placemark><Point><coordinates>-93.6,41.9'
            b"</coordinates></Point></Placemark></kml>",
            "expected a polygon, got points alone",
        ),
        (
            b'{"type": "Polygon", "coordinates": [[[41.9, -93.6], [41.9, -93.5], [42.0, -93.5],'
            b" [41.9, -93.6]]]}",
            "latitude and longitude look swapped: the longitude is first",
        ),
    ],
)
def test_a_file_without_a_field_is_a_sentence(tmp_path: Path, data: bytes, words: str) -> None:
    (tmp_path / "field.kml").write_bytes(data)
    code, out = recon(tmp_path / "field.kml", "--height", 60)
    assert (code, len(out.splitlines())) == (2, 1), out
    assert words in out


def test_geojson_has_the_rows_of_each_drone_in_their_order(field: Path, tmp_path: Path) -> None:
    out, png = tmp_path / "out.geojson", tmp_path / "out.png"
    found = figures(field, "--height", 60, "--drones", 2, "--geojson", out, "--png", png)
    features = json.loads(out.read_text())["features"]
    kinds = [feature["properties"]["kind"] for feature in features]
    assert kinds.count("region") == kinds.count("photos") == 1
    rows = [f for f in features if f["properties"]["kind"] == "row"]
    assert len(rows) >= found["rows"]
    for name in ("drone 1", "drone 2"):
        orders = [r["properties"]["order"] for r in rows if r["properties"]["drone"] == name]
        assert orders == list(range(1, len(orders) + 1))
        assert orders
    long_m = 0.0
    for row in rows:
        (west, south), (east, north) = row["geometry"]["coordinates"]
        east_m, north_m = (east - west) * M_PER_LONGITUDE, (north - south) * M_PER_LATITUDE
        long_m += (east_m**2 + north_m**2) ** 0.5
    assert long_m == pytest.approx(found["rows_m"], rel=0.005)
    (region,), (photos,) = (
        [shape(f["geometry"]) for f in features if f["properties"]["kind"] == kind]
        for kind in ("region", "photos")
    )
    assert region.area > 0.0
    assert photos.covers(region)
    assert photos.area < 3.0 * region.area
    assert cv2.imread(str(png)).shape[2] == 3


@pytest.mark.parametrize("turn", [1, -1])
def test_rings_are_oriented_as_geojson_asks(tmp_path: Path, turn: int) -> None:
    corners_m = [(0, 0), (400, 0), (400, 300), (0, 300)][::turn]
    out = tmp_path / "out.geojson"
    figures(written(tmp_path, *corners_m), "--height", 60, "--geojson", out)
    shapes = [shape(f["geometry"]) for f in json.loads(out.read_text())["features"]]
    areas = [each for each in shapes if each.geom_type == "Polygon"]
    assert len(areas) == 2
    assert all(each.exterior.is_ccw for each in areas)


@pytest.mark.parametrize("theme", ["light", "dark"])
def test_the_picture_stands_out_on_its_ground(field: Path, tmp_path: Path, theme: str) -> None:
    png = tmp_path / "out.png"
    assert recon(field, "--height", 60, "--png", png, "--theme", theme)[0] == 0
    shown = cv2.imread(str(png)).astype(int).sum(axis=2)
    assert (shown[0, 0] > 380) == (theme == "light")
    assert (abs(shown - shown[0, 0]) > 150).sum() > 2_000


def test_a_name_is_drawn_in_letters_of_its_own(field: Path, tmp_path: Path) -> None:
    heads = []
    for name in ("北の畑", "???"):
        text = json.dumps(json.loads(field.read_text())).replace("north 40", name)
        (tmp_path / "named.geojson").write_text(text, encoding="utf-8")
        png = tmp_path / "named.png"
        assert recon(tmp_path / "named.geojson", "--height", 60, "--png", png)[0] == 0
        heads.append(cv2.imread(str(png))[:48])
    assert heads[0].min() < 60
    assert (heads[0] != heads[1]).any()


def test_the_picture_shows_keep_out_zones_boundary_and_takeoff(tmp_path: Path) -> None:
    region = Region(np.array([(0.0, 0.0), (400.0, 0.0), (400.0, 300.0), (0.0, 300.0)]))
    survey = Survey(1, "field", region, 60.0, 5.0)
    plan = plan_survey(survey, LocalFrame(GeoPoint(LATITUDE, LONGITUDE, 0.0)))
    assert isinstance(plan, SurveyPlan)
    fleet = [Surveyor(f"drone {number}", (0.0, -100.0)) for number in range(1, 14)]
    needs = estimate(plan, fleet, Batteries(1200.0))
    assert isinstance(needs, SurveyEstimate)
    zone = Region(np.array([(50.0, -60.0), (150.0, -60.0), (150.0, -20.0), (50.0, -20.0)]))
    around = SurveySurroundings(None, (zone,), 5.0)

    def drawn(site: SurveySurroundings | None, theme: Theme) -> FloatArray:
        png = picture_png(plan, needs, fleet, site, "field", theme)
        return cv2.imdecode(np.frombuffer(png, np.uint8), cv2.IMREAD_COLOR).astype(float)

    for theme in Theme:
        plain, shown = drawn(None, theme), drawn(around, theme)
        differs = np.abs(plain - shown).sum(axis=2) > 30.0
        rows, columns = np.nonzero(differs[:-300])
        scale = (1000.0 - 2.0 * 48.0) / 400.0
        assert columns.min() == pytest.approx(48 + 50 * scale, abs=2)
        assert columns.max() == pytest.approx(48 + 150 * scale, abs=2)
        assert rows.max() - rows.min() == pytest.approx(40 * scale, abs=3)
        takeoff = (48 + 48 + round(400 * scale), 48)
        assert shown[takeoff].tolist() == list(INK[theme][::-1])


@pytest.mark.parametrize(
    ("corners_m", "code", "words"),
    [
        ([(0, 0), (100, 100), (100, 0), (0, 100)], 2, "edges"),
        ([(0, 0), (100, 0), (50, 0)], 2, "edges"),
        ([(0, 0), (2, 0), (2, 2)], 1, "less than a cell"),
    ],
)
def test_an_invalid_region_is_a_sentence(
    tmp_path: Path, corners_m: list[tuple[float, float]], code: int, words: str
) -> None:
    got, out = recon(written(tmp_path, *corners_m), "--height", 60)
    assert got == code
    assert words in out
    assert len(out.splitlines()) == 1


def test_a_region_outside_the_sites_boundary_is_a_sentence(tmp_path: Path) -> None:
    far = written(tmp_path, (3000, 0), (3200, 0), (3200, 200))
    code, out = recon(far, "--height", 40, "--site", demo_site_folder())
    assert code == 1
    assert "refused: the region north 40 lies outside the site's boundary" in out


def test_a_region_of_the_site_is_planned_on_the_rows_of_last_time(tmp_path: Path) -> None:
    site = tmp_path / "site"
    copytree(demo_site_folder(), site)
    home, options = load_site(site), ("west field", "--height", 60, "--site", site)
    assert "rows' origin" not in recon(*options)[1]
    model = camera_named("mavic3m", home.cameras.values())
    region = home.layers.survey_regions["west field"]
    survey = Survey(1, "west field", region, 60.0, 5.0, model.at_interval(2.0), 0.7, 0.6, 77.0)
    assert home.frame is not None
    plan = plan_survey(replace(survey, region_name="west field"), home.frame)
    assert isinstance(plan, SurveyPlan)
    write_region(site / FLOWN_FOLDER, flown(plan))
    code, out = recon(*options, "--json")
    assert code == 0, out
    assert json.loads(out)["rows_note"] == f"Same rows as on {day_of(FLOWN_S)}"
    assert "rows ran at 77.0° and 10.0° is asked for" in recon(*options, "--bearing", 10)[1]
    assert "New rows: asked for" in recon(*options, "--rows", "new")[1]


def test_a_region_that_batteries_do_not_last_for_is_a_sentence(field: Path) -> None:
    code, out = recon(field, "--height", 60, "--endurance-min", 11, "--batteries", 1)
    assert code == 1
    assert "full batteries are needed, 1 are there" in out
    code, out = recon(field, "--height", 60, "--endurance-min", 2)
    assert code == 1
    assert "refused: a full battery gives " in out


ENDURANCES_S = st.sampled_from([None, 900.0, 1_500.0])
GO_HOME_M = st.sampled_from([None, 30.0, 80.0])


@given(st.lists(st.tuples(ENDURANCES_S, GO_HOME_M), max_size=3), st.floats(10.0, 120.0))
def test_a_battery_lasts_as_long_as_the_station_counts_for_the_least_enduring_drone(
    drones: list[tuple[float | None, float | None]], height_m: float
) -> None:
    profiles = {
        f"SIM-{number}": VehicleProfile(
            f"SIM-{number}", endurance_s=endurance_s, go_home_height_m=go_home_m
        )
        for number, (endurance_s, go_home_m) in enumerate(drones)
    }
    site = Site("test", profiles=profiles)
    planned = least_enduring(site, None, height_m)
    assert planned.endurance_s <= 1_500.0
    settings, air = EnergySettings(), PreparedAirspace(site.airspace)
    for profile in profiles.values() or [VehicleProfile("S-1")]:
        known = replace(profile, endurance_s=profile.endurance_s or 1_500.0)
        full = VehicleState(
            1,
            "S-1",
            known,
            battery_fraction=Stamped(1.0, 0),
            height_above_takeoff_m=Stamped(height_m, 0),
        )
        station_s = time_left_s(full, air, settings)
        assert station_s is not None
        assert planned.level_flight_s(1.0, height_m, 0.25) <= station_s + 1e-9


def test_without_a_site_the_highest_go_home_height_is_assumed() -> None:
    uses = least_enduring(Site("none"), None, 60.0)
    assert uses.level_flight_s(1.0, 60.0, 0.25) == pytest.approx(636.0, abs=1.0)


def test_a_sites_region_pads_and_own_camera_are_used(tmp_path: Path) -> None:
    site = tmp_path / "site"
    site.mkdir()
    for each in demo_site_folder().iterdir():
        (site / each.name).write_bytes(each.read_bytes())
    (site / "cameras.toml").write_text(
        '[[cameras]]\nname = "mine"\nimage_px = [6000, 4000]\nsensor_mm = [23.5, 15.6]\n'
        "focal_mm = 16.0\ntimer_s = [1.0, 2.0]\n"
    )
    found = figures("south-east field", "--site", site, "--camera", "mine", "--height", 45)
    assert found["gsd_m"] == pytest.approx(23.5 / 16.0 * 45.0 / 6000.0)
    assert found["endurance_s"] == 25.0 * 60.0
    code, out = recon("no such field", "--site", site, "--height", 45)
    assert code == 2
    assert "available: " in out
    assert "south-east field" in out


def test_a_file_of_cameras_adds_to_the_table_and_to_the_sites(field: Path, tmp_path: Path) -> None:
    own = tmp_path / "my-cameras.toml"
    own.write_text(
        '[[cameras]]\nname = "wide"\nimage_px = [6000, 4000]\ndiagonal_deg = 84\ntimer_s = [1.0]\n'
    )
    found = figures(field, "--cameras", own, "--camera", "wide", "--height", 60)
    assert (found["camera"], found["camera_source"]) == ("wide", "my-cameras.toml")
    half_m = found["gsd_m"] * (6000.0**2 + 4000.0**2) ** 0.5 / 2.0
    assert degrees(2.0 * atan(half_m / 60.0)) == pytest.approx(84.0)
    listed = recon("--camera", "list", "--cameras", own)[1]
    assert "wide  wide  6000 x 4000" in listed
    assert "p1-35mm" in listed


def test_the_cameras_are_listed_with_their_sources() -> None:
    code, out = recon("--camera", "list")
    assert code == 0
    assert "p1-35mm  Zenmuse P1, 35 mm  8192 x 5460" in out
    assert recon("--height", 60) == (
        2,
        "recon plan: name a region: a file, or a survey region of --site\n",
    )


@pytest.mark.parametrize(
    ("options", "code", "words"),
    [
        ((), 2, "give either --gsd"),
        (("--gsd", "2cm", "--height", "60"), 2, "give either --gsd"),
        (("--gsd", "two"), 2, "--gsd: expected 0.5 mm to 5 m"),
        (("--gsd", "2"), 2, "with its unit, such as 2cm"),
        (("--height", "60", "--camera", "mavic9"), 2, "Camera 'mavic9' not found"),
        (("--height", "60", "--exposure", "1/0"), 2, "--exposure: expected"),
        (("--height", "60", "--cameras", "missing.toml"), 2, "missing.toml: expected a file"),
        (("--height", "900"), 1, "the height is 900 m: 1 to 500 m are possible"),
        (("--height", "0"), 1, "the height is 0 m: 1 to 500 m are possible"),
        (("--height", "1"), 1, "from 1 m a photo shows 1.4 x 1.1 m, too little"),
        (("--height", "60", "--interval", "0"), 1, "the camera's interval is 0 s: 0.1 to 60 s"),
        (("--height", "60", "--exposure", "1"), 1, "(blur of 0.5 pixel at an exposure of 1 s)"),
        (("--height", "60", "--interval", "0.1"), 1, "has no 0.1 s: choose one of 0.7, 1, 2,"),
        (("--height", "60", "--interval", "4"), 1, "has no 4 s: choose one of 0.7, 1, 2,"),
    ],
)
def test_wrong_options_are_a_sentence(
    field: Path, options: tuple[str, ...], code: int, words: str
) -> None:
    got, out = recon(field, *options)
    assert (got, len(out.splitlines())) == (code, 1), out
    assert words in out


def test_no_output_is_written_over_the_field_or_another_output(field: Path, tmp_path: Path) -> None:
    boundary, both = field.read_bytes(), tmp_path / "both"
    for options in (("--geojson", field), ("--png", field), ("--png", both, "--geojson", both)):
        code, out = recon(field, "--height", 60, *options)
        assert (code, len(out.splitlines())) == (2, 1), out
        assert "expected a file of its own" in out
    assert field.read_bytes() == boundary
    assert not both.exists()


def test_rows_above_the_sites_height_limit_are_refused() -> None:
    region = ("south-east field", "--site", demo_site_folder())
    code, out = recon(*region, "--height", 140)
    assert (code, len(out.splitlines())) == (1, 1), out
    assert "the rows are at 140 m, and the site allows 130 m above ground at most" in out
    assert recon(*region, "--height", 100)[0] == 0


def test_a_speed_above_the_limit_is_warned_of(field: Path) -> None:
    code, out = recon(field, "--height", 60, "--speed", 9)
    assert code == 1
    assert "warning  9 m/s is more than 7.99 m/s: blur of 0.5 pixel" in out


@given(st.text(max_size=12))
def test_any_text_is_a_size_within_bounds_or_an_error(text: str) -> None:
    for read, least, most in ((_gsd_m, 0.0005, 5.0), (_exposure_s, 1e-5, 1.0)):
        with contextlib.suppress(PlanError):
            assert least <= read(text) <= most
