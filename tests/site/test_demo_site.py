"""The demonstration's site: the shipped files are what the generator writes, and they work."""

import shutil
from itertools import combinations
from pathlib import Path

import numpy as np
import pytest
from tools.demo_site import (
    BOUNDARY,
    ELEVATION_FILE,
    IMAGER_HEIGHT_M,
    IMAGER_SERIAL,
    ORIGIN,
    SERIALS,
    demo_camera,
    demo_elevation_bytes,
    demo_marked_telemetry,
    demo_site_files,
)

from recon.camera import (
    GroundProjector,
    find_image_circle,
    format_camera,
    mounted_pose,
    parse_camera,
    parse_control_points,
)
from recon.geo import Footprints, Polygon, enu_from_points
from recon.model.airspace import ZoneKind
from recon.model.geo import LocalFrame
from recon.model.vehicle import AltitudeReference, Failsafe
from recon.safety import PreparedAirspace
from recon.site import demo_site_folder, load_site


def test_the_shipped_files_are_those_the_generator_writes() -> None:
    written = demo_site_files()
    files = [path for path in demo_site_folder().iterdir() if path.name != ELEVATION_FILE]
    shipped = {path.name: path.read_text() for path in files}
    assert shipped.keys() == written.keys()
    assert shipped["site.toml"] == written["site.toml"]
    for name in written:
        if name.endswith(".geojson"):
            assert shipped[name] == written[name]
    # The fits may differ in their last digits between numeric libraries.
    ours = parse_camera(written["camera-model.txt"], "written")
    theirs = parse_camera(shipped["camera-model.txt"], "shipped")
    assert np.array(theirs.direct) == pytest.approx(np.array(ours.direct), rel=1e-6)
    angles = np.linspace(0.0, 1.48, 50)
    assert theirs.profile.radius_px(angles) == pytest.approx(ours.profile.radius_px(angles))
    pairs = zip(
        parse_control_points(shipped["GCPs.txt"], "shipped"),
        parse_control_points(written["GCPs.txt"], "written"),
        strict=True,
    )
    for ship, make in pairs:
        assert (ship.name, ship.latitude_deg) == (make.name, pytest.approx(make.latitude_deg))
        assert (ship.col_px, ship.row_px) == pytest.approx((make.col_px, make.row_px), abs=0.011)


def test_the_lens_is_an_equisolid_fisheye_of_170_degrees() -> None:
    camera = demo_camera()
    angles = np.deg2rad(np.linspace(0.0, 85.0, 100))
    focal_px = 340.0 / (2.0 * np.sin(np.deg2rad(42.5)))
    assert camera.profile.radius_px(angles) == pytest.approx(
        2.0 * focal_px * np.sin(angles / 2.0), abs=0.3
    )
    assert parse_camera(format_camera(camera), "lens") == camera


def test_it_loads_and_its_pose_is_the_one_it_was_made_with() -> None:
    site = load_site(demo_site_folder())
    assert site.imager is not None
    assert site.frame is not None
    solution = site.imager.solution
    assert solution is not None
    assert 0.0 < solution.rms_px < 0.5
    assert solution.height_above_ground_m == pytest.approx(IMAGER_HEIGHT_M, abs=0.3)
    made_with = mounted_pose(demo_marked_telemetry(), np.array([0.0, 0.0, IMAGER_HEIGHT_M]))
    assert np.abs(solution.pose.position_enu_m - made_with.position_enu_m).max() < 0.4
    assert solution.pose.rotation_enu_camera == pytest.approx(
        made_with.rotation_enu_camera, abs=0.003
    )
    assert site.imager.marked_frame == demo_marked_telemetry()
    assert not site.imager.first_frame_stands_for_marked_frame


