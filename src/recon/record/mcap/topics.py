"""Messages by topic into one MCAP file."""

from collections.abc import Callable

from recon.record.mcap.mcap_file import McapFile

MOST_TOPICS = 4096
"""An app that reports a new serial again and again must not fill memory with channels."""
OTHER_TOPIC = "/other"


class Topics:
    """Messages by topic into one file; a topic's channel is made with its first message."""

    def __init__(self, file: McapFile) -> None:
        """Take a file just created."""
        self.file = file
        self._channels: dict[str, int] = {}
        self._schemas: dict[str, int] = {}
        self._counts: dict[int, int] = {}

    def add(
        self,
        topic: str,
        encoding: str,
        data: bytes,
        at_ns: int,
        *,
        number: int | None = None,
        schema: Callable[[], tuple[str, bytes]] | None = None,
    ) -> None:
        """Add a message; without a `number` of its own it gets the next one of its topic."""
        channel = self._channels.get(topic)
        if channel is None:
            if len(self._channels) >= MOST_TOPICS:
                topic = f"{OTHER_TOPIC}/{encoding}"
            channel = self._channels[topic] = self._channel(topic, encoding, schema)
        if number is None:
            number = self._counts[channel] = self._counts.get(channel, 0) + 1
        self.file.add_message(channel, number, at_ns, data)

    def _channel(
        self, topic: str, encoding: str, schema: Callable[[], tuple[str, bytes]] | None
    ) -> int:
        if schema is None:
            return self.file.add_channel(topic, encoding)
        name, data = schema()
        if name not in self._schemas:
            self._schemas[name] = self.file.add_schema(name, encoding, data)
        return self.file.add_channel(topic, encoding, self._schemas[name])
