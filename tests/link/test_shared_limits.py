"""What all links share: places and memory, against peers that take them and give nothing."""

import asyncio

import pytest
from tests.link.approved import ack, core, extended
from tests.link.harness import LOOPS, Listening, close, listening, run_on
from tests.link.test_server import write_for_ever
from tests.link.test_session_patience import READ, UHD, damaged_image, head

from recon.link.settings import MIB, LinkSettings
from recon.link.shared_limits import MEMORY, PLACES
from recon.model.event import LinkLimitReached, LinkOpened


@pytest.fixture(params=sorted(LOOPS))
def loop(request: pytest.FixtureRequest) -> str:
    return str(request.param)


def limits(station: Listening, limit: str) -> list[str | None]:
    return [e.problem for e in station.of(LinkLimitReached) if e.limit == limit]


def buffered(station: Listening, link_id: int) -> int:
    connection = station.server.connections.get(link_id)
    session = None if connection is None else connection.session
    return 0 if session is None else session.buffered_bytes


class TestPlaces:
    def test_refusals_are_one_alarm_that_ends_with_a_free_place(self, loop: str) -> None:
        async def main() -> None:
            async with listening(LinkSettings(max_links=2)) as station:
                links = [await station.connect() for _ in range(2)]
                for _, _, writer in links:
                    writer.write(core())
                await station.until(lambda: all(station.reports(i) for i, _, _ in links))
                refused = []
                for number in range(3):
                    _, writer = await asyncio.open_connection("127.0.0.1", station.server.port)
                    refused.append(writer)
                    await station.until(
                        lambda n=number: station.server.refused_connections == n + 1  # type: ignore[misc]
                    )
                (problem,) = limits(station, PLACES)
                assert problem is not None
                assert "refused: 2 apps are connected, limit 2" in problem
                await close(*refused, links[0][2])
                await station.until(lambda: len(limits(station, PLACES)) == 2)
                assert limits(station, PLACES)[1] is None
                await close(links[1][2])

        run_on(loop, main)

    @pytest.mark.parametrize("spoken", [b"", ack(9), core()])
    def test_idle_links_keep_no_app_out(self, loop: str, spoken: bytes) -> None:
        """256 links that connect, send nothing or one packet, and never identify themselves."""

        async def main() -> None:
            settings = LinkSettings(unidentified_timeout_s=1000.0)
            async with listening(settings) as station:
                idle = [await station.connect() for _ in range(settings.max_links)]
                for _, _, writer in idle:
                    writer.write(spoken)
                await station.until(
                    lambda: not spoken or all(station.reports(i) for i, _, _ in idle)
                )
                assert all(station.closed_reason(i) is None for i, _, _ in idle)
                station.skip(1001.0)
                link_id, _, writer = await station.connect()
                writer.write(extended() + core())
                await station.until(lambda: len(station.reports(link_id)) == 2)
                assert station.server.refused_connections == 0
                await close(writer, *(link[2] for link in idle))

        run_on(loop, main)


