"""The shell around the messages: a station's client on one side, the SDK's server on the other.

Four loops: states, pictures and maps, the audit, and what is sent again every `AGAIN_EVERY_S`: what
a client that subscribes later could not know otherwise, the site and each vehicle's newest mission.
While the station's states do not come, nothing is sent but a line of the log.
"""

import asyncio
import time
from collections.abc import AsyncIterator, Awaitable, Callable
from contextlib import asynccontextmanager, suppress

from recon.client import BadAnswerError, ClientError, Station
from recon.client.messages import StateMessage
from recon.gateway.contact import StationContact
from recon.gateway.endpoints import Endpoint
from recon.gateway.foxglove.audit_messages import audit_messages, gateway_line
from recon.gateway.foxglove.live_message import GEOJSON, LOG, LiveMessage
from recon.gateway.foxglove.live_topics import LiveTopics
from recon.gateway.foxglove.newest_pictures import NewestPictures
from recon.gateway.foxglove.site_message import SITE_TOPIC, site_message
from recon.gateway.foxglove.vehicle_messages import Shown, is_another_run, new_samples
from recon.record.mcap.foxglove import LOG_TOPIC

STATE_WITHIN_S = 0.25
AUDIT_EVERY_S = 0.5
AUDIT_PAGE = 100
AGAIN_EVERY_S = 2.0


class FoxgloveGateway:
    """A running gateway of one station; `say` prints a line."""

    def __init__(self, station: Station, say: Callable[[str], None]) -> None:
        self._station, self._say = station, say
        self._topics = LiveTopics()
        self._pictures = NewestPictures(station.pictures, self._topics)
        self._shown: Shown = {}
        self._missions: dict[str, LiveMessage] = {}
        """The newest of each topic."""
        self._seen: StateMessage | None = None
        self._audit_n = 0
        """The newest entry of the audit that was shown."""
        self._problem = ""
        """What was said last of pictures that cannot be read."""
        self._heard_s = time.monotonic()
        """When the newest state was made, on this computer's monotonic clock."""
        self._contact = StationContact()

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
            self._repeat(AGAIN_EVERY_S, self._show_again),
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
            if self._seen is not None and is_another_run(self._seen, message):
                self._forget()
            self._seen, self._heard_s = message, time.monotonic() - age_s
        self._mind_silence()
        if message is not None:
            self._shown, messages = new_samples(self._shown, message, age_s)
            for each in messages:
                self._topics.publish(each)

    def _forget(self) -> None:
        """Forget what was shown; the audit begins anew."""
        self._shown, self._audit_n = {}, 0
        self._missions = {}
        self._pictures.forget()

    def _mind_silence(self) -> None:
        """Say when the station's states stop coming, and when they come again."""
        line = self._contact.change(self._heard_s, time.monotonic())
        if line is not None:
            level = "error" if self._contact.is_lost else "info"
            self._say(line)
            self._topics.publish(gateway_line(line, level, time.time_ns()))

    async def _show_pictures(self, message: StateMessage | None, age_s: float) -> None:
        if message is not None:
            try:
                await self._pictures.show(message, age_s)
            except BadAnswerError as problem:
                self._say_once(str(problem))
            except ClientError:
                # Read again with the next state.
                return

    def _say_once(self, problem: str) -> None:
        if problem != self._problem:
            self._problem = problem
            self._say(problem)

    async def _show_audit(self) -> None:
        while not self._contact.is_lost:
            missions, after = self._missions, self._audit_n
            page = await self._station.audit(after, AUDIT_PAGE)
            if missions is not self._missions or not page.entries:
                # Of another run of the station, or all that there is.
                return
            for entry in page.entries:
                for message in audit_messages(entry):
                    self._topics.publish(message)
                    if message.kind is GEOJSON:
                        missions[message.topic] = message
            self._audit_n = page.entries[-1].n

    async def _show_again(self) -> None:
        self._topics.wants(LOG_TOPIC, LOG)
        if self._contact.is_lost or self._seen is None:
            return
        if self._topics.wants(SITE_TOPIC, GEOJSON):
            self._topics.publish(site_message(self._seen))
        for message in self._missions.values():
            self._topics.publish(message)
