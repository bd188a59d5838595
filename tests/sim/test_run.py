"""The shell on real sockets: every wait is for an event, with a limit."""

import asyncio
from collections.abc import AsyncIterator, Callable
from contextlib import asynccontextmanager, suppress
from dataclasses import dataclass, field, replace

import numpy as np
import pytest
from tests.patient_loop import run_patiently

from recon import wire
from recon.model.geo import GeoPoint
from recon.sim.app.camera_feed import FeedSettings
from recon.sim.app.faults import FaultKind, InjectedFault
from recon.sim.camera.frames import StillFrame
from recon.sim.errors import FrameSourceError
from recon.sim.fleet import IMAGER_SERIAL, ImagerSetup, SimulationConfig
from recon.sim.run import run_fleet

LIMIT_S = 120.0
PICTURE = np.arange(9 * 16 * 3, dtype=np.uint8).reshape(9, 16, 3)
CONFIG = SimulationConfig(home=GeoPoint(41.9, -93.6, 275.0), vehicle_count=1)


@dataclass(eq=False)
class Link:
    """One connection as the station sees it."""

    writer: asyncio.StreamWriter
    packets: list[wire.Packet] = field(default_factory=list)
    is_closed: bool = False

    @property
    def serials(self) -> set[bytes]:
        return {p.serial for p in self.packets if isinstance(p, wire.ExtendedTelemetry)}

    def of(self, kind: type) -> list[wire.Packet]:
        return [p for p in self.packets if isinstance(p, kind)]


