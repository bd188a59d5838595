"""Commands: what each orders, and the one answer that each gets.

    received --asks for a message--> answered
    received --is no order, or read-only--> refused with a sentence
    received --orders--> pending --station's answer--> answered, with the sentence of a refusal

A client repeats a command until it is answered. A repetition orders nothing twice: while its order
is pending it is dropped, and for `REPEATED_NS` after an order that was or may have been sent the
same answer is given again. Stops (hold, return, land) are never taken for a repetition.
"""

from dataclasses import replace
from typing import Any

from recon.gateway.mavlink.command_orders import NoOrder, Wanted, wanted
from recon.gateway.mavlink.dialect import mavlink
from recon.gateway.mavlink.inputs_outputs import PlaceOrder, Send, StationAnswered, Stepped
from recon.gateway.mavlink.requests import requested_message
from recon.gateway.mavlink.texts import INFO, with_text
from recon.gateway.mavlink.values import (
    MAX_ANSWERS,
    CommandAsked,
    GatewayState,
    GatewayVehicle,
    Sender,
    newest,
)
from recon.model.command import EMERGENCY_BODIES

REPEATED_NS = 2_000_000_000
ARMED_NS = 60_000_000_000
"""How long after arming a mission may take off."""
DENIED, REJECTED = mavlink.MAV_RESULT_DENIED, mavlink.MAV_RESULT_TEMPORARILY_REJECTED
FAILED, ACCEPTED = mavlink.MAV_RESULT_FAILED, mavlink.MAV_RESULT_ACCEPTED
READ_ONLY = "Not ordered: this gateway is read-only; start it with --allow-orders"
BUSY = "Not ordered: too many requests to the station are under way; send it again"
MAY_PASS_LATER = frozenset(
    {"reachable", "link_age", "flying", "gnss", "preflight", "stop_latch", "not_expired"}
)
"""Rules about the moment; the other ones refuse the same order again."""


def command_received(
    state: GatewayState, vehicle: GatewayVehicle, sender: Sender, message: Any, now_ns: int
) -> Stepped:
    """Answer a COMMAND_LONG, COMMAND_INT or SET_MODE, or ask the station."""
    number = getattr(message, "command", mavlink.MAVLINK_MSG_ID_SET_MODE)
    asked = requested_message(state, vehicle, number, getattr(message, "param1", 0.0), now_ns)
    if asked is not None:
        return _answered(state, vehicle.system_id, sender, number, asked[0], more=asked[1])
    key = (sender.peer, vehicle.system_id, *_content(message))
    answer, until_ns = state.answers.get(key, (None, 0))
    want = wanted(message, vehicle, state.settings)
    is_stop = isinstance(want, Wanted) and isinstance(want.body, EMERGENCY_BODIES)
    if not is_stop and answer is not None and now_ns < until_ns:
        return state, (Send(vehicle.system_id, (answer,), sender.peer),)
    if isinstance(want, NoOrder):
        return _answered(state, vehicle.system_id, sender, number, want.result, want.sentence)
    if not state.settings.allow_orders:
        return _answered(state, vehicle.system_id, sender, number, DENIED, READ_ONLY)
    if want.body is None:
        return _armed(state, vehicle, sender, number, want.arms, now_ns)
    if not is_stop:
        if any(_key(each.purpose) == key for each in state.pending.values()):
            return state, ()
        if state.is_busy:
            return _answered(state, vehicle.system_id, sender, number, REJECTED, BUSY)
    return _ordered(
        state, vehicle, CommandAsked(sender, number, key, want.is_mission), want, now_ns
    )


def _ordered(
    state: GatewayState, vehicle: GatewayVehicle, asked: CommandAsked, want: Wanted, now_ns: int
) -> Stepped:
    assert want.body is not None
    takeoff = want.is_mission and now_ns < vehicle.takeoff_until_ns
    if takeoff:
        state = state.with_vehicle(replace(vehicle, takeoff_until_ns=0))
    state, token = state.asking(vehicle.system_id, asked)
    return state, (PlaceOrder(token, vehicle.serial, want.body, takeoff),)


def _armed(
    state: GatewayState,
    vehicle: GatewayVehicle,
    sender: Sender,
    number: int,
    arms: bool,
    now_ns: int,
) -> Stepped:
    """Allow the next mission to take off, or no longer: the station starts and stops no motors."""
    until_ns = now_ns + ARMED_NS if arms else 0
    state = state.with_vehicle(replace(vehicle, takeoff_until_ns=until_ns))
    words = (
        "The next mission start within 60 s may take off; motors start with it, not before"
        if arms
        else "A mission start may no longer take off"
    )
    return _answered(state, vehicle.system_id, sender, number, ACCEPTED, words, severity=INFO)


def order_answered(
    state: GatewayState,
    system_id: int,
    asked: CommandAsked,
    answer: StationAnswered,
    now_ns: int,
) -> Stepped:
    """Return a command's answer, made of the station's to its order."""
    vehicle = state.vehicles.get(system_id)
    if asked.starts_mission and vehicle is not None and answer.command_id is not None:
        flown = replace(vehicle, order_id=answer.command_id, is_done=False)
        state = state.with_vehicle(flown)
    result, sentence = ACCEPTED, ""
    if answer.refusal is not None:
        result = REJECTED if answer.refusal.rule in MAY_PASS_LATER else DENIED
        sentence = answer.refusal.reason
    elif answer.problem is not None:
        result, sentence = FAILED, answer.problem
    state, outputs = _answered(state, system_id, asked.sender, asked.command, result, sentence)
    if answer.refusal is not None:
        return state, outputs
    ack = next(
        message
        for output in outputs
        if isinstance(output, Send)
        for message in output.messages
        if message.get_msgId() == mavlink.MAVLINK_MSG_ID_COMMAND_ACK
    )
    kept = newest(state.answers, asked.key, (ack, now_ns + REPEATED_NS), MAX_ANSWERS)
    return replace(state, answers=kept), outputs


def _answered(
    state: GatewayState,
    system_id: int,
    sender: Sender,
    number: int,
    result: int,
    sentence: str = "",
    *,
    severity: int = mavlink.MAV_SEVERITY_WARNING,
    more: tuple[Any, ...] = (),
) -> Stepped:
    ack = mavlink.MAVLink_command_ack_message(number, result, 0, 0, sender.system, sender.component)
    text: tuple[Any, ...] = ()
    if sentence:
        state, text = with_text(state, sentence, severity)
    return state, (Send(system_id, (*text, ack, *more), sender.peer),)


def _key(purpose: Any) -> tuple[Any, ...] | None:
    return purpose.key if isinstance(purpose, CommandAsked) else None


def _content(message: Any) -> tuple[Any, ...]:
    """Return what a command says, without the count of its repetitions. NaN equals itself here."""
    fields = (name for name in message.get_fieldnames() if name != "confirmation")
    return (message.get_msgId(), *(repr(getattr(message, name)) for name in fields))
