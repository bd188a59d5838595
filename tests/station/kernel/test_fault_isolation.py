"""A fault in the station's own code costs as little as can be, and is seen."""

from collections.abc import Callable, Iterable
from dataclasses import replace

import pytest
from tests.link.approved import core, extended
from tests.persons import ANN
from tests.station.api_views.test_service import Bench
from tests.station.commanded import CommandedStation, flying
from tests.station.steered_world import steered

from recon import wire
from recon.model.command import Hover, Phase
from recon.model.event import (
    AlarmAcknowledged,
    Event,
    LinkOpened,
    OperatorOrder,
    StationFaulted,
    Tick,
)
from recon.model.units import NS_PER_S
from recon.safety.rules import RULES
from recon.safety.watchdogs import WATCHDOGS, Finding, TrafficPicture
from recon.station.alarms.conditions import raise_alarms
from recon.station.control import order_gateway
from recon.station.control.order_gateway import Stepped
from recon.station.kernel import fault_isolation, step
from recon.station.kernel.fault_isolation import TickPart, after_fault, isolated
from recon.station.state.alarm_book import Alarm, Severity
from recon.station.state.orders import OrderRecord
from recon.station.state.station import Station
from recon.station.state.steps import CloseLink, Output, SendCommand
from recon.vehicles.reports import to_report

FAULT = ZeroDivisionError("division by zero")


def failing(*_: object, **__: object) -> None:
    raise FAULT


def fault_alarms(station: Station) -> list[Alarm]:
    """The alarms after the next tick."""
    station, _ = raise_alarms(station, NS_PER_S)
    return [a for a in station.alarms.alarms.values() if a.condition.rule == "station_fault"]


def isolated_step(station: Station, event: Event, now_ns: int) -> Stepped:
    """Step as the driver of a real run does."""
    try:
        return step.step(station, event, now_ns)
    except Exception as fault:
        return after_fault(step.TICK_PARTS, station, event, fault, now_ns)


def faulted_tick(scene: CommandedStation) -> Stepped:
    return after_fault(step.TICK_PARTS, scene.station, Tick(), FAULT, scene.now_ns)


@pytest.fixture
def bench(monkeypatch: pytest.MonkeyPatch) -> Bench:
    """A driver with one vehicle in the air, whose faults are isolated as in a real run."""
    monkeypatch.setattr("recon.station.kernel.driver.after_fault", after_fault)
    made = Bench()
    made.open(1, extended(b"A"), core())
    return made


class TestATick:
    @pytest.mark.parametrize("broken", [part.name for part in step.TICK_PARTS])
    def test_one_part_that_fails_leaves_the_others_running(self, broken: str) -> None:
        called: list[str] = []

        def part(name: str) -> Callable[[Station, int], tuple[Station, tuple[Output, ...]]]:
            def run(station: Station, _now_ns: int) -> tuple[Station, tuple[Output, ...]]:
                if name == broken:
                    raise FAULT
                called.append(name)
                return station, (CloseLink(len(called), name),)

            return run

        parts = [TickPart(each.name, part(each.name)) for each in step.TICK_PARTS]
        station, outputs = after_fault(parts, Station(), Tick(), FAULT, 0)
        assert called == [each.name for each in parts if each.name != broken]
        assert len(outputs) == len(parts) - 1
        (alarm,) = fault_alarms(station)
        assert broken in alarm.condition.text
        assert alarm.condition.severity is Severity.CRITICAL
        assert (
            "ZeroDivisionError: division by zero (test_fault_isolation.py:" in alarm.condition.text
        )

    def test_a_watchdog_that_fails_is_an_alarm_and_the_others_run(
        self, monkeypatch: pytest.MonkeyPatch
    ) -> None:
        """The vehicle falls silent: the link watchdog still finds it."""
        scene = flying()
        watchdogs = (isolated(failing), *(isolated(dog) for dog in WATCHDOGS))  # type: ignore[arg-type]
        monkeypatch.setattr(fault_isolation, "ISOLATED_WATCHDOGS", watchdogs)
        for _ in range(45):
            scene.now_ns += NS_PER_S // 10
            scene.station, _ = after_fault(
                step.TICK_PARTS, scene.station, Tick(), FAULT, scene.now_ns
            )
        rules = scene.alarms()
        assert {"station_fault", "link_lost"} <= rules
        (failed,) = fault_alarms(scene.station)
        assert "the watchdog failing has failed" in failed.condition.text

    def test_a_watchdog_without_a_fault_is_unchanged(self) -> None:
        finding = Finding("k", "r", Severity.INFO, "A", "text")

        def finds(_picture: TrafficPicture) -> Iterable[Finding]:
            yield finding

        picture: TrafficPicture = None  # type: ignore[assignment]
        assert tuple(isolated(finds)(picture)) == (finding,)

    def test_if_raising_alarms_fails_those_that_stand_stay(
        self, monkeypatch: pytest.MonkeyPatch
    ) -> None:
        scene = flying()
        scene.talk.clear()
        scene.passes(4.0)
        before = scene.alarms()
        assert "link_lost" in before
        monkeypatch.setattr("recon.station.alarms.conditions.conditions", failing)
        scene.station, _ = faulted_tick(scene)
        assert scene.alarms() == {*before, "station_fault"}

    def test_a_fault_in_one_vehicles_orders_leaves_the_others_followed(
        self, monkeypatch: pytest.MonkeyPatch
    ) -> None:
        """The hold of B is repeated, though following A's order fails."""
        scene = flying("A")
        reports = (core(), extended(b"B"))
        scene.opens(2, *(to_report(wire.decode(packet)) for packet in reports))
        scene.order(Hover(), "A")
        scene.order(Hover(), "B")
        sent = len(scene.handed)
        real = order_gateway._update_order

        def watch(station: Station, record: OrderRecord, now_ns: int) -> Stepped:
            if record.command.serial == "A":
                raise FAULT
            return real(station, record, now_ns)

        monkeypatch.setattr(order_gateway, "_update_order", watch)
        scene.now_ns += NS_PER_S
        scene.station, outputs = after_fault(
            step.TICK_PARTS, scene.station, Tick(), FAULT, scene.now_ns
        )
        assert len(scene.handed) == sent
        serials = [o.approved.command.serial for o in outputs if isinstance(o, SendCommand)]
        assert serials == ["B"]
        (alarm,) = fault_alarms(scene.station)
        assert "following the orders of A" in alarm.condition.text


