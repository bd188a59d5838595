"""Which vehicles there are and where they start."""

from dataclasses import replace

import numpy as np
import pytest

from recon.camera import TelemetryReference, load_camera, mounted_pose
from recon.geo import enu_from_point, point_from_enu
from recon.model.geo import GeoPoint, LocalFrame
from recon.sim.app.app import SimulatedApp
from recon.sim.app.faults import parse_fault
from recon.sim.camera.frames import StillFrame
from recon.sim.camera.rig import CameraRig
from recon.sim.errors import FaultError
from recon.sim.fleet import (
    IMAGER_SERIAL,
    Airborne,
    ImagerSetup,
    SimulationConfig,
    build_fleet,
    fleet_serials,
)
from recon.site import demo_site_folder

HOME = GeoPoint(41.9, -93.6, 275.0)
IMAGER = ImagerSetup(StillFrame(np.zeros((9, 16, 3), dtype=np.uint8)))
CONFIG = SimulationConfig(home=HOME, imagers={IMAGER_SERIAL: IMAGER})


def heights(apps: list[SimulatedApp]) -> list[float]:
    return [app.aircraft.motion.height_m for app in apps]


def test_the_imaging_drone_is_the_first_vehicle() -> None:
    assert fleet_serials(CONFIG) == ("SIM-IMAGER", "SIM-1", "SIM-2", "SIM-3")
    assert fleet_serials(replace(CONFIG, imagers={})) == ("SIM-1", "SIM-2", "SIM-3", "SIM-4")
    assert fleet_serials(replace(CONFIG, vehicle_count=1)) == ("SIM-IMAGER",)


def test_several_imaging_drones_come_first() -> None:
    two = replace(CONFIG, imagers={"NORTH": IMAGER, "SOUTH": IMAGER})
    assert fleet_serials(two) == ("NORTH", "SOUTH", "SIM-1", "SIM-2")
    assert heights(build_fleet(two, 0)) == [130.0, 130.0, 0.0, 0.0]
    assert [app.feed is not None for app in build_fleet(two, 0)] == [True, True, False, False]


def test_only_the_imaging_drone_starts_in_the_air_by_default() -> None:
    assert heights(build_fleet(CONFIG, 0)) == [130.0, 0.0, 0.0, 0.0]
    assert heights(build_fleet(replace(CONFIG, airborne=Airborne.NONE), 0)) == [0.0] * 4
    in_air = heights(build_fleet(replace(CONFIG, airborne=Airborne.ALL), 0))
    assert min(in_air) >= 40.0
    assert len(set(in_air)) == 4


def test_one_without_a_marked_frame_hovers_over_the_origin_and_lands_on_its_pad() -> None:
    frame = LocalFrame(HOME)
    pose = mounted_pose(
        TelemetryReference(HOME.latitude_deg, HOME.longitude_deg, 0, 0), np.zeros(3)
    )
    rig = CameraRig(
        load_camera(demo_site_folder() / "camera-model.txt"),
        frame,
        pose,
        TelemetryReference(HOME.latitude_deg, HOME.longitude_deg, 0.0, 0.0),
    )
    pad = point_from_enu(frame, (80.0, -60.0, 0.0))
    setup = replace(IMAGER, rig=rig, hover_m=110.0)
    config = replace(CONFIG, imagers={IMAGER_SERIAL: setup}, pads={IMAGER_SERIAL: pad})
    app = build_fleet(config, 0)[0]
    motion = app.aircraft.motion
    assert app.settings.home == pad
    assert (motion.north_m, motion.east_m) == pytest.approx((60.0, -80.0), abs=0.1)
    assert motion.height_m == 110.0
    grounded = build_fleet(replace(config, airborne=Airborne.NONE), 0)[0].aircraft.motion
    assert (grounded.north_m, grounded.east_m, grounded.height_m) == (0.0, 0.0, 0.0)


def test_vehicles_start_apart_from_each_other() -> None:
    frame = LocalFrame(HOME)
    places = [enu_from_point(frame, app.settings.home)[:2] for app in build_fleet(CONFIG, 0)]
    for i, a in enumerate(places):
        for b in places[:i]:
            assert np.hypot(*(a - b)) > 24.9


def test_pads_are_kept() -> None:
    pad = GeoPoint(41.901, -93.602, 280.0)
    apps = build_fleet(replace(CONFIG, pads={"SIM-2": pad}), 0)
    assert apps[2].settings.home == pad


def test_biases_differ_are_large_and_can_be_set() -> None:
    drawn = [a.settings.behaviour.altitude_bias_m for a in build_fleet(CONFIG, 0)]
    assert len(set(drawn)) == 4
    assert max(map(abs, drawn)) > 10.0
    fixed = build_fleet(replace(CONFIG, altitude_bias_m=12.5), 0)
    assert {a.settings.behaviour.altitude_bias_m for a in fixed} == {12.5}


def test_the_seed_decides_everything() -> None:
    def first_bytes(seed: int) -> list[bytes]:
        apps = build_fleet(replace(CONFIG, seed=seed), 0)
        for app in apps:
            app.connected(0)
        return [b"".join(app.advance(3_000_000_000)) for app in apps]

    assert first_bytes(1) == first_bytes(1)
    assert first_bytes(1) != first_bytes(2)


def test_wandering_vehicles_fly_rows_until_commanded(flights) -> None:
    apps = build_fleet(replace(CONFIG, wanders=True, airborne=Airborne.ALL), 0)
    assert apps[0].aircraft.motion == flights.fly_on(apps[0].aircraft, 30.0)
    for app in apps[1:]:
        track = list(flights.fly(app.aircraft, 90.0))
        assert max(m.ground_speed_mps for m in track) == pytest.approx(6.0, abs=0.1)
        app.aircraft.hover()
        assert flights.fly_on(app.aircraft, 10.0).ground_speed_mps == pytest.approx(0.0, abs=1e-6)


def test_wandering_vehicles_on_the_ground_take_off_first(flights) -> None:
    app = build_fleet(replace(CONFIG, wanders=True), 0)[1]
    flights.fly_on(app.aircraft, 30.0)
    assert app.aircraft.is_flying


def test_a_fault_of_no_vehicle_is_refused() -> None:
    with pytest.raises(FaultError, match="SIM-IMAGER, SIM-1, SIM-2, SIM-3"):
        build_fleet(replace(CONFIG, faults=(parse_fault("no-ack:SIM-9"),)), 0)


def test_a_fault_reaches_the_vehicle_it_names() -> None:
    apps = build_fleet(replace(CONFIG, faults=(parse_fault("no-ack:2"),)), 0)
    assert [len(app.settings.faults) for app in apps] == [0, 1, 0, 0]
