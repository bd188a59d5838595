"""The receiving ends of the load: the station with everything measured, and a bare sink."""

import asyncio
import time
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from benches.station.started import fly_apps

from recon import wire
from recon.link.server import LinkServer
from recon.link.settings import LinkSettings
from recon.model.event import CommandSent, LinkClosed, PacketReceived
from recon.model.person import Person, Role
from recon.model.report import CoreReport, ExtendedReport, ImageReport
from recon.site import default_site
from recon.station.api_views.service import Service
from recon.station.kernel.build import first_state
from recon.station.kernel.driver import AsyncioDriver, freeze_loaded_objects, station_clock
from recon.station.state.steps import StepTaken

CONSOLE_PERIOD_S = 0.1
ENDING_S = 120.0


@dataclass(frozen=True, slots=True)
class Load:
    """How much is sent."""

    apps: int
    streams: int
    seconds: float
    image_rows: int = 720
    image_cols: int = 1280


@dataclass(frozen=True, slots=True)
class Sent:
    """What the apps sent, by kind, and when each app's first stop arrived."""

    packets: dict[str, int]
    first_command_at_s: list[float]


@dataclass(slots=True)
class Received:
    """What came out of the station's steps."""

    stamps_from_s: float
    core: int = 0
    extended: int = 0
    images: int = 0
    latencies_s: list[float] = field(default_factory=list)
    links_closed: int = 0
    emergency_sent_at_s: list[float] = field(default_factory=list)

    def observe(self, step: StepTaken) -> None:
        """Count an event the station has taken into its state, and read its age."""
        match step.event:
            case PacketReceived(_, CoreReport() as report):
                self.core += 1
                assert report.reported_altitude_m is not None
                sent_at_s = self.stamps_from_s + report.reported_altitude_m
                self.latencies_s.append(time.monotonic() - sent_at_s)
            case PacketReceived(_, ExtendedReport()):
                self.extended += 1
            case PacketReceived(_, ImageReport()):
                self.images += 1
            case LinkClosed():
                self.links_closed += 1
            case CommandSent():
                self.emergency_sent_at_s.append(time.monotonic())


@dataclass(frozen=True, slots=True)
class Outcome:
    """One measured run of the station."""

    sent: Sent
    received: Received
    cpu_share: float
    waited_share: float
    """Time ready to run but without a core, because others had them, per time that it ran."""
    state_ms: list[float]
    ordered: int
    ordered_at_s: float

    @property
    def lost(self) -> dict[str, int]:
        """Packets sent and not received, by kind."""
        return {
            kind: self.sent.packets.get(kind, 0) - getattr(self.received, kind)
            for kind in ("core", "extended", "images")
        }

    def latency_ms(self, percentile: float) -> float:
        """Socket-to-state latency."""
        return 1e3 * float(np.percentile(self.received.latencies_s, percentile))

    @property
    def fan_out_sent_ms(self) -> float:
        """From the order of "all stop" to its last packet on a socket."""
        return 1e3 * (max(self.received.emergency_sent_at_s[: self.ordered]) - self.ordered_at_s)

    @property
    def fan_out_read_ms(self) -> float:
        """From the order of "all stop" to the last app that has read it."""
        return 1e3 * (max(self.sent.first_command_at_s) - self.ordered_at_s)


async def measure_station(load: Load) -> Outcome:
    """Run a station, with a console's worth of states, under a load; halfway order "all stop"."""
    received, site = Received(time.monotonic()), default_site()
    driver = AsyncioDriver(first_state(site), station_clock(), received.observe)
    driver.links = links = LinkServer(driver.handle, driver.now_ns, LinkSettings())
    service = Service.around(driver, site, None)
    await links.start("127.0.0.1", 0)
    state_ms: list[float] = []
    tasks = [asyncio.create_task(driver.run()), asyncio.create_task(_console(service, state_ms))]
    freeze_loaded_objects()
    scheduled = ran_and_waited_ns()
    cpu_s, wall_s = time.process_time(), time.monotonic()
    sending = asyncio.create_task(_send(links.port, load, received.stamps_from_s))
    async with asyncio.timeout(load.seconds + ENDING_S):
        while received.core < load.apps * load.seconds * 5 and not sending.done():
            await asyncio.sleep(0.01)
    ordered_at_s = time.monotonic()
    results = service.orders.all_stop(Person("bench", Role.OPERATOR)).results
    sent = await sending
    cpu_share = (time.process_time() - cpu_s) / (time.monotonic() - wall_s)
    ran_ns, waited_ns = (b - a for a, b in zip(scheduled, ran_and_waited_ns(), strict=True))
    async with asyncio.timeout(ENDING_S):
        while received.links_closed < load.apps:
            await asyncio.sleep(0.01)
    for task in tasks:
        task.cancel()
    await links.stop()
    ordered = sum(result.accepted for result in results)
    waited_share = waited_ns / max(1, ran_ns)
    return Outcome(sent, received, cpu_share, waited_share, state_ms, ordered, ordered_at_s)


def ran_and_waited_ns() -> tuple[int, int]:
    """What Linux says of this thread: time on a core, time in the queue for one."""
    ran, waited, _ = Path("/proc/thread-self/schedstat").read_text().split()
    return int(ran), int(waited)


@dataclass(frozen=True, slots=True)
class SinkOutcome:
    """The same load on a server that takes packets off the stream and keeps nothing."""

    cpu_share: float
    latencies_s: list[float]

    def latency_ms(self, percentile: float) -> float:
        """Socket-to-packet latency: what the machine was good for in this run."""
        return 1e3 * float(np.percentile(self.latencies_s, percentile))


async def measure_sink(load: Load) -> SinkOutcome:
    """Run a bare asyncio server with a deframer under a load."""
    latencies_s: list[float] = []
    loop, stamps_from_s = asyncio.get_running_loop(), time.monotonic()
    server = await loop.create_server(lambda: _Sink(stamps_from_s, latencies_s), "127.0.0.1", 0)
    cpu_s, wall_s = time.process_time(), time.monotonic()
    sent = await _send(server.sockets[0].getsockname()[1], load, stamps_from_s)
    share = (time.process_time() - cpu_s) / (time.monotonic() - wall_s)
    async with asyncio.timeout(ENDING_S):
        while len(latencies_s) < sent.packets["core"]:
            await asyncio.sleep(0.01)
    server.close()
    return SinkOutcome(share, latencies_s)


class _Sink(asyncio.Protocol):
    def __init__(self, stamps_from_s: float, latencies_s: list[float]) -> None:
        self.stamps_from_s = stamps_from_s
        self.latencies_s = latencies_s
        self.deframer = wire.Deframer()

    def data_received(self, data: bytes) -> None:
        for packet in self.deframer.feed(data):
            if isinstance(packet, wire.CoreTelemetry):
                sent_at_s = self.stamps_from_s + packet.altitude_m
                self.latencies_s.append(time.monotonic() - sent_at_s)


async def _console(service: Service, state_ms: list[float]) -> None:
    while True:
        await asyncio.sleep(CONSOLE_PERIOD_S)
        begin_s = time.perf_counter()
        service.state().model_dump_json()
        state_ms.append(1e3 * (time.perf_counter() - begin_s))


async def _send(port: int, load: Load, stamps_from_s: float) -> Sent:
    options = ["--apps", load.apps, "--streams", load.streams, "--seconds", load.seconds]
    options += ["--image-rows", load.image_rows, "--image-cols", load.image_cols]
    told = await fly_apps(port, *options, "--stamps-from-s", stamps_from_s)
    return Sent(told["sent"], [times[0] for times in told["stops"] if times])
