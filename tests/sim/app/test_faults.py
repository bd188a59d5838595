"""Each fault, and how its description is read."""

from math import inf

import pytest
from hypothesis import given
from hypothesis import strategies as st

from recon import wire
from recon.model.vehicle import FlightMode
from recon.sim.app.app import LinkOrder, LinkOrderKind
from recon.sim.app.faults import FaultKind, InjectedFault, parse_fault
from recon.sim.errors import FaultError

LAND = wire.EmergencyCommand(action=1)


def acks(packets: list) -> list[tuple[int, int]]:
    return [(p.positive, p.source_pid) for p in packets if isinstance(p, wire.Acknowledgment)]


def faulty(app_bench, kind: FaultKind, start_s: float = 0.0, duration_s: float = inf):
    return app_bench(faults=(InjectedFault(kind, start_s=start_s, duration_s=duration_s),))


def test_ack_then_nothing(app_bench) -> None:
    bench = faulty(app_bench, FaultKind.ACK_THEN_NOTHING)
    assert acks(bench.send(LAND)) == [(1, 255)]
    bench.run(3.0)
    assert bench.mode == FlightMode.GPS_ATTI


def test_no_ack(app_bench) -> None:
    bench = faulty(app_bench, FaultKind.NO_ACK)
    assert acks(bench.send(LAND)) == []
    assert acks(bench.run(3.0)) == []
    assert bench.mode == FlightMode.AUTO_LANDING


def test_negative_ack(app_bench) -> None:
    bench = faulty(app_bench, FaultKind.NEGATIVE_ACK)
    assert acks(bench.send(LAND)) == [(0, 255)]
    bench.run(3.0)
    assert bench.mode == FlightMode.GPS_ATTI


def test_telemetry_dropout_is_over_after_its_time(app_bench) -> None:
    bench = faulty(app_bench, FaultKind.TELEMETRY_DROPOUT, start_s=2.0, duration_s=3.0)
    assert bench.run(1.999)
    assert bench.run(3.0) == []
    assert bench.run(1.0)


def test_commands_are_answered_and_flown_during_a_dropout(app_bench) -> None:
    bench = faulty(app_bench, FaultKind.TELEMETRY_DROPOUT, duration_s=5.0)
    assert acks(bench.send(LAND)) == [(1, 255)]
    bench.run(6.0)
    assert bench.mode == FlightMode.AUTO_LANDING


def test_placeholder_serial(app_bench) -> None:
    bench = faulty(app_bench, FaultKind.PLACEHOLDER_SERIAL, duration_s=4.0)
    serials = [p.serial for p in bench.run(8.0) if isinstance(p, wire.ExtendedTelemetry)]
    assert serials == [b"00000"] * 8 + [b"SIM-7"] * 8


@pytest.mark.parametrize(
    ("kind", "order"),
    [
        (FaultKind.RESTART, LinkOrder(LinkOrderKind.RECONNECT, 2.5)),
        (FaultKind.HALF_OPEN, LinkOrder(LinkOrderKind.ABANDON, 2.5)),
        (FaultKind.SECOND_LINK, LinkOrder(LinkOrderKind.SECOND, 2.5)),
    ],
)
def test_link_faults_are_ordered_once_and_at_their_time(app_bench, kind, order) -> None:
    bench = faulty(app_bench, kind, start_s=1.0, duration_s=2.5)
    bench.run(0.95)
    assert bench.app.take_link_orders() == []
    bench.run(0.1)
    assert bench.app.take_link_orders() == [order]
    bench.run(5.0)
    assert bench.app.take_link_orders() == []


@pytest.mark.parametrize("kind", [FaultKind.RESTART, FaultKind.HALF_OPEN])
def test_the_old_link_sends_nothing(app_bench, kind) -> None:
    bench = faulty(app_bench, kind, start_s=1.0)
    bench.run(1.05)
    assert bench.run(1.0) == []
    assert bench.send(LAND) == []


def test_a_restarted_app_has_no_memory_and_the_aircraft_flies_on(app_bench, mission_packet) -> None:
    bench = faulty(app_bench, FaultKind.RESTART, start_s=5.0)
    bench.run(1.0)
    mission = mission_packet([(0.0, 10.0, 30.0), (400.0, 10.0, 30.0)])
    bench.send(mission)
    bench.run(3.9)
    bench.send(LAND)
    bench.run(0.2)
    bench.app.connected(bench.now_ns)
    bench.run(1.0)
    assert bench.mode == FlightMode.GPS_WAYPOINT
    assert bench.last(wire.ExtendedTelemetry).mission_id == 0
    bench.send(mission)
    bench.run(4.0)
    assert bench.last(wire.ExtendedTelemetry).mission_id == 1


