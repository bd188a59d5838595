"""The gateway's step: state and one input to the next state and the outputs. Pure."""

from collections.abc import Callable
from dataclasses import replace
from typing import Any

from recon.gateway.mavlink import mission_download, mission_upload
from recon.gateway.mavlink.commands import command_received, order_answered
from recon.gateway.mavlink.dialect import mavlink
from recon.gateway.mavlink.inputs_outputs import (
    FenceRead,
    Input,
    MessageReceived,
    Output,
    PeerGone,
    StationAnswered,
    StationSeen,
    Stepped,
    TimePassed,
)
from recon.gateway.mavlink.requests import is_for_autopilot, parameters, ping, time_sync
from recon.gateway.mavlink.shown import is_live_now, station_seen
from recon.gateway.mavlink.values import (
    CommandAsked,
    FenceAsked,
    GatewayState,
    GatewayVehicle,
    MissionAsked,
    Sender,
)

Handler = Callable[[GatewayState, GatewayVehicle, Sender, Any, int], Stepped]

_HANDLERS: dict[int, Handler] = {
    mavlink.MAVLINK_MSG_ID_COMMAND_LONG: command_received,
    mavlink.MAVLINK_MSG_ID_COMMAND_INT: command_received,
    mavlink.MAVLINK_MSG_ID_SET_MODE: command_received,
    mavlink.MAVLINK_MSG_ID_PARAM_REQUEST_LIST: parameters,
    mavlink.MAVLINK_MSG_ID_PARAM_REQUEST_READ: parameters,
    mavlink.MAVLINK_MSG_ID_PARAM_SET: parameters,
    mavlink.MAVLINK_MSG_ID_MISSION_COUNT: mission_upload.count_received,
    mavlink.MAVLINK_MSG_ID_MISSION_ITEM_INT: mission_upload.item_received,
    mavlink.MAVLINK_MSG_ID_MISSION_CLEAR_ALL: mission_upload.clear_received,
    mavlink.MAVLINK_MSG_ID_MISSION_ACK: mission_upload.ack_received,
    mavlink.MAVLINK_MSG_ID_MISSION_REQUEST_LIST: mission_download.list_received,
    mavlink.MAVLINK_MSG_ID_MISSION_REQUEST_INT: mission_download.item_asked,
    mavlink.MAVLINK_MSG_ID_MISSION_REQUEST: mission_download.item_asked,
}
"""Messages to one vehicle. All others are ignored."""
_TO_ALL: dict[int, Handler] = {
    mavlink.MAVLINK_MSG_ID_TIMESYNC: time_sync,
    mavlink.MAVLINK_MSG_ID_PING: ping,
}
"""Questions to nobody in particular: the live vehicle with the lowest id answers, or none."""


def step(state: GatewayState, given: Input, now_ns: int) -> Stepped:
    """Return the next state and what to send, ask and order. `now_ns` is monotonic."""
    match given:
        case StationSeen():
            state, outputs = station_seen(state, given, now_ns)
            return _joined(mission_upload.time_passed(state, now_ns), outputs)
        case MessageReceived(sender, message):
            return _received(state, sender, message, now_ns)
        case StationAnswered(token) | FenceRead(token):
            return _answered(state, token, given, now_ns)
        case PeerGone(peer):
            return _without_peer(state, peer), ()
        case TimePassed():
            return mission_upload.time_passed(state, now_ns)


def _received(state: GatewayState, sender: Sender, message: Any, now_ns: int) -> Stepped:
    number = message.get_msgId()
    handle = _TO_ALL.get(number)
    if handle is not None:
        live = (n for n, each in state.vehicles.items() if is_live_now(state, each, now_ns))
        first = min(live, default=None)
        if first is None:
            return state, ()
        return handle(state, state.vehicles[first], sender, message, now_ns)
    handle = _HANDLERS.get(number)
    if handle is None:
        return state, ()
    return _to_vehicle(state, handle, sender, message, now_ns)


def _to_vehicle(
    state: GatewayState, handle: Handler, sender: Sender, message: Any, now_ns: int
) -> Stepped:
    """Handle a message to one vehicle. One to all, system 0, is taken where there is only one."""
    wanted = getattr(message, "target_system", 0)
    if wanted == 0 and len(state.vehicles) == 1:
        (wanted,) = state.vehicles
    vehicle = state.vehicles.get(wanted)
    if vehicle is None or not is_for_autopilot(message):
        return state, ()
    return handle(state, vehicle, sender, message, now_ns)


def _answered(
    state: GatewayState, token: int, answer: StationAnswered | FenceRead, now_ns: int
) -> Stepped:
    pending = state.pending.get(token)
    if pending is None:
        return state, ()
    left = {number: each for number, each in state.pending.items() if number != token}
    state, system_id = replace(state, pending=left), pending.system_id
    match pending.purpose, answer:
        case CommandAsked() as asked, StationAnswered():
            return order_answered(state, system_id, asked, answer, now_ns)
        case MissionAsked() as asked, StationAnswered():
            return mission_upload.mission_judged(state, system_id, asked, answer)
        case FenceAsked() as asked, FenceRead():
            return mission_download.fence_read(state, system_id, asked, answer)
    raise AssertionError("each request has its own kind of answer")


def _without_peer(state: GatewayState, peer: int) -> GatewayState:
    """Forget a client; its orders under way are answered to nobody."""
    uploads = {n: upload for n, upload in state.uploads.items() if upload.sender.peer != peer}
    fences = {key: items for key, items in state.fences.items() if key[0] != peer}
    answers = {key: answer for key, answer in state.answers.items() if key[0] != peer}
    return replace(state, uploads=uploads, fences=fences, answers=answers)


def _joined(stepped: Stepped, before: tuple[Output, ...]) -> Stepped:
    state, outputs = stepped
    return state, (*before, *outputs)
