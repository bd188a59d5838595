"""Sentences for a person, as STATUSTEXT: pieces of 50 bytes, which clients join by their number."""

from dataclasses import replace
from typing import Any

from recon.gateway.mavlink.dialect import mavlink
from recon.gateway.mavlink.values import GatewayState

PIECE_BYTES = 50
MAX_PIECES = 12
WARNING, INFO = mavlink.MAV_SEVERITY_WARNING, mavlink.MAV_SEVERITY_INFO


def with_text(
    state: GatewayState, sentence: str, severity: int = WARNING
) -> tuple[GatewayState, tuple[Any, ...]]:
    """Return the state with the next number, and the messages of a sentence."""
    data = sentence.encode("ascii", "replace")[: PIECE_BYTES * MAX_PIECES - 1]
    if len(data) <= PIECE_BYTES:
        return state, (mavlink.MAVLink_statustext_message(severity, data),)
    number = state.next_text_id
    # A piece that is not full ends the sentence: one of zeros where the last one is full.
    starts = range(0, len(data) + 1, PIECE_BYTES)
    pieces = tuple(
        mavlink.MAVLink_statustext_message(
            severity, data[start : start + PIECE_BYTES], number, start // PIECE_BYTES
        )
        for start in starts
    )
    return replace(state, next_text_id=number % 0xFFFF + 1), pieces
