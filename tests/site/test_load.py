"""Reading a site's folder: what it may say, and what a bad one gets."""

import dataclasses
import shutil
from pathlib import Path

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from tests.examples import examples

from recon.camera import TelemetryReference
from recon.model.airspace import FlightLimits
from recon.model.geo import GeoPoint
from recon.model.vehicle import AltitudeReference, Failsafe, Mount, VehicleProfile
from recon.site import SiteError, default_site, demo_site_folder, load_site, own_folder
from recon.site.report import site_report

ORIGIN = "[origin]\nlatitude_deg = 41.9012\nlongitude_deg = -93.6034\nground_altitude_m = 275.0\n"
BY_TELEMETRY = '[imager]\nserial = "IMAGER"\nplaced_by = "telemetry"\n'
IMAGER = '[imager]\nserial = "IMAGER"\ncontrol_points_image_size_px = [3840, 2160]\n'
MINIMAL = 'name = "a field"\n' + ORIGIN


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """A folder with a lens and control points; tests write its site.toml."""
    for name in ("camera-model.txt", "GCPs.txt"):
        shutil.copy(demo_site_folder() / name, tmp_path / name)
    return tmp_path


def write(folder: Path, text: str) -> Path:
    (folder / "site.toml").write_text(text)
    return folder


def refusal(folder: Path, text: str) -> str:
    with pytest.raises(SiteError) as caught:
        load_site(write(folder, text))
    message = str(caught.value)
    assert message.isprintable()
    return message.replace(str(folder), "")


def test_name_and_origin_are_enough(folder: Path) -> None:
    site = load_site(write(folder, MINIMAL))
    assert site.name == "a field"
    assert site.imager is None
    assert site.frame is not None
    assert site.frame.origin == GeoPoint(41.9012, -93.6034, 275.0)
    grid = site.ground_grid
    assert grid is not None
    assert (grid.west_m, grid.south_m, grid.east_m, grid.north_m) == (-256, -256, 256, 256)
    assert (grid.rows, grid.cols, grid.cell_m) == (512, 512, 1.0)
    assert dict(site.profiles) == {}


def test_the_imager_uses_the_usual_file_names_and_reports_a_missing_marked_frame(
    folder: Path,
) -> None:
    site = load_site(write(folder, MINIMAL + IMAGER))
    assert site.imager is not None
    assert site.imager.first_frame_stands_for_marked_frame
    assert site.imager.image_circle is None
    assert site.imager.solution is not None
    assert len(site.imager.solution.residuals) == 8
    assert site.imager.solution.rms_px < 0.5
    assert site.profiles["IMAGER"] == VehicleProfile("IMAGER")


def test_without_control_points_telemetry_leads_on_from_the_origin(folder: Path) -> None:
    site = load_site(write(folder, MINIMAL + BY_TELEMETRY))
    assert site.imager is not None
    assert site.imager.solution is None
    assert site.imager.marked_frame == TelemetryReference(41.9012, -93.6034, 0.0, 0.0)
    assert site.imager.marked_pose.position_enu_m.tolist() == [0.0, 0.0, 0.0]
    (line,) = [line for line in site_report(site) if "no control points" in line]
    assert "at 120 m expect the ground image off by 4 m below the drone and 11 m at 195 m" in line


class TestSeveralImagingDrones:
    @staticmethod
    def tables(*serials: str) -> str:
        one = BY_TELEMETRY.replace("[imager]", "[[imager]]")
        return MINIMAL + "".join(one.replace("IMAGER", serial) for serial in serials)

    def test_they_are_known_by_serial_in_the_files_order(self, folder: Path) -> None:
        site = load_site(write(folder, self.tables("NORTH", "SOUTH")))
        assert list(site.imagers) == ["NORTH", "SOUTH"]
        assert site.imager is site.imagers["NORTH"]
        assert {"NORTH", "SOUTH"} <= set(site.profiles)
        drones = [line for line in site_report(site) if line.startswith("imaging drone ")]
        assert [line.split()[2] for line in drones] == ["NORTH:", "SOUTH:"]

    def test_one_in_a_list_is_one(self, folder: Path) -> None:
        assert list(load_site(write(folder, self.tables("NORTH"))).imagers) == ["NORTH"]

    def test_each_only_once(self, folder: Path) -> None:
        with pytest.raises(
            SiteError, match=r"imager\[1\]\.serial: expected each .* got NORTH twice"
        ):
            load_site(write(folder, self.tables("NORTH", "NORTH")))

    def test_a_wrong_value_names_which(self, folder: Path) -> None:
        wrong = self.tables("NORTH", "SOUTH") + "exposure = 'bright'\n"
        with pytest.raises(SiteError, match=r"imager\[1\]"):
            load_site(write(folder, wrong))

    def test_not_more_than_one_worker_reads(self, folder: Path) -> None:
        serials = [f"N{number}" for number in range(5)]
        with pytest.raises(SiteError, match="expected 4 imaging drones or fewer, got 5"):
            load_site(write(folder, self.tables(*serials)))


