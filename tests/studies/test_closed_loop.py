"""The closed-loop study in short, and stations that are broken on purpose: each is found."""

import pytest
from studies.closed_loop.marks import ViolationClass
from studies.closed_loop.run import ClosedLoopRun
from studies.closed_loop.violations import RunResult
from tests.examples import family

from recon.model.command import Command, Hover, Nudge, Refusal
from recon.model.event import PacketReceived
from recon.model.units import Stamped
from recon.safety import gate
from recon.safety.rules.authority import authority as authority_rule
from recon.safety.rules.dji_limits import dji_limits
from recon.safety.situation import Situation
from recon.station.control import authority
from recon.station.kernel import watchdog_holds
from recon.station.steering import setpoint_streams

Patch = pytest.MonkeyPatch


def flown(seed: int, seconds: float) -> RunResult:
    result = ClosedLoopRun(seed, seconds).run()
    assert result.error == ""
    return result


def own_kinds(result: RunResult) -> set[str]:
    """What the station is to blame for."""
    found = result.violations
    return {each.breach.kind for each in found if each.kind is ViolationClass.STATION}


@pytest.mark.parametrize("seed", family(3, 11, 90, 117))
def test_a_run_has_no_violation_of_the_stations_own(seed: int) -> None:
    result = flown(seed, 50.0)
    assert own_kinds(result) == set()
    assert result.flight_s > 50.0
    assert result.packets > 5


def test_a_seed_gives_the_same_run_again() -> None:
    one, other = flown(113, 25.0), flown(113, 25.0)
    assert (one.orders, one.packets, one.flight_s) == (other.orders, other.packets, other.flight_s)
    assert [each.at_s for each in one.violations] == [each.at_s for each in other.violations]
    assert one.stop_latencies_s == other.stop_latencies_s


def test_a_gate_without_rules_and_no_watchdogs_are_found(monkeypatch: Patch) -> None:
    monkeypatch.setattr(gate, "RULES", (dji_limits,))
    runner = watchdog_holds.watchdog_runner.run
    monkeypatch.setattr(
        watchdog_holds.watchdog_runner,
        "run",
        lambda station, now_ns, _: runner(station, now_ns, ()),
    )
    kinds = own_kinds(flown(55, 60.0))
    assert kinds & {"separation", "fence", "too low", "too high", "keep-out zone"}
    assert "alarm missing" in kinds


@pytest.mark.flight
def test_a_station_that_sends_no_holds_is_found(monkeypatch: Patch) -> None:
    def refuse(command: Command, _situation: Situation) -> Refusal | None:
        return Refusal("test", "no holds") if isinstance(command.body, Hover) else None

    monkeypatch.setattr(gate, "RULES", (refuse, *gate.RULES))
    result = flown(117, 50.0)
    assert "hold" in own_kinds(result)
    assert float("inf") in result.stop_latencies_s


def flown_by_a_pilot() -> ClosedLoopRun:
    """Three hovering vehicles; a pilot takes one, and is ordered about."""
    run = ClosedLoopRun(36)
    run.start()
    run_for(run, 8.0)
    run.apps["SIM-1"].aircraft.pilot_takes()
    run.guard.takes("SIM-1", run.now_s)
    run_for(run, 3.0)
    for _ in range(3):
        run.orders.order("SIM-1", Nudge(2.0, 0.0, 0.0), owner="stream")
        run_for(run, 1.0)
    return run


def run_for(run: ClosedLoopRun, seconds: float) -> None:
    for _ in range(round(10 * seconds)):
        run.step()


def test_orders_to_a_pilots_vehicle_are_no_violation_while_none_is_sent() -> None:
    assert own_kinds(flown_by_a_pilot().result) == set()


def test_a_station_that_ignores_pilots_is_found(monkeypatch: Patch) -> None:
    rules = tuple(rule for rule in gate.RULES if rule is not authority_rule)
    monkeypatch.setattr(gate, "RULES", rules)
    monkeypatch.setattr(authority, "give_to_pilot", lambda station, *_: (station, ()))
    monkeypatch.setattr(setpoint_streams, "refusal_to_start", lambda *_: None)
    assert "pilot's vehicle" in own_kinds(flown_by_a_pilot().result)


def test_a_takeoff_without_such_an_order_is_found(monkeypatch: Patch) -> None:
    monkeypatch.setattr(gate, "RULES", (dji_limits,))
    run = ClosedLoopRun(46)
    run.start()
    run_for(run, 5.0)
    run.orders.order("SIM-1", run.orders.drawn_mission("SIM-1"))
    run_for(run, 3.0)
    assert "takeoff" in own_kinds(run.result)


def test_a_station_that_shows_old_values_as_new_is_found(monkeypatch: Patch) -> None:
    def age_s(self: Stamped[object], _now_ns: int) -> float | None:
        return None if self.received_at_ns is None else 0.0

    monkeypatch.setattr(Stamped, "age_s", age_s)
    assert "shown age" in own_kinds(flown(3, 50.0))


def test_a_fault_in_the_stations_code_is_found(monkeypatch: Patch) -> None:
    def fail(_event: PacketReceived, _now_ns: int) -> int:
        raise ValueError("constructed")

    monkeypatch.setattr(PacketReceived, "received_at_ns", fail)
    assert "constructed" in ClosedLoopRun(3, 5.0).run().error
