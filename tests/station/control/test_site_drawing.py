"""A fence never changes under a flight; on the ground a drawing is in force with the next step."""

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from tests.replay.record_flight import recording
from tests.station.station_world import World, from_the_ground, square_mission, world

from recon.model.airspace import LandingPad, Region, SiteLayer, Zone, ZoneKind
from recon.model.command import FlyMission, Phase, Refusal
from recon.model.event import SiteRedrawn, ZoneDrawn
from recon.model.geo import GeoPoint, LatLon
from recon.model.temporary_zone import Circle, DrawnZone, TemporaryZoneKind
from recon.model.units import seconds_to_ns
from recon.model.vehicle import AltitudeReference
from recon.sim.fleet import Airborne
from recon.site import Site
from recon.station.audit.entries import Auditing, audit
from recon.station.control import site_drawing
from recon.station.recording.replay import check

SMALL = Region(np.array([(-60.0, -60.0), (60.0, -60.0), (60.0, 60.0), (-60.0, 60.0)]))
FARMYARD = Zone("farmyard", ZoneKind.KEEP_OUT, SMALL)
ELSEWHERE = GeoPoint(41.9005, -93.6, 275.0)


def drawn(
    here: World,
    *,
    boundary: Region | None = None,
    zones: tuple[Zone, ...] = (),
    pad: GeoPoint | None = None,
    **vehicle: Any,
) -> SiteRedrawn:
    known = here.driver.station.airspace.airspace.boundary
    profiles = dict(here.driver.station.fleet.profiles)
    if pad is not None:
        profiles["SIM-1"] = replace(profiles["SIM-1"], pad=pad)
    profiles["SIM-1"] = replace(profiles["SIM-1"], **vehicle)
    layers = (SiteLayer.BOUNDARY,)
    return SiteRedrawn(boundary or known, zones, _pads(here), profiles, layers, "anna")


def _pads(here: World) -> tuple[LandingPad, ...]:
    return here.driver.station.airspace.airspace.landing_pads


def flight(here: World) -> FlyMission:
    return FlyMission(from_the_ground(here.vehicle("SIM-1"), square_mission()))


def refusal(here: World, event: SiteRedrawn) -> Refusal | None:
    driver = here.driver
    return site_drawing.refusal(driver.station, event, driver.now_ns)


def test_in_flight_the_fence_stays_whether_larger_or_smaller() -> None:
    here = world()
    here.run_for(2.0)
    before = here.driver.station
    for event in (drawn(here, boundary=SMALL), drawn(here, zones=(FARMYARD,))):
        refused = refusal(here, event)
        assert refused is not None
        assert "SIM-1" in refused.reason
        assert "temporary zone" in refused.reason
        here.driver.handle(event)
        assert here.driver.station.airspace is before.airspace
    # Regions to survey limit nothing.
    assert refusal(here, drawn(here)) is None


def test_on_the_ground_it_is_in_force_with_the_same_step() -> None:
    here = world(airborne=Airborne.NONE)
    here.run_for(2.0)
    zone = DrawnZone(
        TemporaryZoneKind.PERSON, Circle(LatLon(41.91, -93.6), 10.0), "checks a sprinkler"
    )
    here.driver.handle(ZoneDrawn(zone, "anna"))
    changes = here.driver.station.temporary_zones.changes
    here.driver.handle(drawn(here, boundary=SMALL, zones=(FARMYARD,), pad=ELSEWHERE))
    after = here.driver.station
    assert after.airspace.airspace.boundary is SMALL
    names = [each.zone.name for each in after.airspace.zones]
    assert names == ["farmyard", "person 1 (temporary)"]
    assert len(after.airspace.temporary_zones) == 1
    assert after.temporary_zones.changes == changes + 1
    profile = after.fleet.vehicles["SIM-1"].profile
    assert profile is after.fleet.profiles["SIM-1"]
    assert profile is not None
    assert profile.pad == ELSEWHERE
    order = here.order("SIM-1", flight(here), takeoff=True)
    assert here.record(order).phase is Phase.REFUSED_BY_STATION
    assert "beyond the site's boundary" in here.record(order).note


