"""What `recon demo` flies is legal at the demonstration's site, whatever the seed."""

from itertools import combinations

import numpy as np
import pytest
from tests.examples import family

from recon.geo import Polygon, enu_from_points
from recon.model.airspace import ZoneKind
from recon.model.units import NS_PER_S
from recon.sim.app.camera_feed import FeedSettings
from recon.sim.camera.rig import CameraRig
from recon.sim.fleet import IMAGER_SERIAL, Airborne, ImagerSetup, SimulationConfig, build_fleet
from recon.site import Site, demo_site_folder, load_site

SIMULATED_S = 600


class NoPictures:
    """A camera whose frames are never requested."""

    rows, cols = 2, 2

    def prepare(self) -> None:
        raise AssertionError("no picture is rendered here")


def config(site: Site, seed: int, vehicle_count: int) -> SimulationConfig:
    imager = site.imager
    assert imager is not None
    assert imager.marked_frame is not None
    assert site.frame is not None
    rig = CameraRig(imager.camera, site.frame, imager.marked_pose, imager.marked_frame)
    return SimulationConfig(
        home=site.frame.origin,
        vehicle_count=vehicle_count,
        imagers={IMAGER_SERIAL: ImagerSetup(NoPictures(), FeedSettings(1.0), rig)},
        airborne=Airborne.ALL,
        wanders=True,
        endurance_s=36_000.0,
        seed=seed,
        pads={s: p.pad for s, p in site.profiles.items() if p.pad is not None},
    )


def flown_m(site: Site, seed: int, vehicle_count: int) -> np.ndarray:
    """Return east, north, up of each vehicle at each second, (seconds, vehicles, 3)."""
    apps = build_fleet(config(site, seed, vehicle_count), 0)
    homes = enu_from_points(site.frame, [app.settings.home for app in apps])
    track = np.empty((SIMULATED_S, len(apps), 3))
    for second in range(SIMULATED_S):
        for index, app in enumerate(apps):
            app.aircraft.advance(second * NS_PER_S)
            motion = app.aircraft.motion
            track[second, index] = homes[index] + (motion.east_m, motion.north_m, motion.height_m)
    return track


@pytest.mark.parametrize("seed", family(*range(5)))
@pytest.mark.parametrize("vehicle_count", [4, 8])
def test_wandering_vehicles_stay_inside_fences_and_apart(seed: int, vehicle_count: int) -> None:
    site = load_site(demo_site_folder())
    track = flown_m(site, seed, vehicle_count)
    places, up_m = track[..., :2].reshape(-1, 2), track[..., 2]
    assert site.layers.boundary is not None
    boundary = Polygon(site.layers.boundary)
    assert boundary.distance_to_edge_m(places).min() > site.limits.boundary_margin_m
    for zone in site.layers.zones:
        away_m = -Polygon(zone.region).distance_to_edge_m(places)
        if zone.kind is ZoneKind.KEEP_OUT:
            assert away_m.min() > site.limits.boundary_margin_m
        else:
            assert zone.floor_m is not None
            assert up_m.ravel()[away_m < 0.0].min(initial=np.inf) > zone.floor_m
    assert up_m.max() < site.limits.max_height_above_ground_m
    assert up_m.min() > site.limits.min_height_above_ground_m
    for one, other in combinations(range(track.shape[1]), 2):
        level_m = np.linalg.norm(track[:, one, :2] - track[:, other, :2], axis=1)
        apart_m = np.abs(up_m[:, one] - up_m[:, other])
        is_apart = level_m > site.limits.min_separation_horizontal_m
        assert (is_apart | (apart_m > site.limits.min_separation_vertical_m)).all()
    assert np.ptp(track[:, 1:, :2], axis=0).min() > 50.0