def test_without_a_folder_nothing_is_known() -> None:
    site = default_site()
    assert (site.frame, site.ground_grid, site.imager) == (None, None, None)
    assert dict(site.profiles) == {}


def test_a_vehicles_keys_reach_its_profile(folder: Path) -> None:
    table = """
[[vehicles]]
serial = "0K1CE9R0050123"
name = "North"
model = "Matrice 210"
waypoint_altitude = "wgs84"
mount = "fixed"
pad = { latitude_deg = 41.9, longitude_deg = -93.6, altitude_m = 274.5 }
max_waypoints = 50
battery_factor = 2
video_latency_s = 0.8
video_latency_sigma_s = 0.3
packet_gap_s = 0.2
endurance_min = 27.5
go_home_height_m = 48
failsafe = "land"
camera_interval_s = 2
priority = 7
"""
    profile = load_site(write(folder, MINIMAL + table)).profiles["0K1CE9R0050123"]
    assert profile == VehicleProfile(
        serial="0K1CE9R0050123",
        name="North",
        model="Matrice 210",
        waypoint_altitude=AltitudeReference.WGS84,
        mount=Mount.FIXED,
        pad=GeoPoint(41.9, -93.6, 274.5),
        max_waypoints=50,
        battery_factor=2.0,
        video_latency_s=0.8,
        video_latency_sigma_s=0.3,
        packet_gap_s=0.2,
        endurance_s=1650.0,
        go_home_height_m=48.0,
        failsafe=Failsafe.LAND,
        camera_interval_s=2.0,
        priority=7,
    )


def test_the_legacy_preset_limits_missions_unless_the_file_overrides_it(folder: Path) -> None:
    table = '[[vehicles]]\nserial = "A"\napp = "legacy"\n'
    assert load_site(write(folder, MINIMAL + table)).profiles["A"].max_waypoints == 25
    table += "max_waypoints = 30\n"
    assert load_site(write(folder, MINIMAL + table)).profiles["A"].max_waypoints == 30


def test_limits_that_are_not_given_keep_their_defaults(folder: Path) -> None:
    assert load_site(write(folder, MINIMAL)).airspace.limits == FlightLimits()
    limits = "[limits]\nmax_height_above_ground_m = 90\nbattery_reserve_fraction = 0.4\n"
    assert load_site(write(folder, MINIMAL + limits)).airspace.limits == FlightLimits(
        max_height_above_ground_m=90.0, battery_reserve_fraction=0.4
    )


@pytest.mark.parametrize("field", [field.name for field in dataclasses.fields(FlightLimits)])
def test_every_limit_can_be_set_and_is_held_to_a_range(folder: Path, field: str) -> None:
    value = getattr(FlightLimits(), field)
    site = load_site(write(folder, MINIMAL + f"[limits]\n{field} = {value}\n"))
    assert site.limits == FlightLimits()
    for wrong in ("-1", "1e9"):
        text = MINIMAL + f"[limits]\n{field} = {wrong}\n"
        assert f"/site.toml: limits.{field}: expected a number of " in refusal(folder, text)


