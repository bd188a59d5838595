"""Two simulated imaging drones over the demonstration field, with rendered frames."""

import shutil
from pathlib import Path

import pytest

from recon.model.imagery import Registration
from recon.score.simulation import rig_of
from recon.sim.app.camera_feed import FeedSettings
from recon.sim.camera import CameraSettings
from recon.sim.camera.field import FieldRenderer
from recon.sim.fleet import ImagerSetup, SimulationConfig, build_fleet
from recon.sim.world import Sky, SkySettings
from recon.site import Site, demo_site_folder, load_site
from recon.station.api_views.imaging_views import ground_image_view, shade_view
from recon.station.imaging.mosaic import mosaic, newest_images
from recon.station.kernel.build import first_state
from recon.station.kernel.virtual import VirtualDriver
from recon.station.kernel.worker import JobRunner

AWAY_M = 150.0


@pytest.fixture(scope="module")
def site(tmp_path_factory: pytest.TempPathFactory) -> Site:
    """The demonstration's site with a second imaging drone of the same lens."""
    folder = tmp_path_factory.mktemp("two") / "site"
    shutil.copytree(demo_site_folder(), folder)
    return load_site(with_second_imager(folder))


def with_second_imager(folder: Path) -> Path:
    """Make the table of the imaging drone one of two."""
    path = folder / "site.toml"
    text = path.read_text()
    start, end = text.index("[imager]"), text.index("[", text.index("[imager.image_circle]") + 1)
    table = text[start:end].replace("[imager]", "[[imager]]")
    second = table.replace("SIM-IMAGER", "SIM-SECOND")
    path.write_text(text[:start] + table + second + text[end:])
    return folder


@pytest.fixture(scope="module")
def driver(site: Site) -> VirtualDriver:
    """After eight seconds, the second one 150 m east of the first."""
    assert site.frame is not None
    sky, imagers = Sky(SkySettings(3)), {}
    for serial, imager in site.imagers.items():
        rig = rig_of(site.frame, imager)
        camera = CameraSettings(3)
        source = FieldRenderer(imager.camera, imager.image_circle, 3, sky, camera)
        imagers[serial] = ImagerSetup(source, FeedSettings(1.0, latency_s=0.3), rig)
    config = SimulationConfig(home=site.frame.origin, vehicle_count=2, imagers=imagers)
    driver = VirtualDriver(first_state(site), jobs=JobRunner(site))
    for app in build_fleet(config, driver.now_ns):
        if app.settings.serial == "SIM-SECOND":
            app.aircraft.motion = app.aircraft.motion._replace(east_m=AWAY_M)
        app.connected(driver.now_ns)
        driver.connect(app)
    driver.run_for(8.0)
    return driver


def test_the_site_knows_both(site: Site) -> None:
    assert list(site.imagers) == ["SIM-IMAGER", "SIM-SECOND"]
    assert site.imager is site.imagers["SIM-IMAGER"]


@pytest.mark.flight
def test_each_ones_frames_are_projected_where_it_is(driver: VirtualDriver) -> None:
    images = {image.serial: image for image in newest_images(driver.station.imaging)}
    first, second = images["SIM-IMAGER"], images["SIM-SECOND"]
    apart_m = second.pose.position_enu_m - first.pose.position_enu_m
    assert apart_m[0] == pytest.approx(AWAY_M, abs=6.0)
    assert abs(apart_m[1]) < 6.0
    assert {first.registration, second.registration} == {Registration.REGISTERED}
    one = mosaic((first, second))
    assert one is not None
    assert one.valid.sum() > 1.1 * max(first.valid.sum(), second.valid.sum())


@pytest.mark.flight
def test_shade_is_one_map_of_both(driver: VirtualDriver) -> None:
    shade = driver.station.shade
    assert shade.shade is not None
    assert set(shade.shade.source_serials) == {"SIM-IMAGER", "SIM-SECOND"}
    assert shade.seen is not None
    assert shade.seen.sum() > 1.1 * max(own.seen.sum() for own in shade.own.values())
    assert shade.frames_rejected == 0


@pytest.mark.flight
def test_the_console_is_told_of_both(driver: VirtualDriver) -> None:
    station = driver.station
    view = ground_image_view(station, driver.now_ns)
    assert view is not None
    assert set(view.serials) == {"SIM-IMAGER", "SIM-SECOND"}
    assert 0.0 < view.captured_age_s < 3.0
    line = shade_view(station, driver.now_ns)
    assert line is not None
    assert line.map is not None
    assert line.rejected is None
