"""Anything that can come by the network: the step never fails, and its state stays small."""

from typing import Any

from hypothesis import strategies as st
from pymavlink.dialects.v20 import common as mavlink
from tests.gateway.drawn import given_examples
from tests.gateway.fleet_state import Stepping

from recon.gateway.mavlink.frames import FrameReader
from recon.gateway.mavlink.inputs_outputs import CheckMission, PlaceOrder, ReadFence
from recon.gateway.mavlink.step import _HANDLERS, _TO_ALL
from recon.gateway.mavlink.values import Sender

HANDLED = sorted({*_HANDLERS, *_TO_ALL, mavlink.MAVLINK_MSG_ID_HEARTBEAT})


@st.composite
def frames(draw: st.DrawFn) -> bytes:
    """A message that the gateway handles, with any payload."""
    number = draw(st.sampled_from(HANDLED))
    kind = mavlink.mavlink_map[number]
    size = kind.unpacker.size
    payload = bytearray(draw(st.binary(min_size=size, max_size=size)))
    target = kind.ordered_fieldnames.index("target_system") if _is_targeted(kind) else None
    if target is not None and draw(st.booleans()):
        fields = list(kind.unpacker.unpack(payload))
        fields[target], fields[target + 1] = 1, 1
        payload = bytearray(kind.unpacker.pack(*fields))
    mav = mavlink.MAVLink(None, draw(st.integers(0, 255)), draw(st.integers(0, 255)))
    return packed(mav, kind, bytes(payload))


def _is_targeted(kind: Any) -> bool:
    names = kind.ordered_fieldnames
    return "target_system" in names and kind.array_lengths.count(0) == len(kind.array_lengths)


def packed(mav: Any, kind: Any, payload: bytes) -> bytes:
    header = mavlink.MAVLink_header(kind.id, 0, 0, len(payload), 0, mav.srcSystem, mav.srcComponent)
    body = header.pack()[1:] + payload
    checksum = mavlink.x25crc(body + bytes((kind.crc_extra,))).crc
    return bytes((mavlink.PROTOCOL_MARKER_V2,)) + body + checksum.to_bytes(2, "little")


@given_examples(st.lists(st.tuples(st.integers(1, 3), frames()), max_size=40))
def test_any_messages_cost_no_error_and_bounded_state(received: list[tuple[int, bytes]]) -> None:
    gateway = Stepping()
    for peer, data in received:
        for frame in FrameReader().read(data):
            message = frame.message
            sender = Sender(peer, message.get_srcSystem(), message.get_srcComponent())
            outputs = gateway.receive(message, sender)
            assert len(outputs) <= 1
            for output in outputs:
                assert (
                    isinstance(output, PlaceOrder | CheckMission | ReadFence) or output.peer == peer
                )
    assert len(gateway.state.uploads) <= 1