def vehicle(line: str) -> str:
    return MINIMAL + f'[[vehicles]]\nserial = "A"\n[[vehicles]]\n{line}\n'


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", "/site.toml: name is missing: expected a text of 1 to 64 characters without control"),
        ("name = ", "/site.toml: expected a TOML file, got: Invalid value"),
        ('name = "x"', "/site.toml: section [origin] is missing"),
        ('name = "x"\n[origin]\n', "origin.latitude_deg is missing: expected a number of -90 to"),
        (MINIMAL + "colour = 3", "latitude_deg, longitude_deg, ground_altitude_m, got 'colour'"),
        (MINIMAL.replace("41.9012", '"north"'), "a number of -90 to 90, got 'north'"),
        (MINIMAL.replace("41.9012", "141.9"), "a number of -90 to 90, got 141.9"),
        (MINIMAL.replace("275.0", "nan"), "ground_altitude_m: expected a finite number, got nan"),
        (MINIMAL.replace("275.0", "-inf"), "ground_altitude_m: expected a finite number, got -inf"),
        ('name = ""\n' + ORIGIN, "name: expected a text of 1 to 64 characters"),
        ('name = "\\u001b[2J"\n' + ORIGIN, "without control characters, got '\\x1b[2J'"),
        (MINIMAL + "[ground_image]\ncell_m = 3", "ground_image.height_m: expected a whole number"),
        (MINIMAL + "[ground_image]\ncell_m = 0.01", "expected at most 16777216 cells, got 51200"),
        (MINIMAL + "[ground_image]\ncell_m = 0", "cell_m: expected a number of 0.01 to 100, got 0"),
        (vehicle('serial = "A"'), "vehicles (entry 2).serial: expected each serial once, got 'A'"),
        (vehicle('serial = "B"\nname = "A"'), "(entry 2).name: expected a name that no other veh"),
        (vehicle('serial = "B"\nname = "C"\n[[vehicles]]\nserial = "D"\nname = "C"'), "got 'C' ag"),
        (
            MINIMAL.replace("= 41.9012", "= -93.6").replace("= -93.6034", "= 41.9"),
            "a number of -90 to 90, got -93.6; latitude and longitude look swapped",
        ),
        ('name = "x"\nlevel = 1' + "0" * 5000, "expected a TOML file, got: Exceeds the limit"),
        ("name = 0x" + "f" * 5000, "name: expected a finite number, got a number with very many"),
        ("name = 1979-05-27", "without control characters, got 1979-05-27"),
        (vehicle('serial = "00000"'), "vehicles (entry 2).serial: expected an aircraft's own"),
        (vehicle('serial = "a b"'), "printable ASCII characters without spaces, got 'a b'"),
        (
            vehicle('name = "B"'),
            "vehicles (entry 2).serial is missing: expected a text of 1 to 256",
        ),
        (
            vehicle('serial = "B"\nwaypoint_altitude = "agl"'),
            "vehicles (entry 2).waypoint_altitude: expected 'takeoff' or 'wgs84', got 'agl'",
        ),
        (vehicle('serial = "B"\nfailsafe = "rth"'), "expected 'go_home' or 'hover' or 'land'"),
        (vehicle('serial = "B"\ngo_home_height_m = 19'), "a number of 20 to 500, got 19"),
        (vehicle('serial = "B"\ngo_home_height_m = 501'), "a number of 20 to 500, got 501"),
        (
            vehicle('serial = "B"\ngo_home_height_m = 130'),
            "vehicles (entry 2).go_home_height_m: expected at most "
            "limits.max_height_above_ground_m, 120 m, got 130 m; set a lower one in the aircraft",
        ),
        (vehicle('serial = "B"\nendurance_min = 0'), "a number of 1 to 240, got 0"),
        (vehicle('serial = "B"\ncamera_interval_s = 0'), "interval_s: expected a number of 0.5"),
        (vehicle('serial = "B"\npriority = -1'), "a whole number of 0 to 100, got -1"),
        (
            vehicle(
                'serial = "B"\npad = { latitude_deg = -93.6, longitude_deg = 41.9, altitude_m = 1 }'
            ).replace("-93.6,", "-9.36,"),
            "vehicles (entry 2).pad: expected a place within 50 km of the site's origin, got one",
        ),
        (MINIMAL + "[limits]\nmax_speed_mps = 16", "max_speed_mps: expected a number of 1 to 15"),
        (MINIMAL + "[limits]\nceiling = 16", "battery_reserve_fraction, got 'ceiling'"),
        (
            MINIMAL + "[limits]\nmax_height_above_ground_m = 20\nmin_height_above_ground_m = 20",
            "limits.min_height_above_ground_m: expected less than max_height_above_ground_m, 20 m, "
            "got 20 m",
        ),
        (vehicle('serial = "B"\nmax_waypoints = 100'), "a whole number of 0 to 99, got 100"),
        (vehicle('serial = "B"\nmax_waypoints = 9.5'), "a whole number of 0 to 99, got 9.5"),
        (
            vehicle('serial = "B"\npad = { latitude_deg = 1 }'),
            "pad.longitude_deg is missing: expected a numb",
        ),
        (vehicle('serial = "B"\nspeed = 3'), "packet_gap_s, got 'speed'"),
        (
            MINIMAL + '[imager]\nserial = "E"',
            "imager.control_points_image_size_px is missing: expected columns and rows",
        ),
        (
            MINIMAL + IMAGER + 'placed_by = "telemetry"',
            "imager.control_points_image_size_px belongs to control points: remove it",
        ),
        (
            MINIMAL + BY_TELEMETRY + 'control_points = "GCPs.txt"',
            "imager.control_points belongs to control points: remove it",
        ),
        (MINIMAL + IMAGER + "tilt_deg = 20", "imager.tilt_deg belongs to a camera that telemetry"),
        (
            MINIMAL + BY_TELEMETRY + "tilt_deg = 61",
            "tilt_deg: expected a number of 0 to 60, got 61",
        ),
        (MINIMAL + IMAGER + 'placed_by = "guess"', "imager.placed_by: expected "),
        (MINIMAL + IMAGER.replace("2160", "3000"), "GCPs.txt: expected a frame of 3840 x 3000"),
        (MINIMAL + IMAGER.replace("3840", "0"), "_px[0]: expected a whole number of 2 to 16384"),
        (MINIMAL + IMAGER + 'camera = "other.txt"', "got 'other.txt', and there is no such file"),
        (MINIMAL + IMAGER + 'camera = "."', "got '.', and there is no such file"),
        (MINIMAL + IMAGER + 'camera = "GCPs.txt"', "/GCPs.txt, line"),
        (
            MINIMAL + IMAGER + 'control_points = "site.toml"',
            "/site.toml, line 1: expected 6 comma-separated values",
        ),
        (
            MINIMAL + IMAGER + "[imager.marked_frame]\nyaw_deg = 3",
            "imager.marked_frame.latitude_deg is missing: ",
        ),
        (
            MINIMAL
            + IMAGER
            + "[imager.marked_frame]\nlatitude_deg = 41.903\nlongitude_deg = -93.6034\n"
            "height_above_takeoff_m = 120\nyaw_deg = 0\n",
            "imager.marked_frame: expected telemetry within 100 m of where",
        ),
        (
            (MINIMAL + IMAGER).replace("275.0", "305.0"),
            "GCPs.txt: expected altitudes within 15 m of origin.ground_altitude_m in site.toml, "
            "got -30.0 m",
        ),
        (
            (MINIMAL + IMAGER).replace("41.9012", "41.99"),
            "control point A: expected within 5000 m of the site's origin, got",
        ),
    ],
)
def test_an_error_is_one_sentence_with_the_key(folder: Path, text: str, message: str) -> None:
    assert message in refusal(folder, text)


