"""Strong wind: an alarm; a site may recall vehicles when it lasts."""

from dataclasses import replace

from tests.fleet.reports import core, extended
from tests.station.commanded import CommandedStation
from tests.station.failsafe.reacting import with_cell

from recon.model.command import Body, ReturnHome
from recon.model.failsafe_matrix import Activity, FailsafeCondition, FailsafeMatrix, Reaction
from recon.safety.failsafe import DEFAULT_MATRIX

CALM = core(), extended()
WINDY = core(), replace(extended(), wind_level=2)


def in_wind(matrix: FailsafeMatrix, seconds: float) -> list[Body]:
    """What is ordered to a hovering vehicle in so many seconds of strong wind."""
    scene = CommandedStation(matrix).opens(1, *CALM).keeps_receiving(1, *CALM).passes(1.0)
    scene.keeps_receiving(1, *WINDY).passes(seconds)
    assert "strong_wind" in scene.alarms()
    return scene.bodies()


def test_by_default_it_is_an_alarm() -> None:
    assert in_wind(DEFAULT_MATRIX, 120.0) == []


def test_a_site_may_call_home_what_stays_in_it() -> None:
    matrix = with_cell(FailsafeCondition.WIND, Activity.HOLDING, Reaction.RETURN, 30.0)
    assert in_wind(matrix, 29.5) == []
    assert in_wind(matrix, 30.6) == [ReturnHome()]
