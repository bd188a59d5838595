"""The TCP server on real sockets, against apps that behave and apps that do not."""

import asyncio
import contextlib
import errno
import socket
import time
import tracemalloc
from pathlib import Path

import pytest
from tests.link.approved import MS, ack, approved, core, extended, mission, stick
from tests.link.harness import LOOPS, PATIENCE_S, Listening, close, listening, run_on

from recon import wire
from recon.link.server import LinkServer
from recon.link.settings import LinkSettings
from recon.link.tap import Direction
from recon.model.command import Hover, LandNow, Phase, StartCamera
from recon.model.event import (
    CommandDropped,
    CommandSent,
    Event,
    LinkClosed,
    LinkOpened,
    PacketReceived,
)
from recon.model.mission import DJI
from recon.model.report import CoreReport, ExtendedReport

MIB = 1024 * 1024
GARBAGE = b"\xda\xa7\x00\xff garbage"


@pytest.fixture(params=sorted(LOOPS))
def loop(request: pytest.FixtureRequest) -> str:
    return str(request.param)


def order(station: Listening, command_id: int, body: object, link_id: int, **more: float) -> None:
    now_ns = time.monotonic_ns()
    station.server.send(approved(command_id, body, now_ns, link_ids=(link_id,), **more))  # type: ignore[arg-type]


async def packet_from(reader: asyncio.StreamReader) -> wire.Packet:
    async with asyncio.timeout(PATIENCE_S):
        head = await reader.readexactly(6)
        return wire.decode(head + await reader.readexactly(int.from_bytes(head[2:], "big") - 6))


class TestGoodApps:
    def test_packets_of_an_app_arrive_in_order(self, loop: str) -> None:
        async def main() -> None:
            async with listening() as station:
                link_id, _, writer = await station.connect()
                data = b"".join(core(yaw_deg=float(n)) for n in range(500)) + extended()
                for place in range(0, len(data), 1000):
                    writer.write(data[place : place + 1000])
                await station.until(lambda: len(station.reports(link_id)) == 501)
                yaws = [
                    r.attitude.yaw_deg
                    for r in station.reports(link_id)
                    if isinstance(r, CoreReport) and r.attitude
                ]
                assert yaws == [float(n) for n in range(500)]
                assert isinstance(station.reports(link_id)[-1], ExtendedReport)
                await close(writer)
                await station.until(lambda: station.closed_reason(link_id) is not None)
                assert station.closed_reason(link_id) == "the app closed the connection"

        run_on(loop, main)

    def test_packets_go_out_one_by_one_with_a_gap(self, loop: str) -> None:
        """An app that reads once per packet sees each command alone."""

        async def main() -> None:
            async with listening() as station:
                link_id, reader, writer = await station.connect()
                order(station, 1, mission(25), link_id)
                order(station, 2, StartCamera(1.0), link_id)
                reads: list[bytes] = []
                reading = asyncio.ensure_future(read_chunks(reader, reads))
                await station.until(lambda: len(station.of(CommandSent)) == 2)
                order(station, 3, stick(), link_id)
                await station.until(lambda: len(reads) == 3)
                assert [len(data) for data in reads] == [1011, 14, 30]
                assert [type(wire.decode(data)).__name__ for data in reads] == [
                    "ExecuteWaypointMission",
                    "CameraControl",
                    "VirtualStickCommand",
                ]
                reading.cancel()
                await close(writer)

        run_on(loop, main)

    def test_an_emergency_overtakes_and_does_not_wait(self, loop: str) -> None:
        async def main() -> None:
            async with listening() as station:
                link_id, reader, writer = await station.connect()
                order(station, 1, stick(), link_id)
                order(station, 2, mission(), link_id)
                before_ns = time.monotonic_ns()
                order(station, 3, Hover(), link_id)
                assert isinstance(await packet_from(reader), wire.VirtualStickCommand)
                assert isinstance(await packet_from(reader), wire.EmergencyCommand)
                assert time.monotonic_ns() - before_ns < 90 * MS
                assert [e.command_id for e in station.of(CommandSent)] == [1, 3]
                assert [e.command_id for e in station.of(CommandDropped)] == [2]
                await close(writer)

        run_on(loop, main)

    def test_an_answer_frees_the_next_mission(self, loop: str) -> None:
        async def main() -> None:
            async with listening() as station:
                link_id, reader, writer = await station.connect()
                order(station, 1, mission(), link_id, packet_gap_s=0.0)
                order(station, 2, mission(3), link_id, packet_gap_s=0.0)
                first = await packet_from(reader)
                writer.write(ack(253))
                second = await packet_from(reader)
                assert isinstance(first, wire.ExecuteWaypointMission)
                assert isinstance(second, wire.ExecuteWaypointMission)
                assert (len(first.waypoints), len(second.waypoints)) == (2, 3)
                await close(writer)

        run_on(loop, main)

    def test_an_app_that_goes_fails_what_waits(self, loop: str) -> None:
        async def main() -> None:
            async with listening() as station:
                link_id, _, writer = await station.connect()
                order(station, 1, stick(), link_id)
                order(station, 2, mission(), link_id)
                await close(writer)
                await station.until(lambda: station.closed_reason(link_id) is not None)
                (dropped,) = station.of(CommandDropped)
                assert (dropped.command_id, dropped.phase) == (2, Phase.FAILED)
                assert isinstance(station.events[-1], LinkClosed)

        run_on(loop, main)

    def test_a_reset_connection_is_reported(self, loop: str) -> None:
        async def main() -> None:
            async with listening() as station:
                link_id, _, writer = await station.connect()
                writer.transport.abort()
                await station.until(lambda: station.closed_reason(link_id) is not None)

        run_on(loop, main)