def test_its_layers_lie_where_they_were_drawn_and_keep_apart() -> None:
    site = load_site(demo_site_folder())
    layers = site.layers
    assert site.frame is not None
    assert layers.boundary is not None
    assert layers.boundary.outline_m == pytest.approx(np.array(BOUNDARY), abs=0.01)
    farmyard, trees = layers.zones
    assert (farmyard.name, farmyard.kind) == ("farmyard", ZoneKind.KEEP_OUT)
    assert (trees.name, trees.kind, trees.floor_m) == ("tree line", ZoneKind.HEIGHT, 35.0)
    field, yard = Polygon(layers.boundary), Polygon(farmyard.region)
    pads = [profile.pad for profile in site.profiles.values() if profile.pad is not None]
    assert field.contains(enu_from_points(site.frame, pads)[:, :2]).all()
    assert list(layers.survey_regions) == ["west field", "south-east field"]
    for outline in (region.outline_m for region in layers.survey_regions.values()):
        ends = np.roll(outline, -1, axis=0)
        legs = Footprints(np.stack([outline, ends, ends], axis=1))
        assert field.holds(legs, 20.0).all()
        assert yard.is_clear_of(legs, 20.0).all()


def test_its_ground_is_flat_as_the_simulators_is(tmp_path: Path) -> None:
    shipped = load_site(demo_site_folder())
    shutil.copytree(demo_site_folder(), tmp_path / "made")
    (tmp_path / "made" / ELEVATION_FILE).write_bytes(demo_elevation_bytes(LocalFrame(ORIGIN)))
    for site in (shipped, load_site(tmp_path / "made")):
        ground = PreparedAirspace(site.airspace)
        corners = [(east, north) for east in (-740.0, 740.0) for north in (-740.0, 740.0)]
        points_m = np.array([*BOUNDARY, *corners])
        assert ground.ground_up_m(points_m) == pytest.approx(0.0, abs=1e-6)


def test_two_can_land_at_once_and_all_ways_home_are_apart_and_legal() -> None:
    site = load_site(demo_site_folder())
    limits = site.limits
    pads = enu_from_points(site.frame, [pad.place for pad in site.airspace.landing_pads])
    assert len(pads) == 9
    apart_m = [float(np.hypot(*(a - b)[:2])) for a, b in combinations(pads, 2)]
    assert min(apart_m) > limits.min_separation_horizontal_m + 5.0
    heights = sorted(profile.go_home_height_m or 0.0 for profile in site.profiles.values())
    assert np.diff(heights) == pytest.approx(8.0)
    assert heights[0] >= max(zone.floor_m or 0.0 for zone in site.layers.zones) + 5.0
    assert heights[-1] <= limits.max_height_above_ground_m
    assert limits.max_height_above_ground_m > IMAGER_HEIGHT_M


def test_every_vehicle_of_the_demonstration_has_a_profile_that_can_fly_missions() -> None:
    site = load_site(demo_site_folder())
    assert set(site.profiles) == {IMAGER_SERIAL, *SERIALS}
    for profile in site.profiles.values():
        assert profile.waypoint_altitude is AltitudeReference.TAKEOFF
        assert profile.pad is not None
        assert profile.name
        assert profile.endurance_s == 1500.0
        assert profile.failsafe is Failsafe.GO_HOME
        assert (profile.camera_interval_s is None) == (profile.serial == IMAGER_SERIAL)


def test_the_imager_sees_the_ground_up_to_66_degrees() -> None:
    site = load_site(demo_site_folder())
    assert site.imager is not None
    assert site.ground_grid is not None
    projector = GroundProjector(site.ground_grid, site.imager.camera, site.imager.image_circle)
    grey = np.full((720, 1280, 3), 128, np.uint8)
    _, valid = projector.project_pixels(grey, site.imager.marked_pose)
    assert valid.shape == (544, 544)
    from_middle_m = np.hypot(*(np.mgrid[:544, :544] - 271.5))
    # A cell counts when the pixels around its centre are in the circle as well.
    seen_m = 120.0 * np.tan(np.radians(66.0))
    assert valid[from_middle_m < seen_m - 8.0].all()
    assert not valid[from_middle_m > seen_m + 4.0].any()
    assert find_image_circle(grey, site.imager.camera) is None