class TestMemory:
    def test_the_oldest_unidentified_link_gives_way(self, loop: str) -> None:
        async def main() -> None:
            async with listening(LinkSettings(buffer_budget_bytes=16 * MIB)) as station:
                named, _, real = await station.connect()
                real.write(extended())
                await station.until(lambda: bool(station.reports(named)))
                small, _, quiet = await station.connect()
                quiet.write(core()[:20])
                hostile = [await station.connect() for _ in range(3)]
                for link_id, _, writer in hostile:
                    writer.write(head(*UHD) + bytes(6 * MIB))
                    await station.until(
                        lambda i=link_id: (  # type: ignore[misc]
                            station.closed_reason(hostile[0][0]) is not None
                            or buffered(station, i) > 6 * MIB
                        )
                    )
                first = hostile[0][0]
                assert "half-received packets take too much memory" in (
                    station.closed_reason(first) or ""
                )
                others = (named, small, hostile[1][0])
                assert [station.closed_reason(i) for i in others] == [None] * 3
                (problem,) = limits(station, MEMORY)
                assert f"unidentified link {first} closed" in (problem or "")
                await close(real, quiet, *(link[2] for link in hostile))

        run_on(loop, main)

    def test_an_identified_link_loses_its_half_packet_only(self, loop: str) -> None:
        async def main() -> None:
            settings = LinkSettings(buffer_budget_bytes=8 * MIB, limit_alarm_s=0.05)
            async with listening(settings) as station:
                link_id, _, writer = await station.connect()
                image = damaged_image(*UHD)
                writer.write(extended() + image + core())
                await station.until(lambda: len(station.reports(link_id)) == 2)
                assert station.closed_reason(link_id) is None
                problem = limits(station, MEMORY)[0]
                assert f"half-received packet of link {link_id} dropped" in (problem or "")
                await station.until(lambda: limits(station, MEMORY)[-1] is None)
                await close(writer)

        run_on(loop, main)

    def test_the_sum_of_all_links_stays_within_the_budget(self, loop: str) -> None:
        async def main() -> None:
            settings = LinkSettings(buffer_budget_bytes=20 * MIB)
            async with listening(settings) as station:
                links = [await station.connect() for _ in range(12)]
                for _, _, writer in links:
                    writer.write(extended())
                await station.until(lambda: all(station.reports(i) for i, _, _ in links))
                sprays = [
                    asyncio.ensure_future(write_for_ever(w, head(*UHD) + bytes(20 * MIB)))
                    for _, _, w in links
                ]
                peak = 0

                def is_fed() -> bool:
                    nonlocal peak
                    sessions = [c.session for c in station.server.connections.values()]
                    peak = max(peak, sum(s.buffered_bytes for s in sessions if s is not None))
                    return sum(s.bytes_received for s in sessions if s is not None) > 200 * MIB

                await station.until(is_fed)
                print(f"peak of half-received packets: {peak / MIB:.1f} MiB, budget 20 MiB")
                assert 10 * MIB < peak <= 20 * MIB
                for spray in sprays:
                    spray.cancel()
                await asyncio.gather(*sprays, return_exceptions=True)
                for _, _, writer in links:
                    writer.transport.abort()

        run_on(loop, main)


class TestEnd:
    def test_the_end_of_a_hostile_link_is_searched_in_turns(self, loop: str) -> None:
        """Packets hidden in a claimed image come out, and others get their turn meanwhile."""

        async def main() -> None:
            async with listening() as station:
                hostile_id, _, hostile = await station.connect()
                good_id, _, good = await station.connect()
                count = 20_000
                hostile.write(head(*UHD) + ack(9) * count)
                await station.until(lambda: buffered(station, hostile_id) > 11 * count)
                await close(hostile)
                await station.until(lambda: bool(station.reports(hostile_id)))
                good.write(core())
                await station.until(lambda: bool(station.reports(good_id)))
                assert station.closed_reason(hostile_id) is None
                assert len(station.reports(hostile_id)) < count
                await station.until(lambda: station.closed_reason(hostile_id) is not None)
                assert len(station.reports(hostile_id)) == count
                assert set(station.server.unfinished) == {good_id}
                await close(good)

        run_on(loop, main)


class TestStationPaused:
    def test_bytes_in_the_kernel_are_no_stall(self, loop: str) -> None:
        """The station's time goes on by 3 s while the rest of an image lies in the kernel."""

        async def main() -> None:
            async with listening() as station:
                link_id, _, writer = await station.connect()
                image = damaged_image(100, 200)
                writer.write(extended() + image[:READ])
                await station.until(lambda: buffered(station, link_id) >= READ)
                real_clock = station.server.now_ns
                transport = station.server.connections[link_id]._transport
                assert transport is not None
                transport.pause_reading()
                writer.write(image[READ:])
                await writer.drain()
                session = station.server.connections[link_id].session
                assert session is not None
                connection = station.server.connections[link_id]
                while not connection._has_unread(session):
                    await asyncio.sleep(0)
                station.server.now_ns = lambda: real_clock() + 3_000_000_000
                station.server.tick()
                assert session.counters.abandoned == 0
                transport.resume_reading()
                await station.until(lambda: session.counters.bad_hash == 1)
                assert session.counters.abandoned == 0
                assert len(station.of(LinkOpened)) == 1
                await close(writer)

        run_on(loop, main)
