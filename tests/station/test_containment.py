"""A fault in the station's own code costs as little as can be, and is seen."""

from collections.abc import Callable, Iterable
from dataclasses import replace

import pytest
from tests.link.approved import core, extended
from tests.station.commanded import Told, flying
from tests.station.test_service import Bench

from recon.model.command import Hover
from recon.model.event import AlarmAcknowledged, LinkOpened, StationFaulted, Tick
from recon.model.units import NS_PER_S
from recon.safety.rules import RULES
from recon.safety.watchdogs import WATCHDOGS, Finding, Picture
from recon.station import containment, step
from recon.station.alarms import Alarm, Severity
from recon.station.containment import after_fault, contained
from recon.station.outputs import CloseLink, Output
from recon.station.state import Station

FAULT = ZeroDivisionError("division by zero")


def failing(*_: object, **__: object) -> None:
    raise FAULT


def fault_alarms(station: Station) -> list[Alarm]:
    return [a for a in station.alarms.alarms.values() if a.condition.rule == "station_fault"]


@pytest.fixture
def bench(monkeypatch: pytest.MonkeyPatch) -> Bench:
    """A driver with one vehicle in the air, whose faults are contained as in a real run."""
    monkeypatch.setattr("recon.station.driver.after_fault", after_fault)
    made = Bench()
    made.open(1, extended(b"A"), core())
    return made


class TestATick:
    @pytest.mark.parametrize("broken", step.TICK_PARTS)
    def test_one_part_that_fails_leaves_the_others_their_work(
        self, broken: str, monkeypatch: pytest.MonkeyPatch
    ) -> None:
        called: list[str] = []

        def part(name: str) -> Callable[[Station, int], tuple[Station, tuple[Output, ...]]]:
            def run(station: Station, _now_ns: int) -> tuple[Station, tuple[Output, ...]]:
                if name == broken:
                    raise FAULT
                called.append(name)
                return station, (CloseLink(len(called), name),)

            return run

        parts = {name: part(name) for name in step.TICK_PARTS}
        monkeypatch.setattr(containment, "TICK_PARTS", parts)
        station, outputs = after_fault(Station(), Tick(), FAULT, 0)
        assert called == [name for name in parts if name != broken]
        assert len(outputs) == len(parts) - 1
        (alarm,) = fault_alarms(station)
        assert broken in alarm.condition.text
        assert alarm.condition.severity is Severity.CRITICAL
        assert "ZeroDivisionError: division by zero (test_containment.py:" in alarm.condition.text

    def test_a_blind_watchdog_is_an_alarm_and_the_others_look_on(
        self, monkeypatch: pytest.MonkeyPatch
    ) -> None:
        """The vehicle falls silent: the watch on links still tells it."""
        told = flying()
        watchdogs = (contained(failing), *(contained(dog) for dog in WATCHDOGS))  # type: ignore[arg-type]
        monkeypatch.setattr(containment, "CONTAINED", watchdogs)
        for _ in range(45):
            told.now_ns += NS_PER_S // 10
            told.station, _ = after_fault(told.station, Tick(), FAULT, told.now_ns)
        rules = told.alarms()
        assert {"station_fault", "link_lost"} <= rules
        (blind,) = fault_alarms(told.station)
        assert "the watchdog failing sees nothing" in blind.condition.text

    def test_a_watchdog_that_sees_is_left_as_it_is(self) -> None:
        finding = Finding("k", "r", Severity.INFO, "A", "text")

        def sees(_picture: Picture) -> Iterable[Finding]:
            yield finding

        picture: Picture = None  # type: ignore[assignment]
        assert tuple(contained(sees)(picture)) == (finding,)


class TestAnEvent:
    def test_a_step_that_fails_costs_its_event_alone(
        self, bench: Bench, monkeypatch: pytest.MonkeyPatch
    ) -> None:
        before = bench.driver.station
        with monkeypatch.context() as patched:
            patched.setattr("recon.station.step.fleet_step.step", failing)
            bench.driver.handle(LinkOpened(2, "10.0.0.2:5"))
        station = bench.driver.station
        assert replace(station, alarms=before.alarms) == before
        (alarm,) = fault_alarms(station)
        assert "taking in LinkOpened" in alarm.condition.text
        bench.driver.handle(LinkOpened(3, "10.0.0.3:5"))
        assert set(bench.driver.station.fleet.links) == {1, 3}

    def test_it_is_raised_again_when_it_comes_again_after_a_person_saw_it(self) -> None:
        told = Told()
        for _ in range(3):
            told.happens(StationFaulted("thinking", "a fault"))
        (first,) = fault_alarms(told.station)
        told.happens(AlarmAcknowledged(first.id, "Ann"))
        assert fault_alarms(told.station) == []
        told.happens(StationFaulted("thinking", "a fault"))
        (again,) = fault_alarms(told.station)
        assert again.id != first.id

    def test_an_order_that_was_never_judged_is_answered_as_refused(
        self, bench: Bench, monkeypatch: pytest.MonkeyPatch
    ) -> None:
        monkeypatch.setattr("recon.station.step.commanding.place", failing)
        (result,) = bench.service.all_stop("test").results
        assert (result.accepted, result.rule, result.serial) == (False, "station_fault", "A")
        assert fault_alarms(bench.driver.station)


class TestTheDriver:
    def test_an_output_that_fails_does_not_keep_the_next_from_going_out(
        self, bench: Bench, monkeypatch: pytest.MonkeyPatch
    ) -> None:
        closed: list[int] = []

        class Links:
            def close_link(self, link_id: int, _reason: str) -> None:
                if link_id == 1:
                    raise FAULT
                closed.append(link_id)

        def both(station: Station, *_: object) -> tuple[Station, tuple[Output, ...]]:
            return station, (CloseLink(1, "x"), CloseLink(2, "x"))

        bench.driver.links = Links()  # type: ignore[assignment]
        with monkeypatch.context() as patched:
            patched.setattr("recon.station.step._tick", both)
            bench.driver.handle(Tick())
        assert closed == [2]
        (alarm,) = fault_alarms(bench.driver.station)
        assert "carrying out CloseLink" in alarm.condition.text

    def test_an_audit_that_fails_at_everything_ends_in_one_alarm(
        self, bench: Bench, monkeypatch: pytest.MonkeyPatch
    ) -> None:
        """Telling of its fault fails too: that must not go round for ever."""
        monkeypatch.setattr(bench.driver, "_observe", failing)
        bench.driver.handle(Tick())
        bench.driver.handle(Tick())
        (alarm,) = fault_alarms(bench.driver.station)
        assert "writing the audit" in alarm.condition.text


def test_a_stop_goes_out_though_every_rule_fails(monkeypatch: pytest.MonkeyPatch) -> None:
    told = flying()
    monkeypatch.setattr("recon.safety.gate.RULES", tuple(failing for _ in RULES))
    told.order(Hover())
    assert told.bodies() == [Hover()]