class TestAStream:
    """One vehicle's steering fails at every beat."""

    def test_its_vehicle_is_stopped_and_the_others_are_steered(
        self, monkeypatch: pytest.MonkeyPatch
    ) -> None:
        s = steered()
        order = s.goto(200.0)
        s.run_for(4.0)
        monkeypatch.setattr("recon.station.steering.setpoint_streams.steer", failing)
        monkeypatch.setattr("recon.station.kernel.virtual.step", isolated_step)
        failed_s = s.now_s
        s.run_for(5.0)
        assert s.phase(order) is Phase.FAILED
        assert s.moving_sticks(failed_s + 0.15) == []
        assert s.zeros(failed_s) != []
        assert s.hovers(failed_s) != []
        assert s.aircraft.motion.ground_speed_mps < 0.5
        assert "steering SIM-1" in fault_alarms(s.w.driver.station)[0].condition.text

    def test_without_a_neutral_setpoint_it_is_held(self, monkeypatch: pytest.MonkeyPatch) -> None:
        s = steered()
        s.goto(200.0)
        s.run_for(4.0)
        monkeypatch.setattr("recon.station.steering.setpoint_streams.steer", failing)
        monkeypatch.setattr("recon.station.steering.stream_ends.halted", failing)
        monkeypatch.setattr("recon.station.kernel.virtual.step", isolated_step)
        failed_s = s.now_s
        s.run_for(5.0)
        assert s.sticks(failed_s + 0.15) == []
        assert s.hovers(failed_s) != []
        assert s.aircraft.motion.ground_speed_mps < 0.5
        assert s.w.driver.station.streaming == ()


class TestAnEvent:
    def test_a_step_that_fails_costs_its_event_alone(
        self, bench: Bench, monkeypatch: pytest.MonkeyPatch
    ) -> None:
        before = bench.driver.station
        with monkeypatch.context() as patched:
            patched.setattr("recon.station.kernel.step.fleet_step.step", failing)
            bench.driver.handle(LinkOpened(2, "10.0.0.2:5"))
        station = bench.driver.station
        assert replace(station, faults={}) == before
        (alarm,) = fault_alarms(station)
        assert "handling LinkOpened" in alarm.condition.text
        bench.driver.handle(LinkOpened(3, "10.0.0.3:5"))
        assert set(bench.driver.station.fleet.links) == {1, 3}

    def test_it_is_an_alarm_while_it_comes_again_and_until_acknowledged(self) -> None:
        scene = CommandedStation()
        for _ in range(30):
            scene.happens(StationFaulted("thinking", "a fault")).passes(0.5)
        assert scene.alarms() == {"station_fault"}
        (alarm,) = scene.station.alarms.alarms.values()
        scene.happens(AlarmAcknowledged(alarm.id, "Ann")).passes(5.0)
        assert scene.alarms() == {"station_fault"}
        scene.passes(6.0)
        assert scene.alarms() == set()
        assert scene.station.alarms.alarms == {}

    def test_only_so_many_different_faults_are_kept(self) -> None:
        scene = CommandedStation()
        for number in range(100):
            scene.happens(StationFaulted(f"thinking {number}", "a fault"))
        assert list(scene.station.faults) == [f"thinking {n}" for n in range(68, 100)]

    def test_an_order_that_was_never_judged_is_answered_as_refused(
        self, bench: Bench, monkeypatch: pytest.MonkeyPatch
    ) -> None:
        monkeypatch.setitem(step.HANDLERS, OperatorOrder, failing)  # type: ignore[arg-type]
        (result,) = bench.service.orders.all_stop(ANN).results
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
            patched.setitem(step.HANDLERS, Tick, both)  # type: ignore[arg-type]
            bench.driver.handle(Tick())
        assert closed == [2]
        (alarm,) = fault_alarms(bench.driver.station)
        assert "carrying out CloseLink" in alarm.condition.text

    def test_an_audit_that_fails_at_everything_ends_in_one_alarm(
        self, bench: Bench, monkeypatch: pytest.MonkeyPatch
    ) -> None:
        """Auditing that fault fails too: it must not go round in circles."""
        monkeypatch.setattr(bench.driver, "observe", failing)
        bench.driver.handle(Tick())
        bench.driver.handle(Tick())
        (alarm,) = fault_alarms(bench.driver.station)
        assert "writing the audit" in alarm.condition.text


def test_a_stop_goes_out_though_every_rule_fails(monkeypatch: pytest.MonkeyPatch) -> None:
    scene = flying()
    monkeypatch.setattr("recon.safety.gate.RULES", tuple(failing for _ in RULES))
    scene.order(Hover())
    assert scene.bodies() == [Hover()]