@pytest.mark.parametrize(
    "name", ["../lens.txt", "/etc/passwd", "a/../../lens.txt", "sub/../../lens.txt", "link.txt"]
)
def test_no_file_outside_the_folder_is_read(tmp_path: Path, name: str) -> None:
    inside = tmp_path / "site"
    inside.mkdir()
    shutil.copy(demo_site_folder() / "GCPs.txt", inside)
    shutil.copy(demo_site_folder() / "camera-model.txt", tmp_path / "lens.txt")
    (inside / "link.txt").symlink_to(tmp_path / "lens.txt")
    assert "leads out of it" in refusal(inside, MINIMAL + IMAGER + f'camera = "{name}"')


def test_names_no_file_system_takes_are_refused(folder: Path) -> None:
    (folder / "loop.txt").symlink_to(folder / "loop.txt")
    assert "no such file" in refusal(folder, MINIMAL + IMAGER + 'camera = "loop.txt"')
    assert "no such file" in refusal(folder, MINIMAL + IMAGER + f'camera = "{chr(0x1F681) * 150}"')
    assert "a file's name of 1 to 200 characters without control" in refusal(
        folder, MINIMAL + IMAGER + 'camera = "a\\u0000b"'
    )


def test_a_file_in_a_folder_below_is_read(folder: Path) -> None:
    (folder / "lens").mkdir()
    shutil.move(folder / "camera-model.txt", folder / "lens" / "model.txt")
    site = load_site(write(folder, MINIMAL + IMAGER + 'camera = "lens/model.txt"'))
    assert site.imager is not None


