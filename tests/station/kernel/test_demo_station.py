"""The demonstration's station raises no alarm, and its survey regions can be flown."""

from dataclasses import replace

import pytest
from tests.sim.test_demo_flights import config
from tests.station.station_world import World

from recon.geo import point_from_enu
from recon.model.airspace import Region
from recon.model.command import FlyMission, Phase
from recon.model.mission import Mission, Waypoint
from recon.sim.fleet import IMAGER_SERIAL, build_fleet
from recon.site import Site, demo_site_folder, load_site
from recon.station.kernel.build import first_state
from recon.station.kernel.virtual import VirtualDriver


def demonstration(site: Site, seed: int, vehicle_count: int, wanders: bool) -> World:
    """Return the station of a site with the demonstration's fleet in the air, and no pictures."""
    base = config(site, seed, vehicle_count)
    imager = base.imagers[IMAGER_SERIAL]
    silent = replace(imager, feed=replace(imager.feed, starts_on=False))
    world = World(VirtualDriver(first_state(site), keeps_log=False))
    for app in build_fleet(replace(base, imagers={IMAGER_SERIAL: silent}, wanders=wanders), 0):
        world.connect(app)
    return world


def around(site: Site, region: Region, height_m: float) -> Mission:
    assert site.frame is not None
    points = [point_from_enu(site.frame, (*corner, 0.0)) for corner in region.outline_m]
    return Mission(tuple(Waypoint(p.latitude_deg, p.longitude_deg, height_m, 6.0) for p in points))


@pytest.mark.parametrize(("seed", "vehicle_count"), [(1, 4), (2, 8)])
def test_it_flies_without_an_alarm(seed: int, vehicle_count: int) -> None:
    world = demonstration(load_site(demo_site_folder()), seed, vehicle_count, wanders=True)
    for _ in range(60):
        world.run_for(1.0)
        alarms = world.driver.station.alarms.alarms.values()
        assert [alarm.condition.text for alarm in alarms] == []
    assert len(world.driver.station.fleet.vehicles) == vehicle_count
    assert world.driver.station.orders.records == {}


def test_a_mission_around_each_survey_region_is_approved_and_flown() -> None:
    site = load_site(demo_site_folder())
    world = demonstration(site, 1, 4, wanders=False)
    world.run_for(3.0)
    flights = zip(
        ("SIM-1", "SIM-2"), (50.0, 60.0), site.layers.survey_regions.values(), strict=True
    )
    orders = [
        world.order(serial, FlyMission(around(site, region, height_m)))
        for serial, height_m, region in flights
    ]
    assert [world.record(order).note for order in orders] == ["", ""]
    assert world.run_until(
        lambda: all(world.record(order).phase is Phase.STARTED for order in orders), 20.0
    )
    world.run_for(60.0)
    assert world.driver.station.alarms.alarms == {}
