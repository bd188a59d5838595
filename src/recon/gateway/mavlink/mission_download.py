"""What a client reads by the mission protocol: the uploaded mission, and the site's fence.

    list --mission--> count --> item ... (each on request)
    list --fence--> read from the station --> count --> item ...

A fence is read anew for each list, and kept for that client until it reads another: its items are
of one moment.
"""

from collections.abc import Callable
from dataclasses import replace
from typing import Any

from recon.gateway.mavlink.commands import BUSY
from recon.gateway.mavlink.dialect import ENCODED_DEGREE, mavlink
from recon.gateway.mavlink.inputs_outputs import FenceRead, ReadFence, Send, Stepped
from recon.gateway.mavlink.mission_upload import FENCE, MISSION, mission_answer
from recon.gateway.mavlink.values import (
    MAX_FENCES,
    FenceAsked,
    GatewayState,
    GatewayVehicle,
    Sender,
    newest,
)

_FRAMES_OF_FLOATS = {
    mavlink.MAV_FRAME_GLOBAL_INT: mavlink.MAV_FRAME_GLOBAL,
    mavlink.MAV_FRAME_GLOBAL_RELATIVE_ALT_INT: mavlink.MAV_FRAME_GLOBAL_RELATIVE_ALT,
}


def list_received(
    state: GatewayState, vehicle: GatewayVehicle, sender: Sender, message: Any, now_ns: int
) -> Stepped:
    """Answer with a count; a fence is read from the station first."""
    kind, number = message.mission_type, vehicle.system_id
    if kind != FENCE:
        items = _items(state, vehicle, sender, kind)
        return state, (_count(number, sender, len(items), kind),)
    if state.is_busy:
        return mission_answer(state, number, sender, kind, mavlink.MAV_MISSION_ERROR, BUSY)
    if any(each.purpose == FenceAsked(sender) for each in state.pending.values()):
        return state, ()
    state, token = state.asking(number, FenceAsked(sender))
    return state, (ReadFence(token),)


def fence_read(state: GatewayState, system_id: int, asked: FenceAsked, fence: FenceRead) -> Stepped:
    """Answer with the number of the fence's items, which are kept for this client."""
    if fence.problem is not None:
        error = mavlink.MAV_MISSION_ERROR
        return mission_answer(state, system_id, asked.sender, FENCE, error, fence.problem)
    kept = newest(state.fences, (asked.sender.peer, system_id), fence.items, MAX_FENCES)
    state = replace(state, fences=kept)
    return state, (_count(system_id, asked.sender, len(fence.items), FENCE),)


def item_asked(
    state: GatewayState, vehicle: GatewayVehicle, sender: Sender, message: Any, now_ns: int
) -> Stepped:
    """Send one item; an item that is not there ends the download."""
    kind = message.mission_type
    items = _items(state, vehicle, sender, kind)
    if message.seq >= len(items):
        wrong = mavlink.MAV_MISSION_INVALID_SEQUENCE
        return mission_answer(state, vehicle.system_id, sender, kind, wrong)
    is_old = message.get_msgId() == mavlink.MAVLINK_MSG_ID_MISSION_REQUEST
    make = _float_item if is_old else _int_item
    item = make(items[message.seq], message.seq, sender, kind)
    return state, (Send(vehicle.system_id, (item,), sender.peer),)


def _items(
    state: GatewayState, vehicle: GatewayVehicle, sender: Sender, kind: int
) -> tuple[Any, ...]:
    if kind == MISSION:
        return () if vehicle.mission is None else vehicle.mission.items
    return state.fences.get((sender.peer, vehicle.system_id), ()) if kind == FENCE else ()


def _count(system_id: int, sender: Sender, count: int, kind: int) -> Send:
    message = mavlink.MAVLink_mission_count_message(sender.system, sender.component, count, kind)
    return Send(system_id, (message,), sender.peer)


def _int_item(item: Any, seq: int, sender: Sender, kind: int) -> Any:
    return _made(mavlink.MAVLink_mission_item_int_message, item, seq, sender, kind)(
        item.frame, item.x, item.y
    )


def _float_item(item: Any, seq: int, sender: Sender, kind: int) -> Any:
    """Return an item for an older client, whose place is exact to about a metre."""
    return _made(mavlink.MAVLink_mission_item_message, item, seq, sender, kind)(
        _FRAMES_OF_FLOATS.get(item.frame, item.frame),
        item.x / ENCODED_DEGREE,
        item.y / ENCODED_DEGREE,
    )


def _made(
    message: Callable[..., Any], item: Any, seq: int, sender: Sender, kind: int
) -> Callable[..., Any]:
    def make(frame: int, x: float, y: float) -> Any:
        return message(
            *(sender.system, sender.component, seq, frame, item.command, int(seq == 0)),
            *(item.autocontinue, item.param1, item.param2, item.param3, item.param4, x, y, item.z),
            kind,
        )

    return make
