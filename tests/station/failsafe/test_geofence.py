"""Geofence: the watchdog holds what is about to leave; a cell decides whether it may."""

from dataclasses import replace

import numpy as np
from tests.station.failsafe.reacting import A, alarm_text, in_mission, with_cell
from tests.station.station_world import World

from recon.geo import enu_from_point
from recon.model.airspace import Region
from recon.model.failsafe_matrix import Activity, FailsafeCondition, FailsafeMatrix, Reaction
from recon.model.geo import GeoPoint
from recon.safety import PreparedAirspace
from recon.safety.failsafe import DEFAULT_MATRIX


def before_a_fence(matrix: FailsafeMatrix) -> World:
    """A vehicle in a mission, and a boundary drawn 40 m round it after it was approved."""
    w = in_mission(matrix=matrix)
    w.run_for(20.0)
    station = w.driver.station
    airspace = station.airspace.airspace
    position = w.vehicle(A).position.value
    assert airspace.frame is not None
    assert position is not None
    here_m = enu_from_point(
        airspace.frame, GeoPoint(position.latitude_deg, position.longitude_deg, 275.0)
    )[:2]
    corners = np.array([(-40.0, -40.0), (40.0, -40.0), (40.0, 40.0), (-40.0, 40.0)])
    near = replace(airspace, boundary=Region(here_m + corners))
    w.driver.station = replace(station, airspace=PreparedAirspace(near))
    w.run_for(18.0)
    return w


def fence_holds(w: World) -> list[str | None]:
    records = w.driver.station.orders.records.values()
    own = [r.command for r in records if r.command.issued_by == "station: fence_ahead"]
    return [command.serial for command in own]


def test_by_default_it_is_held_before_the_fence() -> None:
    w = before_a_fence(DEFAULT_MATRIX)
    assert fence_holds(w) == [A]
    assert "outside" not in alarm_text(w, "fence_ahead")


def test_a_site_may_leave_it_to_the_alarm() -> None:
    fence = FailsafeCondition.GEOFENCE
    w = before_a_fence(with_cell(fence, Activity.MISSION, Reaction.ALARM))
    assert fence_holds(w) == []
    assert "outside the site's boundary" in alarm_text(w, "fence_ahead")
    assert fence_holds(before_a_fence(with_cell(fence, Activity.HOLDING, Reaction.ALARM))) == [A]
