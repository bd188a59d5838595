"""The shell around the messages: a station's client on one side, the SDK's server on the other.

Four loops: states, pictures and maps, the audit, and what is kept. Kept is what a client that
subscribes later could not know otherwise: the site, and each vehicle's newest mission; it is sent
again every `KEPT_EVERY_S`. While the station's states do not come, nothing is sent but a line of
the log.
"""

import asyncio
import time
from collections.abc import AsyncIterator, Awaitable, Callable
from contextlib import asynccontextmanager, suppress

from recon.client import ClientError, Station
from recon.client.messages import StateMessage
from recon.gateway.endpoints import Endpoint
from recon.gateway.foxglove.audit_messages import audit_messages, gateway_line
from recon.gateway.foxglove.live_message import GEOJSON, LOG, LiveMessage
from recon.gateway.foxglove.live_topics import LiveTopics
from recon.gateway.foxglove.newest_pictures import NewestPictures
from recon.gateway.foxglove.site_message import SITE_TOPIC, site_message
from recon.gateway.foxglove.vehicle_messages import Shown, new_samples
from recon.model.units import NS_PER_S
from recon.model.vehicle import LIVE_UNDER_S
from recon.record.mcap.foxglove import LOG_TOPIC

STATE_WITHIN_S = 0.25
AUDIT_EVERY_S = 0.5
AUDIT_PAGE = 100
KEPT_EVERY_S = 2.0
GONE = "no states from the station: all topics stop"


class FoxgloveGateway:
    """A running gateway of one station; `say` prints a line."""

    def __init__(self, station: Station, say: Callable[[str], None]) -> None:
        self._station, self._say = station, say
        self._topics = LiveTopics()
        self._pictures = NewestPictures(station.pictures, self._topics)
        self._shown: Shown = {}
        self._kept: dict[str, LiveMessage] = {}
        self._audit_n = 0
        """The newest entry of the audit that was shown."""
        self._run_started_ns = 0
        self._heard_s = time.monotonic()
        """When the newest state was made, on this computer's monotonic clock."""
        self._is_heard = True

    @asynccontextmanager
    async def listening(self, place: Endpoint) -> AsyncIterator[Endpoint]:
        """Listen and yield where; raises `GatewayError`."""
        bound = self._topics.start(place)
        try:
            yield bound
        finally:
            await self._topics.stop()

    async def run(self) -> None:
        """Pass on until cancelled; raises the `ClientError` that ends the stream of states."""
        loops = (
            self._on_states(self._show_state),
            self._on_states(self._show_pictures),
            self._repeat(AUDIT_EVERY_S, self._show_audit),
            self._repeat(KEPT_EVERY_S, self._show_kept),
        )
        tasks = [asyncio.create_task(loop) for loop in loops]
        try:
            await asyncio.gather(*tasks)
        finally:
            for task in tasks:
                task.cancel()

    async def _on_states(
        self, work: Callable[[StateMessage | None, float], Awaitable[None]]
    ) -> None:
        """Work on each newest state, with its age; on None where none has come for a while."""
        number = 0
        while True:
            seen = await self._station.next_state(number, STATE_WITHIN_S)
            if seen is None:
                await work(None, 0.0)
            else:
                state, age_s = seen
                number = state.number
                await work(state.message, age_s)

    async def _repeat(self, every_s: float, work: Callable[[], Awaitable[None]]) -> None:
        while True:
            # The loop of states says that the station does not answer.
            with suppress(ClientError):
                await work()
            await asyncio.sleep(every_s)

    async def _show_state(self, message: StateMessage | None, age_s: float) -> None:
        if message is not None:
            self._heard_s = time.monotonic() - age_s
            self._mind_restart(message.run_started_ns)
        self._mind_silence()
        if message is not None:
            self._shown, messages = new_samples(self._shown, message, age_s)
            for each in messages:
                self._topics.publish(each)

    def _mind_restart(self, run_started_ns: int) -> None:
        """Forget what was shown of another run of the station; its audit begins anew."""
        if abs(run_started_ns - self._run_started_ns) > NS_PER_S:
            self._run_started_ns = run_started_ns
            self._shown, self._audit_n = {}, 0
            self._kept.clear()

    def _mind_silence(self) -> None:
        """Say when the station's states stop coming, and when they come again."""
        is_heard = time.monotonic() - self._heard_s < LIVE_UNDER_S
        if is_heard != self._is_heard:
            self._is_heard = is_heard
            text = "the station is back" if is_heard else GONE
            level = "info" if is_heard else "error"
            self._say(text)
            self._topics.publish(gateway_line(text, level, time.time_ns()))

    async def _show_pictures(self, message: StateMessage | None, age_s: float) -> None:
        if message is not None:
            # Read again with the next state.
            with suppress(ClientError):
                await self._pictures.show(message, age_s)

    async def _show_audit(self) -> None:
        page = await self._station.audit(self._audit_n, AUDIT_PAGE)
        while page.entries:
            for entry in page.entries:
                for message in audit_messages(entry):
                    self._topics.publish(message)
                    if message.kind is GEOJSON:
                        self._kept[message.topic] = message
            self._audit_n = page.entries[-1].n
            page = await self._station.audit(self._audit_n, AUDIT_PAGE)

    async def _show_kept(self) -> None:
        self._topics.wants(LOG_TOPIC, LOG)
        if self._topics.wants(SITE_TOPIC, GEOJSON):
            drawing = await self._station.site.drawing()
            zones = await self._station.zones.in_force()
            self._kept[SITE_TOPIC] = site_message(drawing.features, zones, time.time_ns())
        if self._is_heard:
            for message in self._kept.values():
                self._topics.publish(message)