def test_a_missing_folder_a_huge_file_and_deep_nesting_are_refused(tmp_path: Path) -> None:
    with pytest.raises(SiteError, match=r"Folder or site.toml not found"):
        load_site(tmp_path / "nowhere")
    assert "at most 262144 bytes" in refusal(tmp_path, "#" * 300_000)
    assert "expected a TOML file" in refusal(tmp_path, "a = " + "[" * 50_000)
    (tmp_path / "site.toml").write_bytes(b'name = "\xff"')
    with pytest.raises(SiteError, match="expected a TOML file, got: 'utf-8'"):
        load_site(tmp_path)


def test_a_file_with_fewer_than_four_points_gives_no_site(folder: Path) -> None:
    lines = (folder / "GCPs.txt").read_text().splitlines()
    (folder / "GCPs.txt").write_text("\n".join(lines[:6]))
    assert "expected at least 4 control points, got 3" in refusal(folder, MINIMAL + IMAGER)


values = st.recursive(
    st.one_of(
        st.integers(-(2**40), 2**40).map(str),
        st.floats(allow_nan=False, allow_infinity=False).map(repr),
        st.sampled_from(["nan", "inf", "true", "1979-05-27", '"x"', '""']),
    ),
    lambda inner: st.one_of(
        st.lists(inner, max_size=3).map(lambda items: "[" + ", ".join(items) + "]"),
        st.dictionaries(st.sampled_from(["serial", "a", "pad"]), inner, max_size=2).map(
            lambda table: "{" + ", ".join(f"{k} = {v}" for k, v in table.items()) + "}"
        ),
    ),
    max_leaves=6,
)
TABLES = ["name", "origin", "limits", "imager", "ground_image", "layers", "elevation", "vehicles"]
keys = st.sampled_from([*TABLES, "colour"])


@settings(max_examples=examples(150), suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(st.dictionaries(keys, values, max_size=5))
def test_any_toml_gives_a_refusal_that_names_the_file(
    tmp_path: Path, tables: dict[str, str]
) -> None:
    text = "\n".join(f"{key} = {value}" for key, value in tables.items())
    assert refusal(tmp_path, text).startswith("/site.toml: ")


scalars = st.one_of(
    st.floats(-1e3, 1e3).map(repr),
    st.integers(-5, 600).map(str),
    st.sampled_from(['"go_home"', '"takeoff"', '"x"', '"site.toml"', '"wgs84"', "nan", "[]", "{}"]),
)
LIMITS = [field.name for field in dataclasses.fields(FlightLimits)]
KEYS = ["name", "failsafe", "endurance_min", "go_home_height_m", "camera_interval_s", "priority"]
any_limits = st.dictionaries(st.sampled_from(LIMITS), scalars, max_size=3)
any_vehicle = st.dictionaries(st.sampled_from([*KEYS, "pad", "mount"]), scalars, max_size=3)
any_elevation = st.dictionaries(
    st.sampled_from(["file", "datum", "geoid_height_m"]), scalars, max_size=3
)


@settings(max_examples=examples(200), suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(any_limits, any_vehicle, st.none() | any_elevation)
def test_whatever_keys_say_a_site_is_read_or_refused_in_a_sentence(
    tmp_path: Path,
    limits: dict[str, str],
    vehicle: dict[str, str],
    elevation: dict[str, str] | None,
) -> None:
    text = MINIMAL + table("[limits]", limits) + table('[[vehicles]]\nserial = "A"', vehicle)
    text += "" if elevation is None else table("[elevation]", elevation)
    result = outcome(write(tmp_path, text))
    assert result.isprintable()
    assert result == "read" or result.startswith(f"{tmp_path}/site.toml: ")


def test_things_are_kept_in_a_folder_of_ones_own_only(tmp_path: Path) -> None:
    assert own_folder(tmp_path) == tmp_path
    assert own_folder(None) is None
    for demo in (demo_site_folder(), demo_site_folder() / ".." / "demo"):
        assert own_folder(demo) is None


def table(head: str, items: dict[str, str]) -> str:
    return "".join(f"{line}\n" for line in (head, *(f"{k} = {v}" for k, v in items.items())))


def outcome(folder: Path) -> str:
    try:
        load_site(folder)
    except SiteError as problem:
        return str(problem)
    return "read"
