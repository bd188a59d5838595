"""A mission that begins after the stop that was to prevent it is stopped again."""

import pytest
from tests.fleet.reports import core, extended
from tests.safety.cases import mission
from tests.station.commanded import CommandedStation

from recon.model.command import Body, Hover, LandNow, Phase
from recon.model.vehicle import FlightMode

STANDING = (core(height_m=30.0), extended(mode=FlightMode.GPS_ATTI))
LANDING = (
    core(height_m=30.0, velocity=(0.0, 0.0, 1.0)),
    extended(mode=FlightMode.AUTO_LANDING),
)
MISSION = (
    core(height_m=30.0, velocity=(5.0, 0.0, 0.0)),
    extended(mode=FlightMode.GPS_WAYPOINT),
)


def standing() -> CommandedStation:
    """One vehicle that hovers."""
    return CommandedStation().opens(1, *STANDING).keeps_receiving(1, *STANDING).passes(0.5)


def stopped_before_its_mission(stop: Body, shown: tuple[object, ...]) -> CommandedStation:
    """A mission was sent, and a second later a stop; telemetry shows the stop only."""
    scene = standing()
    scene.order(mission())
    number = scene.passes(1.0).order(stop)
    scene.keeps_receiving(1, *shown).passes(2.0)  # type: ignore[arg-type]
    assert scene.phase(number) in (Phase.CONFIRMED, Phase.DONE)
    return scene


def again(scene: CommandedStation) -> list[Body]:
    """The orders that the station gave automatically."""
    return [
        record.command.body
        for record in scene.station.orders.records.values()
        if record.command.issued_by.startswith("station: the mission of order 1 began after")
    ]


@pytest.mark.parametrize(("stop", "shown"), [(Hover(), STANDING), (LandNow(), LANDING)])
def test_the_same_stop_goes_out_again_at_once(stop: Body, shown: tuple[object, ...]) -> None:
    scene = stopped_before_its_mission(stop, shown)
    scene.keeps_receiving(1, *MISSION).passes(0.2)
    assert again(scene) == [stop]
    newest = min(scene.station.orders.records)
    assert len(scene.times_s(newest)) == 1
    scene.passes(3.0)
    assert "pilot_took_over" not in scene.alarms()
    assert len(scene.times_s(newest)) == 4
    assert again(scene) == [stop]


def test_obeyed_it_is_confirmed_and_a_second_start_is_stopped_too() -> None:
    scene = stopped_before_its_mission(Hover(), STANDING)
    scene.keeps_receiving(1, *MISSION).passes(0.2)
    scene.keeps_receiving(1, *STANDING).passes(2.0)
    assert scene.phase(min(scene.station.orders.records)) is Phase.DONE
    scene.keeps_receiving(1, *MISSION).passes(0.2)
    assert again(scene) == [Hover(), Hover()]


def test_half_a_minute_after_the_mission_was_sent_nothing_is_sent() -> None:
    scene = stopped_before_its_mission(Hover(), STANDING)
    scene.passes(28.0).keeps_receiving(1, *MISSION).passes(3.0)
    assert again(scene) == []
    assert "mission_resumed" in scene.alarms()


def test_a_mission_that_was_flown_before_the_stop_is_none_that_starts_late() -> None:
    scene = standing()
    scene.order(mission())
    scene.keeps_receiving(1, *MISSION).passes(1.0)
    scene.order(Hover())
    scene.keeps_receiving(1, *STANDING).passes(2.0)
    scene.keeps_receiving(1, *MISSION).passes(3.0)
    assert again(scene) == []
    assert "mission_resumed" in scene.alarms()
