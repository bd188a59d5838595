"""Attitude: a critical alarm; a site may have an aircraft that tilts too far held."""

from dataclasses import replace

from tests.fleet.reports import core, extended
from tests.station.commanded import CommandedStation
from tests.station.failsafe.reacting import with_cell

from recon.model.command import Hover
from recon.model.failsafe_matrix import Activity, FailsafeCondition, FailsafeMatrix, Reaction
from recon.model.vehicle import Attitude, FlightMode
from recon.safety.failsafe import DEFAULT_MATRIX

MODE = extended(mode=FlightMode.GPS_WAYPOINT)
LEVEL = core(), MODE
TILTED = replace(LEVEL[0], attitude=Attitude(0.0, -50.0, 0.0)), MODE


def tilted(matrix: FailsafeMatrix, seconds: float) -> CommandedStation:
    scene = CommandedStation(matrix).opens(1, *LEVEL).keeps_receiving(1, *LEVEL).passes(1.0)
    return scene.keeps_receiving(1, *TILTED).passes(seconds)


def test_by_default_it_is_an_alarm() -> None:
    scene = tilted(DEFAULT_MATRIX, 10.0)
    assert "attitude" in scene.alarms()
    assert scene.handed == []


def test_a_site_may_have_it_held() -> None:
    matrix = with_cell(FailsafeCondition.ATTITUDE, Activity.MISSION, Reaction.HOLD, 2.0)
    assert tilted(matrix, 1.9).bodies() == []
    assert tilted(matrix, 2.4).bodies() == [Hover()]
