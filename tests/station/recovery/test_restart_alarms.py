"""A restart with many vehicles in flight: one alarm for all, and no vehicle is held."""

import pytest
from tests.examples import family
from tests.station.recovery.restarts import restart, saved
from tests.station.station_world import World, world

from recon.station.state.alarm_book import Alarm

GONE_S = 4.0
LATEST_S = 8.0
"""The last app comes back this long after the start."""


def restarted(count: int, missing: frozenset[str] = frozenset()) -> World:
    """Vehicles in the air whose station ends without a word; one app after the other returns."""
    here = world(count, keeps_log=False)
    here.run_for(6.0)
    assert not any(alarm.is_active for alarm in alarms(here))
    snapshot = saved(here.driver.station, here.driver.now_ns)
    apps = [connected.app for connected in here.connected.values()]
    for connected in tuple(here.connected.values()):
        here.driver.disconnect(connected.link_id)
        connected.app.disconnected()
    here.connected.clear()
    here.run_for(GONE_S)
    here.driver.station = restart(here, snapshot)
    restored = [c for c in here.driver.station.controls.values() if c.restored is not None]
    assert len(restored) == count
    for app in apps:
        here.run_for(LATEST_S / count)
        if app.settings.serial not in missing:
            here.connect(app)
    return here


def alarms(here: World) -> list[Alarm]:
    return list(here.driver.station.alarms.alarms.values())


@pytest.mark.parametrize("count", family(8, 64))
def test_all_come_back_to_one_alarm_that_ends_by_itself_and_no_order(count: int) -> None:
    here = restarted(count)
    here.run_for(4.0)
    (waits,) = alarms(here)
    assert (waits.condition.rule, waits.is_active) == ("restart_waits", False)
    assert here.driver.station.orders.records == {}


def test_the_one_alarm_names_whom_it_waits_for() -> None:
    here = restarted(10, frozenset({"SIM-1", "SIM-4"}))
    (waits,) = alarms(here)
    assert waits.is_active
    named = waits.condition.text.partition("telemetry of ")[2].partition(", in flight")[0]
    assert sorted(named.split(", ")) == ["SIM-1", "SIM-10", "SIM-4"]


def test_one_that_does_not_come_back_is_an_alarm_of_its_own_then_and_a_hazard_at_once() -> None:
    here = restarted(8, frozenset({"SIM-3"}))
    assert {alarm.condition.rule for alarm in alarms(here)} == {"restart_waits"}
    here.run_for(4.0)
    active = [alarm.condition for alarm in alarms(here) if alarm.is_active]
    assert {(c.rule, c.serial) for c in active if c.rule == "link_lost"} == {("link_lost", "SIM-3")}
    assert any("the hazard area of SIM-3" in c.text for c in active if c.rule == "separation")
