"""States of a station as the gateway sees them, and its step."""

from typing import Any

import msgspec
from tests.client import fake_state

from recon.client.messages import StateMessage
from recon.gateway.mavlink.inputs_outputs import MessageReceived, Output, Send, StationSeen
from recon.gateway.mavlink.step import step
from recon.gateway.mavlink.values import GatewaySettings, GatewayState, Sender

NS = 1_000_000_000
SENDER = Sender(peer=1, system=255, component=190)
ORDERS = GatewaySettings(allow_orders=True)


def seen(uptime_s: float = 5.0, age_s: float = 0.0, **changes: Any) -> StationSeen:
    """A state with one flying vehicle, whose fields may be changed."""
    view = fake_state.vehicle().model_copy(update=changes)
    text = fake_state.state_text(round(uptime_s * NS), vehicles=(view,))
    return StationSeen(msgspec.json.decode(text, type=StateMessage), age_s)


class Stepping:
    """A gateway's state, and the time of its steps."""

    def __init__(self, settings: GatewaySettings = ORDERS, **changes: Any) -> None:
        self.state, self.now_ns = GatewayState(settings), 100 * NS
        self.give(seen(**changes))

    def give(self, given: Any, after_s: float = 0.1) -> tuple[Output, ...]:
        self.now_ns += round(after_s * NS)
        self.state, outputs = step(self.state, given, self.now_ns)
        return outputs

    def receive(self, message: Any, sender: Sender = SENDER) -> tuple[Output, ...]:
        return self.give(MessageReceived(sender, message))


def sent(outputs: tuple[Output, ...]) -> list[Any]:
    """All messages of outputs."""
    return [m for output in outputs if isinstance(output, Send) for m in output.messages]


def types(outputs: tuple[Output, ...]) -> list[str]:
    return [message.get_type() for message in sent(outputs)]


def text(outputs: tuple[Output, ...]) -> str:
    """The sentence in outputs."""
    pieces = (m for m in sent(outputs) if m.get_type() == "STATUSTEXT")
    return "".join(piece.text.rstrip("\0") for piece in pieces)
