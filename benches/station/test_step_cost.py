"""What one packet, one tick and one state cost with 64 vehicles; the ceilings asserted.

python -m pytest benches/station -c benches/pytest.ini
"""

import statistics
from collections.abc import Callable
from time import perf_counter

from benches.station.fake_apps import core_packet, extended_packet, place_deg, serial

from recon import wire
from recon.link.session import Session
from recon.link.settings import LinkSettings
from recon.model.command import Hover
from recon.model.event import LinkOpened, OperatorOrder, PacketReceived, Tick
from recon.model.units import NS_PER_S
from recon.site import default_site
from recon.station.alarms.conditions import conditions
from recon.station.api_views.service import Service
from recon.station.kernel.build import first_state
from recon.station.kernel.driver import AsyncioDriver
from recon.station.kernel.step import step
from recon.station.state.station import Station
from recon.vehicles.reports import to_report

VEHICLES = 64
ROUNDS = 7
LAST_NS = 599 * NS_PER_S


def busy_station() -> Station:
    """Return a station with 64 vehicles, ten minutes of track each, one order alive each."""
    station = first_state(default_site())
    for number in range(VEHICLES):
        station, _ = step(station, LinkOpened(number, "bench"), 0)
        station = heard(station, number, extended_packet(serial(number).encode()), 0)
    for now_ns in range(0, LAST_NS + 1, NS_PER_S):
        for number in range(VEHICLES):
            station = heard(station, number, core(number, now_ns), now_ns)
    for number in range(VEHICLES):
        order = OperatorOrder(number, Hover(), "bench", serial=serial(number))
        station, _ = step(station, order, LAST_NS)
    return station


def core(number: int, now_ns: int) -> bytes:
    """Return the core telemetry of a vehicle that moves slowly."""
    time_s = now_ns / NS_PER_S
    return core_packet(**place_deg(10.0 * number, time_s), yaw_deg=10.0 * time_s % 360.0)


def heard(station: Station, link_id: int, packet: bytes, now_ns: int) -> Station:
    report = to_report(wire.decode(packet))
    return step(station, PacketReceived(link_id, report), now_ns)[0]


def median_us(work: Callable[[], object], times: int) -> float:
    """Return the median over rounds of the time one call takes."""
    found = []
    for _ in range(ROUNDS):
        begin_s = perf_counter()
        for _ in range(times):
            work()
        found.append(1e6 * (perf_counter() - begin_s) / times)
    return statistics.median(found)


def test_costs_with_64_vehicles() -> None:
    station = busy_station()
    now_ns = LAST_NS + NS_PER_S // 4
    report = to_report(wire.decode(core(3, NS_PER_S)))
    event = PacketReceived(3, report)
    empty, _ = step(first_state(default_site()), LinkOpened(3, "bench"), 0)
    one_us = median_us(lambda: step(empty, event, now_ns), 200)
    core_us = median_us(lambda: step(station, event, now_ns), 200)
    tick_us = median_us(lambda: step(station, Tick(), now_ns), 20)
    conditions_us = median_us(lambda: list(conditions(station, now_ns)), 50)
    driver = AsyncioDriver(station, lambda: now_ns)
    service = Service.around(driver, default_site(), None)
    state_us = median_us(service.state, 10)
    both_us = median_us(lambda: service.state().model_dump_json(), 10)
    size_kib = len(service.state().model_dump_json()) / 1024
    print(
        f"\ncore packet's step: {core_us:.0f} us with {VEHICLES} vehicles, {one_us:.0f} us with one"
        f"\ntick: {tick_us:.0f} us, of it conditions {conditions_us:.0f} us"
        f"\nstate: {state_us / 1e3:.1f} ms, with JSON {both_us / 1e3:.1f} ms, {size_kib:.0f} KiB"
    )
    assert core_us < 500.0
    assert tick_us < 10_000.0
    assert both_us < 25_000.0


def test_a_small_packets_way_through_the_session() -> None:

    session = Session(1, LinkSettings(), 0)
    data = wire.encode(wire.Acknowledgment(positive=1, source_pid=9)) * 1000
    packet_us = median_us(lambda: session.receive(data, 0), 5) / 1000
    deframer = wire.Deframer()
    bare_us = median_us(lambda: deframer.feed(data, 0), 5) / 1000
    print(f"\nsmallest packet: {packet_us:.2f} us through the session, {bare_us:.2f} us deframed")
    assert packet_us < 20.0