async def read_chunks(reader: asyncio.StreamReader, chunks: list[bytes]) -> None:
    while data := await reader.read(65536):
        chunks.append(data)


class TestReentrance:
    def test_an_event_may_send_on_its_own_link(self, loop: str) -> None:
        """Telemetry repeats emergency orders: handling one packet of many writes to the link."""

        async def main() -> None:
            async with listening() as station:
                link_id, reader, writer = await station.connect()
                ids = iter(range(1, 1000))

                def react(event: Event) -> None:
                    if isinstance(event, PacketReceived):
                        order(station, next(ids), Hover(), link_id)

                station.react = react
                writer.write(b"".join(core(yaw_deg=float(n)) for n in range(200)))
                await station.until(lambda: len(station.of(PacketReceived)) == 200)
                await station.until(
                    lambda: len(station.of(CommandSent)) + len(station.of(CommandDropped)) == 200
                )
                assert station.closed_reason(link_id) is None
                assert isinstance(await packet_from(reader), wire.EmergencyCommand)
                await close(writer)

        run_on(loop, main)


class TestBadApps:
    def test_garbage_for_ever_is_closed_and_others_go_on(self, loop: str) -> None:
        async def main() -> None:
            async with listening(LinkSettings(garbage_limit_bytes=MIB)) as station:
                good_id, _, good = await station.connect()
                bad_id, _, bad = await station.connect()
                spray = asyncio.ensure_future(
                    write_for_ever(bad, b"\xda\xa7\x00\xff garbage" * 999)
                )
                for number in range(50):
                    good.write(core())
                    await station.until(lambda n=number: len(station.reports(good_id)) > n)
                await station.until(lambda: station.closed_reason(bad_id) is not None)
                assert "without one valid packet" in (station.closed_reason(bad_id) or "")
                assert station.closed_reason(good_id) is None
                good.write(core())
                await station.until(lambda: len(station.reports(good_id)) == 51)
                await asyncio.wait((spray,))
                assert isinstance(spray.exception(), OSError)
                await close(good, bad)

        run_on(loop, main)

    def test_a_header_of_4_gb_is_never_allocated(self, loop: str) -> None:
        async def main() -> None:
            async with listening() as station:
                before_kib = resident_kib()
                tracemalloc.start()
                links = [await station.connect() for _ in range(20)]
                for link_id, _, writer in links:
                    for pid in (0, 1, 2, 3, 4, 5, 9, 253, 255):
                        header = b"\xda\xa7\xff\xff\xff\xff" + bytes([pid])
                        writer.write(header + b"\xff" * 64 + core())
                    await station.until(lambda i=link_id: len(station.reports(i)) == 9)
                peak_bytes = tracemalloc.get_traced_memory()[1]
                tracemalloc.stop()
                assert peak_bytes < 8 * MIB
                assert resident_kib() - before_kib < 64 * 1024
                await close(*(writer for _, _, writer in links))

        run_on(loop, main)

    def test_the_largest_image_claimed_costs_nothing_until_it_comes(self, loop: str) -> None:
        async def main() -> None:
            async with listening() as station:
                size = 17 + 3 * 3840 * 2160
                head = b"\xda\xa7" + size.to_bytes(4, "big") + b"\x02" + bytes(4)
                head += (2160).to_bytes(2, "big") + (3840).to_bytes(2, "big")
                before_kib = resident_kib()
                links = [await station.connect() for _ in range(100)]
                for _, _, writer in links:
                    writer.write(head + bytes(1000))
                await station.until(
                    lambda: all(
                        c.session is not None and c.session.bytes_received == len(head) + 1000
                        for c in station.server.connections.values()
                    )
                )
                assert resident_kib() - before_kib < 64 * 1024
                await close(*(writer for _, _, writer in links))

        run_on(loop, main)

    def test_an_app_that_never_reads_is_closed_with_its_reason(self, loop: str) -> None:
        async def main() -> None:
            settings = LinkSettings(stuck_output_timeout_s=0.2, packet_gap_s=0.0)
            async with listening(settings) as station:
                app = socket.socket()
                app.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 4096)
                app.setblocking(False)
                await asyncio.get_running_loop().sock_connect(
                    app, ("127.0.0.1", station.server.port)
                )
                await station.until(lambda: len(station.of(LinkOpened)) == 1)
                link_id = station.of(LinkOpened)[0].link_id
                await asyncio.get_running_loop().sock_sendall(app, core())
                numbers = iter(range(1_000_000))

                def give_more() -> bool:
                    for _ in range(300):
                        order(station, next(numbers), LandNow(), link_id)
                    return station.closed_reason(link_id) is not None

                await station.until(give_more)
                assert station.closed_reason(link_id) == "the app has not read for 0.2 s"
                app.close()

        run_on(loop, main)

    def test_connections_beyond_the_limit_are_refused_at_once(self, loop: str) -> None:
        async def main() -> None:
            async with listening(LinkSettings(max_links=3)) as station:
                links = [await station.connect() for _ in range(3)]
                for _, _, writer in links:
                    writer.write(core())
                await station.until(lambda: len(station.of(PacketReceived)) == 3)
                reader, writer = await asyncio.open_connection("127.0.0.1", station.server.port)
                async with asyncio.timeout(PATIENCE_S):
                    with contextlib.suppress(ConnectionResetError):
                        assert await reader.read(1) == b""
                assert station.server.refused_connections == 1
                assert len(station.of(LinkOpened)) == 3
                await close(writer, links[0][2])
                await station.until(lambda: len(station.server.connections) == 2)
                links.append(await station.connect())
                await close(*(link[2] for link in links[1:]))

        run_on(loop, main)

    def test_the_oldest_link_that_never_spoke_gives_way(self, loop: str) -> None:
        async def main() -> None:
            async with listening(LinkSettings(max_links=2)) as station:
                spoken, _, first = await station.connect()
                first.write(core())
                await station.until(lambda: len(station.reports(spoken)) == 1)
                mute, _, second = await station.connect()
                real, _, third = await station.connect()
                await station.until(lambda: station.closed_reason(mute) is not None)
                assert "another app needs the place" in (station.closed_reason(mute) or "")
                assert set(station.server.connections) == {spoken, real}
                assert station.server.refused_connections == 0
                await close(first, second, third)

        run_on(loop, main)

    def test_a_slow_loris_is_closed_and_costs_little(self, loop: str) -> None:
        async def main() -> None:
            settings = LinkSettings(unidentified_timeout_s=0.5)
            async with listening(settings) as station:
                links = [await station.connect() for _ in range(30)]
                for link_id, _, writer in links:
                    writer.write(core()[: link_id % 70])
                await station.until(lambda: len(station.of(LinkClosed)) == 30)
                reasons = {event.reason for event in station.of(LinkClosed)}
                assert reasons == {"no serial number, no telemetry and no valid packet for 0.5 s"}
                await close(*(writer for _, _, writer in links))

        run_on(loop, main)

    @pytest.mark.parametrize(
        "serial",
        [
            b"<script>alert(1)</script>",
            b"\x1b]0;owned\x07\x1b[31m",
            "‮evil⁦".encode(),
            b"\xff\xfe\x00",
            b"x" * 256,
        ],
    )
    def test_a_nasty_serial_is_harmless(self, loop: str, serial: bytes) -> None:
        async def main() -> None:
            async with listening() as station:
                link_id, _, writer = await station.connect()
                writer.write(extended(serial))
                await station.until(lambda: len(station.reports(link_id)) == 1)
                (report,) = station.reports(link_id)
                assert isinstance(report, ExtendedReport)
                assert report.serial is not None
                assert report.serial.isprintable()
                await close(writer)

        run_on(loop, main)

    def test_a_serial_of_10_000_characters_is_no_packet(self, loop: str) -> None:
        async def main() -> None:
            async with listening() as station:
                link_id, _, writer = await station.connect()
                size = 25 + 10_000
                body = b"\xda\xa7" + size.to_bytes(4, "big") + b"\x01" + bytes(12)
                body += (10_000).to_bytes(4, "big") + b"A" * 10_000
                writer.write(body + bytes(wire.checksum(body)) + core())
                await station.until(lambda: len(station.reports(link_id)) == 1)
                assert isinstance(station.reports(link_id)[0], CoreReport)
                connection = station.server.connections[link_id]
                assert connection.session is not None
                assert connection.session.counters.bad_size >= 1
                await close(writer)

        run_on(loop, main)

    def test_the_counters_of_ended_links_stay_and_are_bounded(self, loop: str) -> None:
        async def main() -> None:
            async with listening(LinkSettings(ended_sessions_kept=2)) as station:
                for number in range(1, 4):
                    link_id, _, writer = await station.connect()
                    writer.write(b"noise" * number + core())
                    await station.until(lambda: len(station.reports(link_id)) == 1)  # noqa: B023
                    await close(writer)
                    await station.until(lambda: station.closed_reason(link_id) is not None)  # noqa: B023
                skipped = {
                    i: s.counters.bytes_skipped for i, s in station.server.sessions().items()
                }
                assert skipped == {2: 10, 3: 15}

        run_on(loop, main)

    def test_a_flood_does_not_starve_the_others(self, loop: str) -> None:
        """While one link floods, another's packet is handled after a bounded number of its."""

        async def main() -> None:
            settings = LinkSettings()
            async with listening(settings) as station:
                flood_id, _, flood = await station.connect()
                good_id, _, good = await station.connect()
                station.react = lambda event: burn_us(50)
                spray = asyncio.ensure_future(write_for_ever(flood, ack(9) * 10_000))
                await station.until(lambda: len(station.reports(flood_id)) > 3000)
                for number in range(20):
                    handled = len(station.events)
                    good.write(core())
                    await station.until(lambda n=number: len(station.reports(good_id)) > n)
                    # One turn may be under way at the sending end, one at the station.
                    assert len(station.events) - handled < 8 * settings.events_per_turn
                spray.cancel()
                await asyncio.wait((spray,))
                flood.transport.abort()
                await close(good)

        run_on(loop, main)

    def test_nothing_of_a_flood_is_lost(self, loop: str) -> None:
        async def main() -> None:
            async with listening() as station:
                link_id, _, writer = await station.connect()
                for _ in range(20):
                    writer.write(ack(9) * 1000)
                await writer.drain()
                await close(writer)
                await station.until(lambda: station.closed_reason(link_id) is not None)
                assert len(station.reports(link_id)) == 20_000

        run_on(loop, main)


