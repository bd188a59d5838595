"""`recon replay FILE`: a recorded flight in the console, on loopback.

The screens read the same API as of a live station: `ReplayStation` takes the driver's place, with
a state and a clock of the record. It has no links and takes no events; the API refuses what orders
or changes anything (`api/replay_routes.py`), and nothing is written.
"""

import asyncio
import time
from collections.abc import Awaitable, Callable
from contextlib import AsyncExitStack, suppress
from dataclasses import dataclass
from pathlib import Path

from recon import version
from recon.api import schema
from recon.api.login import Login
from recon.model.errors import RecordError
from recon.model.event import Event
from recon.model.imagery import Frame, GroundImage
from recon.model.units import ns_to_seconds, seconds_to_ns
from recon.station.api_views.app import create_app
from recon.station.api_views.service import Service
from recon.station.host.base_maps import maps_of
from recon.station.host.http_servers import (
    listen,
    loopback_server,
    stop_on_signals,
    url_of,
)
from recon.station.imaging.mosaic import mosaic, newest_images
from recon.station.kernel.driver import freeze_loaded_objects
from recon.station.recording.playback import Moment, Playback
from recon.station.recording.replay_log import RecordedLog
from recon.station.recording.transport import Transport
from recon.station.state.station import Station

INTERVAL_S = 0.1
"""Interval between two states, as for a live console."""
FASTEST_EXACT = 10.0
"""A computer steps a small fleet twenty times as fast as it flew; faster, keyframes are shown."""

BEFORE_TAKEOFF_NS = seconds_to_ns(2.0)
"""Time before the first takeoff at which a replay begins."""

HOST = "127.0.0.1"
NO_SITE = (
    "A record has no base maps: start recon replay with --site FOLDER to see those of its site"
)


class ReplayStation:
    """Plays a record; implements `RunningStation` for the service and `Replaying` for the API."""

    def __init__(
        self, path: Path, playback: Playback, now_s: Callable[[], float] = time.monotonic
    ) -> None:
        """Begin at the record's start, paused. `now_s` is the computer's monotonic clock."""
        self.links = None
        self.started_at_ns = playback.begins_ns
        self.log = RecordedLog(path, self.now_ns, playback.ends_ns)
        self.playback = playback
        self._name = path.name
        self._now_s = now_s
        self._moment = playback.moment
        self._transport = Transport(playback.begins_ns, playback.ends_ns, playback.begins_ns)
        self._trouble = playback.trouble
        self._moving = asyncio.Lock()
        self._is_as_opened = True

    @property
    def station(self) -> Station:
        """The state of the moment that is shown."""
        return self._moment.station

    def now_ns(self) -> int:
        """Return the record's time: ages count up to it."""
        return self._moment.at_ns

    def handle(self, event: Event) -> None:
        """Take no event: what is replayed has happened."""

    def view(self) -> schema.ReplayView:
        """Return where the replay is."""
        return schema.ReplayView(
            file=self._name,
            duration_s=self._since_begin_s(self.playback.ends_ns),
            position_s=self._since_begin_s(self._moment.at_ns),
            speed=self._transport.speed,
            is_playing=self._transport.as_of(self._now_s()).is_playing,
            trouble=self._trouble or None,
        )

    def marks(self) -> schema.ReplayMarksView:
        """Return the alarms and orders of the record, as far as it was read."""
        return self.log.marks(self.playback.begins_ns)

    async def change(self, asked: schema.ReplayTransport) -> schema.ReplayView:
        """Play, pause, change the speed or seek; return when the state is that of the moment."""
        self._is_as_opened = False
        now_s, transport = self._now_s(), self._transport
        if asked.speed is not None:
            transport = transport.at_speed(asked.speed, now_s)
        if asked.position_s is not None:
            at_ns = self.playback.begins_ns + seconds_to_ns(asked.position_s)
            transport = transport.sought(at_ns, now_s)
        if asked.is_playing is not None:
            transport = transport.played(now_s) if asked.is_playing else transport.paused(now_s)
        self._transport = transport
        await self.follow(is_exact=True)
        return self.view()

    def show(self, moment: Moment) -> None:
        """Have the screens show a moment."""
        self._moment = moment

    async def run(self) -> None:
        """Follow the transport until cancelled."""
        while True:
            await asyncio.sleep(INTERVAL_S)
            await self.go_to_takeoff()
            if self._transport.is_playing:
                await self.follow(is_exact=self._transport.speed <= FASTEST_EXACT)

    async def go_to_takeoff(self) -> None:
        """Go to just before the first takeoff, once it was read, unless a person moved first."""
        takeoff_ns = self.log.first_flight_ns
        if self._is_as_opened and takeoff_ns is not None:
            self._is_as_opened = False
            at_ns = takeoff_ns - BEFORE_TAKEOFF_NS
            self._transport = self._transport.sought(at_ns, self._now_s())
            await self.follow(is_exact=True)

    async def follow(self, *, is_exact: bool) -> None:
        """Show the transport's moment."""
        async with self._moving:
            self._transport = now = self._transport.as_of(self._now_s())
            try:
                self.show(await asyncio.to_thread(self._moved, now, is_exact))
            except RecordError as problem:
                self._trouble = str(problem)
                stopped = self._transport.paused(self._now_s())
                self._transport = stopped.sought(self._moment.at_ns, self._now_s())

    def _moved(self, now: Transport, is_exact: bool) -> Moment:
        return self.playback.move(now.at_ns, is_exact=is_exact or not now.is_playing)

    def _since_begin_s(self, at_ns: int) -> float:
        return ns_to_seconds(at_ns - self.playback.begins_ns)