def test_a_takeoff_that_telemetry_does_not_show_yet_counts_as_a_flight() -> None:
    here = world(airborne=Airborne.NONE)
    here.run_for(2.0)
    order = here.order("SIM-1", flight(here), takeoff=True)
    assert here.record(order).phase is Phase.SENT
    event = drawn(here, boundary=SMALL)
    assert refusal(here, event) is not None
    # An app may take longer to start it than a prediction assumes.
    station, now_ns = here.driver.station, here.driver.now_ns
    late_ns = seconds_to_ns(station.settings.takeoff_stop_s)
    assert site_drawing.refusal(station, event, now_ns + late_ns - 10**9) is not None
    assert site_drawing.refusal(station, event, now_ns + late_ns + 10**9) is None


def test_a_replay_gives_the_same_fence(tmp_path: Path) -> None:
    here = world(airborne=Airborne.NONE, keeps_log=False)
    with recording(here.driver, Site("test"), tmp_path) as record:
        here.run_for(2.0)
        here.driver.handle(drawn(here, boundary=SMALL, zones=(FARMYARD,), pad=ELSEWHERE))
        order = here.order("SIM-1", flight(here), takeoff=True)
        here.run_for(0.5)
    assert here.record(order).phase is Phase.REFUSED_BY_STATION
    found = check(record.path)
    assert (found.differences, found.trouble) == ([], "")


def test_the_audit_has_what_was_drawn_and_what_was_refused() -> None:
    for airborne, kind in ((Airborne.NONE, "site.redrawn"), (Airborne.ALL, "site.refused")):
        here = world(airborne=airborne)
        here.run_for(2.0)
        before, now_ns = here.driver.station, here.driver.now_ns
        event = drawn(here, zones=(FARMYARD,))
        here.driver.handle(event)
        _, entries = audit(Auditing(), before, event, here.driver.station, now_ns)
        (entry,) = [each for each in entries if each.kind.startswith("site.")]
        assert (entry.kind, entry.by) == (kind, "anna")


WGS84 = AltitudeReference.WGS84


@pytest.mark.parametrize("change", [{"waypoint_altitude": WGS84}, {"number": 9}])
def test_altitude_reference_and_number_do_not_change_in_flight(change: dict[str, Any]) -> None:
    here = world(2)
    here.run_for(2.0)
    before = here.driver.station.fleet
    event = drawn(here, **change)
    refused = refusal(here, event)
    assert refused is not None
    assert refused.reason == (
        "A vehicle's altitude reference and number change, and it is added or removed, only while "
        "it is on the ground. In the air, or not known to be on the ground: SIM-1. Land first; "
        "name and camera can be changed now"
    )
    here.driver.handle(event)
    assert here.driver.station.fleet.profiles is before.profiles
    removed = replace(event, profiles={"SIM-2": before.profiles["SIM-2"]})
    assert refusal(here, removed) is not None


def test_name_and_camera_change_in_flight() -> None:
    here = world()
    here.run_for(2.0)
    event = drawn(here, name="Alder", camera="mini3pro")
    assert refusal(here, event) is None
    here.driver.handle(event)
    vehicle = here.vehicle("SIM-1")
    assert (vehicle.display_name, vehicle.profile) == ("Alder", event.profiles["SIM-1"])


def test_a_vehicle_whose_telemetry_is_lost_counts_as_flying() -> None:
    here = world()
    here.run_for(2.0)
    event = drawn(here, waypoint_altitude=WGS84)
    station, later_ns = here.driver.station, here.driver.now_ns + seconds_to_ns(600.0)
    assert site_drawing.refusal(station, event, later_ns) is not None


def test_on_the_ground_the_next_mission_is_flown_by_the_new_reference() -> None:
    here = world(airborne=Airborne.NONE)
    here.run_for(2.0)
    unset = drawn(here, waypoint_altitude=AltitudeReference.UNSET)
    here.driver.handle(unset)
    order = here.order("SIM-1", flight(here), takeoff=True)
    assert here.record(order).phase is Phase.REFUSED_BY_STATION
    here.driver.handle(drawn(here, waypoint_altitude=AltitudeReference.TAKEOFF))
    order = here.order("SIM-1", flight(here), takeoff=True)
    assert here.record(order).phase is Phase.SENT
    # From here on it may be taking off.
    assert refusal(here, drawn(here, waypoint_altitude=WGS84)) is not None


def test_the_audit_has_each_changed_vehicle() -> None:
    here = world(airborne=Airborne.NONE)
    here.run_for(2.0)
    event = replace(drawn(here, waypoint_altitude=WGS84), layers=())
    entry = site_drawing.entry(here.driver.station, event, here.driver.now_ns)
    assert entry.text == "site edited: vehicles; SIM-1 altitude reference takeoff -> wgs84"
