"""The newest camera frames, shade map and forecast, read while somebody is subscribed.

One is read at a time, and each once. What is older than `PICTURE_UNDER_S` is not live: shadows have
moved on.
"""

import time
from collections.abc import Awaitable, Callable
from typing import Any

from recon.client.messages import StateMessage
from recon.client.pictures import CameraFrame, PictureCommands
from recon.client.telemetry import FrameStatus
from recon.gateway.foxglove.live_message import GRID, JPEG, LiveMessage
from recon.gateway.foxglove.live_topics import LiveTopics
from recon.model.units import NS_PER_MS
from recon.record.mcap import foxglove

MAPS_EVERY_S = 1.0
PICTURE_UNDER_S = 10.0


class NewestPictures:
    """Publishes what a state says is new."""

    def __init__(self, pictures: PictureCommands, topics: LiveTopics) -> None:
        self._pictures, self._topics = pictures, topics
        self._frames: dict[str, CameraFrame] = {}
        """The frame that was read last of each vehicle."""
        self._newest: dict[str, int] = {}
        """What was published last in each topic: a frame's id, or the time of a map."""
        self._maps_due_s = 0.0

    def forget(self) -> None:
        """Forget what was published: another run of the station counts anew."""
        self._frames, self._newest = {}, {}

    async def show(self, message: StateMessage, state_age_s: float) -> None:
        """Read and publish what is new; raises `ClientError`."""
        serials = {telemetry.serial for telemetry in message.vehicles}
        self._frames = {serial: each for serial, each in self._frames.items() if serial in serials}
        for telemetry in message.vehicles:
            frame = telemetry.frame
            if telemetry.serial is None or frame is None:
                continue
            if frame.received_age_s + state_age_s < PICTURE_UNDER_S:
                await self._show_frame(telemetry.serial, frame, message.time_ns)
        if message.shade is None or time.monotonic() < self._maps_due_s:
            return
        self._maps_due_s = time.monotonic() + MAPS_EVERY_S
        made, sun = message.shade.map, message.shade.forecast
        if made is not None and made.captured_age_s + state_age_s < PICTURE_UNDER_S:
            at_ns = _at_ns(message.time_ns, made.captured_age_s)
            await self._show_map(foxglove.SHADE_TOPIC, at_ns, self._shade)
        if sun is not None and sun.issued_age_s + state_age_s < PICTURE_UNDER_S:
            at_ns = _at_ns(message.time_ns, sun.issued_age_s)
            await self._show_map(foxglove.SUN_TOPIC, at_ns, self._forecast)

    async def _show_frame(self, serial: str, frame: FrameStatus, time_ns: int) -> None:
        topic = foxglove.vehicle_topic(serial, "jpeg")
        if not self._topics.wants(topic, JPEG) or self._newest.get(topic) == frame.id:
            return
        known = self._frames.get(serial)
        if known is None or known.id != frame.id:
            known = self._frames[serial] = await self._pictures.frame(serial)
        if known.id == frame.id:
            # A newer one waits for the state that has its time.
            self._newest[topic] = frame.id
            at_ns = _at_ns(time_ns, frame.received_age_s)
            self._publish(topic, JPEG, at_ns, foxglove.jpeg_image(known.jpeg, serial, at_ns))

    async def _show_map(
        self, topic: str, at_ns: int, read: Callable[[], Awaitable[tuple[int, Any]]]
    ) -> None:
        if self._topics.wants(topic, GRID) and at_ns > self._newest.get(topic, 0):
            map_ns, grid = await read()
            self._newest[topic] = map_ns
            self._publish(topic, GRID, map_ns, grid)

    async def _shade(self) -> tuple[int, Any]:
        shade = await self._pictures.shade()
        return shade.captured_at_ns, foxglove.shade_grid(shade)

    async def _forecast(self) -> tuple[int, Any]:
        sun = await self._pictures.forecast()
        return sun.issued_at_ns, foxglove.forecast_grid(sun)

    def _publish(self, topic: str, kind: Any, at_ns: int, message: Any) -> None:
        self._topics.publish(LiveMessage(topic, kind, at_ns, message.SerializeToString()))


def _at_ns(time_ns: int, age_s: float) -> int:
    """Return a time of the station, which a state's ages give in whole milliseconds."""
    return (time_ns // NS_PER_MS - round(age_s * 1e3)) * NS_PER_MS
