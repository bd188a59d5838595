"""The server of Foxglove's SDK: topics that clients subscribe to, and nothing that they may do.

The SDK's threads talk to the clients. Each client has a queue of `BACKLOG` messages; when it is
full the oldest is dropped, so one that does not read disturbs nobody. Clients cannot publish, call
or set anything: the server offers no such capability, and answers so. A frame of over 16 MiB
closes its connection.
"""

import asyncio
import logging
import threading

import foxglove

from recon.gateway.endpoints import Endpoint, shown_endpoint
from recon.gateway.errors import GatewayError
from recon.gateway.foxglove.live_message import LiveMessage, TopicKind

BACKLOG = 256
"""Messages that wait for one client: a second of 12 vehicles, or a minute of maps and frames."""
MOST_TOPICS = 1024
"""An app that reports a new serial again and again must not fill memory with topics."""
STOPPED_WITHIN_S = 1.0
_BIND_PROBLEM = "FoxgloveError: Failed to bind port: "


class LiveTopics:
    """Topics by name; one is advertised when it is first asked about or published."""

    def __init__(self) -> None:
        self._context = foxglove.Context()
        self._channels: dict[str, foxglove.Channel] = {}
        self._server: foxglove.websocket.WebSocketServer | None = None

    def start(self, place: Endpoint) -> Endpoint:
        """Listen; return the place with the port that was picked. Raises `GatewayError`."""
        # What clients do wrong would fill the terminal.
        logging.getLogger("foxglove").setLevel(logging.CRITICAL + 1)
        host, port = place
        try:
            self._server = foxglove.start_server(
                name="Recon",
                host=host,
                port=port,
                context=self._context,
                capabilities=[],
                message_backlog_size=BACKLOG,
            )
        except RuntimeError as problem:
            reason = str(problem).removeprefix(_BIND_PROBLEM)
            if "in use" in reason:
                reason = "in use, perhaps by another gateway"
            raise GatewayError(
                f"cannot open {shown_endpoint(place)} ({reason}); choose another with --listen"
            ) from problem
        return host, self._server.port

    async def stop(self) -> None:
        """Close all connections; those of clients that do not read end with the process."""
        if self._server is None:
            return
        # It waits for every client's queue, so for one that does not read it never ends.
        stopping = threading.Thread(target=self._server.stop, daemon=True)
        stopping.start()
        await asyncio.to_thread(stopping.join, STOPPED_WITHIN_S)

    def wants(self, topic: str, kind: TopicKind) -> bool:
        """Return whether anybody is subscribed to a topic; a new one is advertised."""
        channel = self._channels.get(topic)
        if channel is None:
            if len(self._channels) >= MOST_TOPICS:
                return False
            channel = self._channels[topic] = foxglove.Channel(
                topic,
                message_encoding=kind.encoding,
                schema=foxglove.Schema(
                    name=kind.schema_name, encoding=kind.schema_encoding, data=kind.schema
                ),
                context=self._context,
            )
        return channel.has_sinks()

    def publish(self, message: LiveMessage) -> None:
        """Send a message to those who are subscribed; never waits."""
        if self.wants(message.topic, message.kind):
            self._channels[message.topic].log(message.content, log_time=message.at_ns)