@dataclass(slots=True)
class ReplayService(Service):
    """The service of a live station, with pixels from the record."""

    playback: Playback | None = None

    def frame(self, serial: str) -> Frame | None:
        """Return a vehicle's newest frame."""
        newest = self.driver.station.frames.get(serial)
        return newest if self.playback is None else self.playback.frame(newest)

    def ground_image(self) -> GroundImage | None:
        """Return the newest ground image of all imaging drones."""
        images = newest_images(self.driver.station.imaging)
        if self.playback is None:
            return mosaic(images)
        projected = (self.playback.projected(each) for each in images)
        return mosaic([each for each in projected if each is not None])


def replay_service(replay: ReplayStation) -> ReplayService:
    """Return the service around a replay."""
    start = replay.playback.start
    service = ReplayService.around(replay, start.site, None, replay.log)
    assert isinstance(service, ReplayService)
    service.playback, service.replay = replay.playback, replay.view
    # A number stays its vehicle's wherever one seeks: by the order at the end.
    service.numbers.of(start.station.fleet)
    with suppress(RecordError):  # damage there is reported when one goes there
        service.numbers.of(replay.playback.move(replay.playback.ends_ns).station.fleet)
    replay.playback.move(replay.playback.begins_ns)
    return service


async def run_replay(
    path: Path,
    http_port: int,
    console: Path | None,
    on_start: Callable[[str, ReplayStation], Awaitable[None]],
    site_folder: Path | None = None,
) -> None:
    """Serve a recorded flight until SIGINT or SIGTERM; `on_start` gets the address.

    Of the site's folder only the base maps are shown; the site is the record's.
    Raises OSError, `RecordError` for a file that cannot be replayed, and `StartError`.
    """
    async with AsyncExitStack() as stack:
        playback = Playback(path)
        stack.callback(playback.close)
        replay = ReplayStation(path, playback)
        service = replay_service(replay)
        sock = listen(HOST, http_port, "--http-port")
        stack.callback(sock.close)
        replay.log.start()
        stack.callback(replay.log.close)
        maps = maps_of(site_folder, lambda: service.site, NO_SITE)
        stack.callback(maps.close)
        app = create_app(service, console, version(), replay=replay, maps=maps)
        server = loopback_server(app, Login(report=replay.handle), HOST)
        playing = asyncio.create_task(replay.run())
        stack.callback(playing.cancel)
        freeze_loaded_objects()
        stop_on_signals([server])
        serving = asyncio.create_task(server.serve(sockets=[sock]))
        await on_start(url_of(HOST, sock), replay)
        await asyncio.wait((serving, playing), return_when=asyncio.FIRST_COMPLETED)
        server.should_exit = True
        await serving
        if playing.done():
            playing.result()
