"""A survey of which one vehicle falls: the others image its rows once its place is known."""

import pytest
from tests.station.surveyed_world import asked, surveyed_world

from recon.model.event import HazardDismissed
from recon.model.survey import SurveyPhase, WhenDone


@pytest.mark.flight
def test_the_other_flies_the_rows_of_a_fallen_vehicle() -> None:
    w = surveyed_world(2, faults=("falls-silent:SIM-2:30",))
    w.asks(asked(when_done=WhenDone.HOVER))
    w.starts("SIM-1", "SIM-2")
    w.runs(60.0)
    # The fallen vehicle may be anywhere near: the other is held out of its hazard area.
    assert ("separation", "SIM-1") in w.fleet.alarms()
    stopped = w.record().members["SIM-1"].stop_reason or ""
    assert stopped.startswith("mission stopped: hover, ordered by station: ")
    imaged_m2 = w.figures().region_m2 - w.figures().not_yet_m2
    w.driver.handle(HazardDismissed("SIM-2", "ann"))
    w.runs(60.0)
    assert w.figures().region_m2 - w.figures().not_yet_m2 == imaged_m2, "held until started again"
    w.starts("SIM-1")
    assert w.runs_until(SurveyPhase.DONE, 600.0)
    assert w.figures().not_yet_m2 < 0.01 * w.figures().region_m2
    flown_by = {order.command.serial for order in w.missions() if order.command.id < -2}
    assert flown_by == {"SIM-1"}