def test_both_links_send_and_both_are_read(app_bench) -> None:
    bench = faulty(app_bench, FaultKind.SECOND_LINK, start_s=1.0)
    bench.run(1.05)
    bench.app.connected(bench.now_ns, link=1)
    bench.app.receive(wire.encode(LAND), bench.now_ns, link=1)
    on_main = bench.run(1.0)
    on_second = wire.Deframer().feed(b"".join(bench.app.advance(bench.now_ns, link=1)))
    assert acks(on_main) == []
    assert acks(on_second) == [(1, 255)]
    telemetry = [p for p in on_second if isinstance(p, wire.CoreTelemetry)]
    assert telemetry == [p for p in on_main if isinstance(p, wire.CoreTelemetry)]
    assert bench.mode == FlightMode.AUTO_LANDING


@pytest.mark.parametrize(
    ("text", "fault"),
    [
        ("no-ack", InjectedFault(FaultKind.NO_ACK, "*", 0.0, inf)),
        ("no-ack:SIM-2", InjectedFault(FaultKind.NO_ACK, "SIM-2", 0.0, inf)),
        ("half-open:2:12", InjectedFault(FaultKind.HALF_OPEN, "2", 12.0, 30.0)),
        ("restart::3:1.5", InjectedFault(FaultKind.RESTART, "*", 3.0, 1.5)),
        ("telemetry-dropout", InjectedFault(FaultKind.TELEMETRY_DROPOUT, "*", 5.0, 3.0)),
    ],
)
def test_descriptions(text: str, fault: InjectedFault) -> None:
    assert parse_fault(text) == fault


@pytest.mark.parametrize(
    "text", ["", "nonsense", "no-ack:1:x", "no-ack:1:-3", "no-ack:1:2:nan", "no-ack:1:2:3:4"]
)
def test_errors_of_bad_descriptions_name_what_was_expected(text: str) -> None:
    with pytest.raises(FaultError, match="expected"):
        parse_fault(text)


@given(st.text(max_size=60))
def test_any_text_is_a_fault_or_an_error(text: str) -> None:
    try:
        read = parse_fault(text)
    except FaultError as problem:
        read = problem
    assert isinstance(read, InjectedFault) or "expected" in str(read)


def test_a_fault_belongs_to_a_serial_a_number_or_all() -> None:
    assert InjectedFault(FaultKind.NO_ACK, "SIM-2").is_for("SIM-2", 3)
    assert InjectedFault(FaultKind.NO_ACK, "3").is_for("SIM-2", 3)
    assert InjectedFault(FaultKind.NO_ACK).is_for("SIM-2", 3)
    assert not InjectedFault(FaultKind.NO_ACK, "2").is_for("SIM-2", 3)


def extended(packets: list) -> list[wire.ExtendedTelemetry]:
    return [packet for packet in packets if isinstance(packet, wire.ExtendedTelemetry)]


def test_a_pilot_takes_control_and_releases_it(app_bench) -> None:
    bench = faulty(app_bench, FaultKind.PILOT_TAKES, start_s=2.0, duration_s=3.0)
    bench.run(1.5)
    assert bench.mode == FlightMode.GPS_ATTI
    bench.run(1.0)
    assert bench.mode == FlightMode.GPS_SPORT
    assert bench.app.aircraft.has_pilot_control
    assert "fault pilot-takes" in bench.app.take_log()
    bench.run(3.0)
    assert bench.mode == FlightMode.GPS_ATTI
    assert not bench.app.aircraft.has_pilot_control


def test_releasing_control_does_not_stop_a_landing(app_bench) -> None:
    bench = faulty(app_bench, FaultKind.PILOT_TAKES, start_s=1.0, duration_s=3.0)
    bench.run(2.0)
    bench.app.aircraft.land()
    bench.run(3.0)
    assert bench.mode == FlightMode.AUTO_LANDING


def test_gnss_is_lost_and_regained(app_bench) -> None:
    bench = faulty(app_bench, FaultKind.GNSS_LOSS, start_s=2.0, duration_s=3.0)
    assert {t.gnss_signal_level for t in extended(bench.run(1.9))} == {5}
    lost = extended(bench.run(3.0))
    assert lost
    assert {(t.gnss_satellite_count, t.gnss_signal_level) for t in lost} == {(3, 0)}
    assert {t.gnss_signal_level for t in extended(bench.run(2.0))} == {5}


def test_a_failed_cell_leaves_a_fifth_at_most(app_bench) -> None:
    bench = faulty(app_bench, FaultKind.LOW_BATTERY, start_s=1.0)
    assert min(t.battery_percent for t in extended(bench.run(0.9))) > 20
    assert max(t.battery_percent for t in extended(bench.run(3.0))[1:]) <= 20
    bench.app.aircraft.battery.fraction = 0.1
    bench.app.aircraft.battery.lose_a_cell(0.2)
    assert bench.app.aircraft.battery.percent == 10
