"""Separation: the watchdog holds, in its own time; a cell decides whether it may."""

from dataclasses import replace

from tests.station.commanded import CommandedStation
from tests.station.failsafe.reacting import with_cell
from tests.station.traffic.test_watchdog_runner import Two

from recon.model.event import SeparationHoldSwitched
from recon.model.failsafe_matrix import Activity, FailsafeCondition, FailsafeMatrix, Reaction
from recon.safety.failsafe import DEFAULT_MATRIX


def meeting(matrix: FailsafeMatrix) -> Two:
    two = Two(120.0)
    settings = CommandedStation(matrix).station.settings
    two.scene.station = replace(two.scene.station, settings=settings)
    return two


def test_by_default_it_holds() -> None:
    two = meeting(DEFAULT_MATRIX).passes(6.0)
    assert ("B", "station: separation") in two.holds()


def test_a_site_may_leave_it_to_the_alarm_by_what_the_vehicle_does() -> None:
    condition = FailsafeCondition.SEPARATION
    two = meeting(with_cell(condition, Activity.HOLDING, Reaction.ALARM)).passes(6.0)
    assert two.holds() == []
    assert "separation" in two.scene.alarms()
    two = meeting(with_cell(condition, Activity.MISSION, Reaction.ALARM)).passes(6.0)
    assert two.holds() != [], "they fly no mission"


def test_the_switch_for_all_holds_stays() -> None:
    two = meeting(DEFAULT_MATRIX)
    two.scene.happens(SeparationHoldSwitched(is_on=False, by="Ann"))
    two.passes(6.0)
    assert two.holds() == []
