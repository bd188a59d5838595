"""The true sky, projected where the station believes that the frame lies."""

from collections import deque
from dataclasses import replace
from math import cos, radians

import numpy as np
import pytest
from tests.score.scenes import small

from recon.camera import TelemetryReference
from recon.detection import DetectionSettings, DetectionState
from recon.forecast import ForecastSettings, ForecastState
from recon.geo import cell_centres_m
from recon.model.imagery import CameraPose, Frame
from recon.model.shade import ShadeMap
from recon.model.units import NS_PER_S
from recon.score import Scenario
from recon.score.ideal_detection import IdealDetection
from recon.score.simulation import rig_of
from recon.score.true_frames import TrueFrames
from recon.sim.app.camera_feed import CaptureTimes
from recon.sim.camera.field import FieldRenderer
from recon.sim.camera.frames import CameraView
from recon.sim.camera.settings import CameraSettings
from recon.sim.fleet import IMAGER_SERIAL
from recon.sim.world import LayerSettings, Sky, SkySettings
from recon.station.imaging.shade import ReadShade
from recon.station.state.imaging import ProjectFrame, SeenShade

SKY = Sky(SkySettings(seed=5, layers=(LayerSettings(cover=0.5, outer_scale_m=1000.0),)))
METRES_PER_DEGREE = 111_000.0


@pytest.fixture(scope="module")
def scenario(tmp_path_factory: pytest.TempPathFactory) -> Scenario:
    return small(tmp_path_factory.mktemp("scenarios"))


def read(
    scenario: Scenario, taken_s: float, true: CameraPose, telemetry: TelemetryReference
) -> ShadeMap:
    """The map of a frame taken at a time from a pose, which the station takes for one of 60 s."""
    imager = scenario.site.imager
    assert imager is not None
    renderer = FieldRenderer(imager.camera, imager.image_circle, imager=CameraSettings.perfect())
    at_ns = 60 * NS_PER_S
    view = CameraView(taken_s, 12, true)
    sent = deque([CaptureTimes(view, round(taken_s * NS_PER_S), at_ns)])
    ideal = IdealDetection(scenario, SKY, TrueFrames(sent, renderer, latency_s=0.0), shows_sun=True)
    marked = rig_of(scenario.frame, imager).marked
    pixels = np.zeros((8, 8, 3), dtype=np.uint8)
    frame = Frame(1, IMAGER_SERIAL, at_ns, at_ns, 0.0, rgb=pixels)
    image = ideal.project(ProjectFrame(frame, telemetry, marked)).image
    work = ReadShade(
        image, DetectionState(), ForecastState(), DetectionSettings(), ForecastSettings()
    )
    found = ideal.read(work).own
    assert isinstance(found, SeenShade)
    return found.shade


def marked_of(scenario: Scenario) -> tuple[TelemetryReference, CameraPose]:
    imager = scenario.site.imager
    assert imager is not None
    return rig_of(scenario.frame, imager).marked, imager.marked_pose


def test_with_true_pose_and_time_the_map_is_the_sky(scenario: Scenario) -> None:
    marked, pose = marked_of(scenario)
    shade = read(scenario, 60.0, pose, marked)
    assert shade.valid.mean() > 0.95
    truth = SKY.on_grid(shade.grid, 60.0)
    assert shade.transmittance[shade.valid] == pytest.approx(truth[shade.valid], abs=1e-4)


def test_the_sky_is_that_of_the_true_capture(scenario: Scenario) -> None:
    marked, pose = marked_of(scenario)
    shade = read(scenario, 57.0, pose, marked)
    assert shade.captured_at_ns == 60 * NS_PER_S
    truth = SKY.on_grid(shade.grid, 57.0)
    assert shade.transmittance[shade.valid] == pytest.approx(truth[shade.valid], abs=1e-4)


def test_a_pose_that_telemetry_has_wrong_shifts_the_map(scenario: Scenario) -> None:
    """Telemetry reports 8 m north of where the camera is: its ground is projected 8 m too far
    north.
    """
    marked, pose = marked_of(scenario)
    off = replace(marked, latitude_deg=marked.latitude_deg + 8.0 / METRES_PER_DEGREE)
    shade = read(scenario, 60.0, pose, off)
    east_m, north_m = np.meshgrid(*cell_centres_m(shade.grid))
    truth = SKY.transmittance(east_m, north_m - 8.0, 60.0)
    differs = np.abs(shade.transmittance - truth)[shade.valid]
    unshifted = np.abs(shade.transmittance - SKY.on_grid(shade.grid, 60.0))[shade.valid]
    assert np.quantile(differs, 0.99) < 0.01
    assert unshifted.mean() > 10.0 * differs.mean()


def test_ground_beyond_the_image_circle_is_unknown(scenario: Scenario) -> None:
    imager = scenario.site.imager
    assert imager is not None
    assert imager.image_circle is not None
    half = replace(imager.image_circle, radius_px=imager.image_circle.radius_px / 2.0)
    narrow = replace(scenario, site=scenario.site.with_imager(replace(imager, image_circle=half)))
    marked, pose = marked_of(narrow)
    shade = read(narrow, 60.0, pose, marked)
    east_m, north_m = np.meshgrid(*cell_centres_m(shade.grid))
    across_m = np.hypot(east_m - pose.position_enu_m[0], north_m - pose.position_enu_m[1])
    assert across_m[shade.valid].max() < across_m[~shade.valid].min()
    assert across_m[shade.valid].max() < scenario.imager.height_m / cos(radians(45.0))
