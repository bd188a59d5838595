"""The ground truth is right, and available only to the score and tests."""

import ast
from pathlib import Path

import numpy as np
import pytest

import recon
from recon.model.geo import GeoPoint, GroundGrid, LocalFrame
from recon.model.survey import SurveyCamera
from recon.model.units import NS_PER_S, seconds_to_ns
from recon.sim.camera.frames import CameraView
from recon.sim.camera.survey_shutter import LATEST_S, IntervalTimer, footprint_m, photos
from recon.sim.errors import SimulationError
from recon.sim.flight.kinematics import AircraftMotion
from recon.sim.truth import WorldTruth
from recon.sim.world import LayerSettings, Sky, SkySettings

SECRETS = ("recon.sim.truth", "recon.sim.camera.survey_shutter")
MAY_KNOW = {"sim", "score"}
CAMERA = SurveyCamera(interval_s=2.0)


def imported(path: Path) -> set[str]:
    names: set[str] = set()
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Import):
            names |= {alias.name for alias in node.names}
        elif isinstance(node, ast.ImportFrom) and node.module is not None:
            names |= {node.module, *(f"{node.module}.{alias.name}" for alias in node.names)}
    return names


def test_only_the_simulator_and_the_score_import_the_truth() -> None:
    root = Path(recon.__file__).parent
    knowing = {
        path.relative_to(root).parts[0]
        for path in root.rglob("*.py")
        if imported(path).intersection(SECRETS)
    }
    assert knowing
    assert knowing <= MAY_KNOW


def eastwards(time_ns: int) -> AircraftMotion:
    """Fly east at 5 m/s, 40 m up."""
    return AircraftMotion(east_m=5.0 * time_ns / NS_PER_S, north_m=7.0, height_m=40.0, yaw_deg=90.0)


def test_a_timer_fires_once_an_interval_at_its_own_phase() -> None:
    timer = IntervalTimer(3, "SIM-1", 2.0)
    fired = timer.between(0, 100 * NS_PER_S)
    assert [number for number, _ in fired] == list(range(50))
    phases = np.array([time_ns / NS_PER_S - 2.0 * number for number, time_ns in fired])
    assert phases.min() >= timer.phase_s
    assert phases.max() <= timer.phase_s + LATEST_S
    assert np.ptp(phases) > 0.5 * LATEST_S


def test_timers_phases_fill_the_interval() -> None:
    phases = [IntervalTimer(3, f"SIM-{n}", 2.0).phase_s for n in range(200)]
    counts, _ = np.histogram(phases, bins=4, range=(0.0, 2.0))
    assert counts.min() > 30
    assert phases == [IntervalTimer(3, f"SIM-{n}", 2.0).phase_s for n in range(200)]


@pytest.mark.parametrize("cut_s", [0.0, 0.5, 13.37, 99.99])
def test_spans_side_by_side_have_each_photo_once(cut_s: float) -> None:
    timer, cut_ns = IntervalTimer(3, "SIM-2", 2.0), seconds_to_ns(cut_s)
    end_ns = 100 * NS_PER_S
    parts = timer.between(0, cut_ns) + timer.between(cut_ns, end_ns)
    assert parts == timer.between(0, end_ns)


@pytest.mark.parametrize("interval_s", [0.0, -1.0, float("nan"), 1e6])
def test_a_senseless_interval_is_refused(interval_s: float) -> None:
    with pytest.raises(SimulationError, match="interval timer: expected"):
        IntervalTimer(0, "SIM-1", interval_s)


def test_a_photo_shows_the_ground_beneath_its_camera() -> None:
    corners = footprint_m(eastwards(0), CAMERA)
    half_along, half_across = CAMERA.along_m(40.0) / 2.0, CAMERA.across_m(40.0) / 2.0
    expected = [
        (half_along, 7.0 + half_across),
        (half_along, 7.0 - half_across),
        (-half_along, 7.0 - half_across),
        (-half_along, 7.0 + half_across),
    ]
    assert corners == pytest.approx(np.array(expected))


def test_photos_are_taken_in_flight_only_and_from_home() -> None:
    timer = IntervalTimer(3, "SIM-1", 2.0)
    taken = photos(
        timer,
        CAMERA,
        lambda t: eastwards(t) if t > 20 * NS_PER_S else AircraftMotion(),
        (0, 60 * NS_PER_S),
        (100.0, -30.0, 2.0),
    )
    assert len(taken) == pytest.approx(20, abs=1)
    for photo in taken:
        assert photo.captured_at_ns == timer.capture_ns(photo.number) > 20 * NS_PER_S
        flown_m = 5.0 * photo.captured_at_ns / NS_PER_S
        assert (photo.east_m, photo.north_m, photo.height_m) == (100.0 + flown_m, -23.0, 42.0)
    assert photos(timer, CAMERA, lambda _: None, (0, 60 * NS_PER_S)) == []


def test_the_share_in_sun_is_the_skys_at_the_time_of_the_photo() -> None:
    sky = Sky(SkySettings(3, layers=(LayerSettings(cover=0.5, outer_scale_m=500.0),)))
    truth = WorldTruth(sky, seed=3)
    taken = truth.survey_photos("SIM-1", CAMERA, eastwards, (0, 300 * NS_PER_S))
    shares = np.array([truth.share_in_sun(photo, 16) for photo in taken])
    assert shares.min() < 0.1
    assert shares.max() > 0.9
    for photo, share in list(zip(taken, shares, strict=True))[::20]:
        (west, south), (east, north) = photo.corners_m.min(axis=0), photo.corners_m.max(axis=0)
        places = np.meshgrid(np.linspace(west, east, 60), np.linspace(south, north, 60))
        sunlit = sky.transmittance(*places, photo.captured_at_ns / NS_PER_S) >= 0.5
        assert share == pytest.approx(sunlit.mean(), abs=0.06)


def test_transmittance_is_the_skys() -> None:
    sky = Sky(SkySettings(3))
    truth = WorldTruth(sky)
    grid = GroundGrid(LocalFrame(GeoPoint(0.0, 0.0, 0.0)), -50.0, 50.0, 10.0, 10, 10)
    assert np.array_equal(truth.transmittance_on(grid, NS_PER_S), sky.on_grid(grid, 1.0))
    assert truth.transmittance(5.0, 6.0, NS_PER_S) == sky.transmittance(5.0, 6.0, 1.0)
    assert truth.sun_at(60 * NS_PER_S) == sky.sun_at(60.0)


def test_a_world_without_an_imager_has_no_true_pose() -> None:
    with pytest.raises(SimulationError, match="expected an imaging drone"):
        WorldTruth(Sky(SkySettings())).imager_pose(CameraView(0.0, 0, None))