async def write_for_ever(writer: asyncio.StreamWriter, data: bytes) -> None:
    while True:
        writer.write(data)
        await writer.drain()


def burn_us(microseconds: int) -> None:
    """Stand for the cost of a step."""
    end_ns = time.perf_counter_ns() + 1000 * microseconds
    while time.perf_counter_ns() < end_ns:
        pass


def resident_kib() -> int:
    fields = dict(line.split(":", 1) for line in Path("/proc/self/status").read_text().splitlines())
    return int(fields["VmRSS"].split()[0])


class TestServer:
    def test_a_fault_in_handling_ends_one_link_and_no_other(self, loop: str) -> None:
        async def main() -> None:
            async with listening() as station:
                bad_id, _, bad = await station.connect()
                good_id, _, good = await station.connect()

                def react(event: Event) -> None:
                    if isinstance(event, PacketReceived) and event.link_id == bad_id:
                        raise RuntimeError("a fault")

                station.react = react
                bad.write(core())
                await station.until(lambda: station.closed_reason(bad_id) is not None)
                assert "a fault" in (station.closed_reason(bad_id) or "")
                good.write(core())
                await station.until(lambda: len(station.reports(good_id)) == 1)
                await close(bad, good)

        run_on(loop, main)

    def test_a_port_in_use_is_an_error(self, loop: str) -> None:
        async def main() -> None:
            async with listening() as station:
                other = LinkServer(lambda event: None, time.monotonic_ns, LinkSettings())
                with pytest.raises(OSError, match="in use") as caught:
                    await other.start("127.0.0.1", station.server.port)
                assert caught.value.errno == errno.EADDRINUSE
                await other.stop()

        run_on(loop, main)

    def test_stopping_closes_every_link_with_its_reason(self, loop: str) -> None:
        async def main() -> None:
            async with listening() as station:
                links = [await station.connect() for _ in range(5)]
                await station.server.stop()
                await station.until(lambda: len(station.of(LinkClosed)) == 5)
                assert {e.reason for e in station.of(LinkClosed)} == {"the station stops"}
                await close(*(writer for _, _, writer in links))

        run_on(loop, main)

    def test_an_unsent_order_to_move_is_withdrawn(self, loop: str) -> None:
        async def main() -> None:
            async with listening() as station:
                link_id, _, writer = await station.connect()
                for number in (1, 2):  # the second waits for the answer to the first
                    order(station, number, mission(), link_id)
                station.server.withdraw_motion((link_id,), "the pilot flies")
                await station.until(lambda: bool(station.of(CommandDropped)))
                dropped = CommandDropped(link_id, 2, Phase.SUPERSEDED, "the pilot flies")
                assert station.of(CommandDropped) == [dropped]
                await close(writer)

        run_on(loop, main)

    def test_closing_a_link_that_is_gone_is_nothing(self, loop: str) -> None:
        async def main() -> None:
            async with listening() as station:
                station.server.close_link(99, "unknown link")
                station.server.withdraw_motion((99,), "unknown link")
                order(station, 1, Hover(), 99)
                assert station.events == []

        run_on(loop, main)

    def test_the_tap_gets_both_directions(self, loop: str) -> None:
        async def main() -> None:
            taken: list[tuple[int, Direction, bytes]] = []
            async with listening(
                tap=lambda link_id, direction, data, _at_ns: taken.append(
                    (link_id, direction, data)
                )
            ) as station:
                link_id, reader, writer = await station.connect()
                writer.write(core())
                await station.until(lambda: len(station.reports(link_id)) == 1)
                order(station, 1, Hover(), link_id)
                assert isinstance(await packet_from(reader), wire.EmergencyCommand)
                await close(writer)
                await station.until(lambda: station.closed_reason(link_id) is not None)
            assert (link_id, Direction.FROM_APP, core()) in taken
            hover = bytes.fromhex("daa70000000aff008a7d")
            assert (link_id, Direction.TO_APP, hover) in taken

        run_on(loop, main)


def test_the_sockets_buffer_takes_the_largest_packet_whole() -> None:
    """No packet is ever half written, so the guard's hover never cuts one in two."""
    point = wire.Waypoint(
        latitude_deg=42.0,
        longitude_deg=-93.0,
        altitude_m=300.0,
        corner_radius_m=1.0,
        speed_mps=5.0,
        loiter_time_s=0.0,
        gimbal_pitch_deg=-90.0,
    )
    points = [point] * DJI.max_waypoints
    mission = wire.ExecuteWaypointMission(land_at_end=1, curved_flight=0, waypoints=points)
    assert len(wire.encode(mission)) < LinkSettings().send_buffer_bytes / 2