class Station:
    """A server that keeps what it hears; `until` waits for something to become true."""

    def __init__(self) -> None:
        self.links: list[Link] = []
        self.lines: list[str] = []
        self._news = asyncio.Condition()
        self._server: asyncio.Server | None = None
        self.port = 0

    async def open(self) -> None:
        self._server = await asyncio.start_server(self._serve, "127.0.0.1", self.port)
        self.port = self._server.sockets[0].getsockname()[1]

    async def close(self) -> None:
        if self._server is not None:
            self._server.close()
        for link in self.links:
            link.writer.close()
            with suppress(OSError):
                await link.writer.wait_closed()

    async def until(self, is_true: Callable[[], bool]) -> None:
        async with asyncio.timeout(LIMIT_S), self._news:
            await self._news.wait_for(is_true)

    async def _serve(self, reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        link, deframer = Link(writer), wire.Deframer()
        self.links.append(link)
        with suppress(OSError):
            while data := await reader.read(65_536):
                link.packets += deframer.feed(data)
                await self._tell()
        link.is_closed = True
        await self._tell()
        writer.close()

    async def _tell(self) -> None:
        async with self._news:
            self._news.notify_all()


@asynccontextmanager
async def flying(config: SimulationConfig) -> AsyncIterator[Station]:
    station = Station()
    await station.open()
    config = replace(config, station_port=station.port)
    task = asyncio.create_task(run_fleet(config, station.lines.append))
    try:
        yield station
    finally:
        task.cancel()
        with suppress(asyncio.CancelledError):
            await task
        await station.close()


def with_fault(kind: FaultKind, start_s: float, duration_s: float) -> SimulationConfig:
    return replace(CONFIG, faults=(InjectedFault(kind, "*", start_s, duration_s),))


def test_four_vehicles_connect_send_and_end() -> None:
    async def scenario() -> None:
        imager = ImagerSetup(StillFrame(PICTURE), FeedSettings(largest_fps_hz=10.0, latency_s=0.05))
        async with flying(
            replace(CONFIG, vehicle_count=4, imagers={IMAGER_SERIAL: imager})
        ) as station:
            await station.until(
                lambda: len(station.links) == 4 and all(len(x.packets) > 8 for x in station.links)
            )
            await station.until(lambda: any(x.of(wire.Image) for x in station.links))
            serials = set().union(*(link.serials for link in station.links))
            assert serials == {b"SIM-IMAGER", b"SIM-1", b"SIM-2", b"SIM-3"}
            for link in station.links:
                assert isinstance(link.packets[0], wire.MessageString)
            image = next(x for x in station.links if x.of(wire.Image)).of(wire.Image)[0]
            assert np.array_equal(image.pixels, PICTURE)
        assert all(link.is_closed for link in station.links)

    run_patiently(scenario())


def test_a_command_is_acknowledged_and_flown() -> None:
    async def scenario() -> None:
        async with flying(CONFIG) as station:
            await station.until(lambda: bool(station.links and station.links[0].packets))
            (link,) = station.links
            waypoints = [
                wire.Waypoint(
                    latitude_deg=41.9 + 0.0005 * i,
                    longitude_deg=-93.6,
                    altitude_m=20.0,
                    corner_radius_m=0.2,
                    speed_mps=5.0,
                    loiter_time_s=float("nan"),
                    gimbal_pitch_deg=float("nan"),
                )
                for i in (1, 2)
            ]
            mission = wire.ExecuteWaypointMission(
                land_at_end=0, curved_flight=0, waypoints=waypoints
            )
            link.writer.write(wire.encode(mission))
            await station.until(lambda: bool(link.of(wire.Acknowledgment)))
            await station.until(lambda: any(p.is_flying for p in link.of(wire.CoreTelemetry)))
            assert any("mission of 2 waypoints" in line for line in station.lines)

    run_patiently(scenario())


def test_an_app_reconnects_after_the_station_was_gone() -> None:
    async def scenario() -> None:
        async with flying(CONFIG) as station:
            await station.until(lambda: bool(station.links and station.links[0].packets))
            await station.close()
            await station.open()
            await station.until(lambda: len(station.links) == 2 and bool(station.links[1].packets))
            assert isinstance(station.links[1].packets[0], wire.MessageString)

    run_patiently(scenario())


def test_restart_closes_and_reconnects() -> None:
    async def scenario() -> None:
        async with flying(with_fault(FaultKind.RESTART, 0.5, 0.1)) as station:
            await station.until(lambda: len(station.links) == 2 and bool(station.links[1].serials))
            await station.until(lambda: station.links[0].is_closed)
            assert station.links[0].serials == station.links[1].serials == {b"SIM-1"}

    run_patiently(scenario())


def test_half_open_leaves_the_old_socket_silent_and_open() -> None:
    async def scenario() -> None:
        async with flying(with_fault(FaultKind.HALF_OPEN, 0.5, 600.0)) as station:
            await station.until(lambda: len(station.links) == 2)
            old, new = station.links
            received = len(old.packets)
            await station.until(lambda: len(new.of(wire.ExtendedTelemetry)) >= 2)
            assert len(old.packets) == received
            assert not old.is_closed
            assert new.serials == {b"SIM-1"}

    run_patiently(scenario())


def test_second_link_sends_beside_the_first_and_closes() -> None:
    async def scenario() -> None:
        async with flying(with_fault(FaultKind.SECOND_LINK, 0.5, 1.2)) as station:
            await station.until(lambda: len(station.links) == 2 and bool(station.links[1].serials))
            first, second = station.links
            assert second.serials == {b"SIM-1"}
            await station.until(lambda: second.is_closed)
            received = len(first.packets)
            await station.until(lambda: len(first.packets) > received)
            assert not first.is_closed

    run_patiently(scenario())


def test_without_a_station_it_retries_and_ends_when_cancelled() -> None:
    async def scenario() -> None:
        lines: list[str] = []
        logged = asyncio.Event()

        def say(line: str) -> None:
            lines.append(line)
            if "no station" in line:
                logged.set()

        async with asyncio.timeout(LIMIT_S):
            task = asyncio.create_task(run_fleet(replace(CONFIG, station_port=1), say))
            await logged.wait()
            task.cancel()
            with pytest.raises(asyncio.CancelledError):
                await task

    run_patiently(scenario())


class Broken:
    """Pictures that cannot be had."""

    def prepare(self) -> None:
        return None

    def render(self, view: object) -> np.ndarray:
        raise FrameSourceError("expected a picture, got none")


def test_a_frame_that_cannot_be_rendered_is_reported_and_the_flight_continues() -> None:
    async def scenario() -> None:
        imager = ImagerSetup(Broken(), FeedSettings(largest_fps_hz=10.0))
        async with flying(replace(CONFIG, imagers={IMAGER_SERIAL: imager})) as station:
            await station.until(lambda: sum("frame lost" in x for x in station.lines) > 2)
            await station.until(lambda: len(station.links[0].packets) > 5)

    run_patiently(scenario())
