"""A mission that a client uploads: received, understood, judged by the station's gate, kept.

    count --> asking for item 0, 1, ... --last item--> understood? --> judged by the gate --> kept

The item that is missing is asked for again every `AGAIN_NS`, `MAX_TRIES` times; then the upload
ends. A vehicle has one upload at a time; another client's is refused until it ends. Only a whole
upload replaces the mission that is kept. Uploading flies nothing.

The gate's check (`/api/orders/check`) sends nothing. A mission that it refuses for what the mission
is, its path or its limits, is refused to the client. One that could not be flown at this moment is
kept, with the sentence: the gate judges again when it is started.
"""

from dataclasses import replace
from typing import Any

from recon.gateway.mavlink.commands import BUSY, MAY_PASS_LATER, READ_ONLY
from recon.gateway.mavlink.dialect import mavlink
from recon.gateway.mavlink.inputs_outputs import CheckMission, Send, StationAnswered, Stepped
from recon.gateway.mavlink.mission_items import NotUnderstood, mission_of
from recon.gateway.mavlink.texts import with_text
from recon.gateway.mavlink.values import (
    GatewayState,
    GatewayVehicle,
    MissionAsked,
    Sender,
    StoredMission,
    Upload,
)

AGAIN_NS = 700_000_000
MAX_TRIES = 5
MAX_ITEMS = 2000
"""As many waypoints as an order to the station may have."""
MISSION, FENCE = mavlink.MAV_MISSION_TYPE_MISSION, mavlink.MAV_MISSION_TYPE_FENCE
ACCEPTED, DENIED = mavlink.MAV_MISSION_ACCEPTED, mavlink.MAV_MISSION_DENIED
ABOUT_THE_MOMENT = MAY_PASS_LATER | {"authority", "operator_lease", "identified"}
NOT_HERE = "Not taken: fence and rally points are the site's; draw them in the console"
OTHER_UPLOAD = "Not taken: another client is uploading a mission to this vehicle"


def count_received(
    state: GatewayState, vehicle: GatewayVehicle, sender: Sender, message: Any, now_ns: int
) -> Stepped:
    """Begin an upload, or refuse it."""
    kind, number = message.mission_type, vehicle.system_id
    if kind != MISSION:
        return mission_answer(state, number, sender, kind, DENIED, NOT_HERE)
    if not state.settings.allow_orders:
        return mission_answer(state, number, sender, kind, DENIED, READ_ONLY)
    running = state.uploads.get(number)
    if running is not None and running.sender.peer != sender.peer:
        return mission_answer(state, number, sender, kind, DENIED, OTHER_UPLOAD)
    if message.count > MAX_ITEMS:
        words = f"Not taken: a mission has up to {MAX_ITEMS} items, this has {message.count}"
        return mission_answer(state, number, sender, kind, mavlink.MAV_MISSION_NO_SPACE, words)
    if message.count == 0:
        return _cleared(state, vehicle, sender)
    upload = Upload(sender, message.count, (), now_ns)
    return _asking(state, number, upload)


def item_received(
    state: GatewayState, vehicle: GatewayVehicle, sender: Sender, message: Any, now_ns: int
) -> Stepped:
    """Take the item that was asked for; another one is of an earlier question."""
    number = vehicle.system_id
    upload = state.uploads.get(number)
    if upload is None or upload.sender != sender or message.mission_type != MISSION:
        return state, ()
    if message.seq != len(upload.items):
        return state, ()
    items = (*upload.items, message)
    if len(items) < upload.count:
        return _asking(state, number, replace(upload, items=items, asked_ns=now_ns, tries=1))
    state = _without_upload(state, number)
    mission = mission_of(items, state.settings)
    if isinstance(mission, NotUnderstood):
        return mission_answer(state, number, sender, MISSION, mission.result, mission.sentence)
    if state.is_busy:
        return mission_answer(state, number, sender, MISSION, mavlink.MAV_MISSION_ERROR, BUSY)
    state, token = state.asking(number, MissionAsked(sender, StoredMission(items, mission)))
    return state, (CheckMission(token, vehicle.serial, mission),)


def mission_judged(
    state: GatewayState, system_id: int, asked: MissionAsked, answer: StationAnswered
) -> Stepped:
    """Keep a mission that the gate would let pass, now or at another moment."""
    vehicle, refusal = state.vehicles.get(system_id), answer.refusal
    if vehicle is None or answer.problem is not None:
        words = answer.problem or "Not taken: the station no longer shows this vehicle"
        error = mavlink.MAV_MISSION_ERROR
        return mission_answer(state, system_id, asked.sender, MISSION, error, words)
    if refusal is not None and refusal.rule not in ABOUT_THE_MOMENT:
        return mission_answer(state, system_id, asked.sender, MISSION, DENIED, refusal.reason)
    kept = replace(vehicle, mission=asked.stored, order_id=None, is_done=False)
    state = state.with_vehicle(kept)
    words = "" if refusal is None else f"Kept, but could not be flown now: {refusal.reason}"
    return mission_answer(state, system_id, asked.sender, MISSION, ACCEPTED, words)


def clear_received(
    state: GatewayState, vehicle: GatewayVehicle, sender: Sender, message: Any, now_ns: int
) -> Stepped:
    """Forget the mission that is kept; a vehicle that flies it flies on."""
    kind, number = message.mission_type, vehicle.system_id
    if kind not in (MISSION, mavlink.MAV_MISSION_TYPE_ALL):
        return mission_answer(state, number, sender, kind, DENIED, NOT_HERE)
    if not state.settings.allow_orders:
        return mission_answer(state, number, sender, kind, DENIED, READ_ONLY)
    return _cleared(state, vehicle, sender, kind)


def ack_received(
    state: GatewayState, vehicle: GatewayVehicle, sender: Sender, message: Any, now_ns: int
) -> Stepped:
    """End an upload that its client gives up."""
    upload = state.uploads.get(vehicle.system_id)
    if upload is None or upload.sender != sender:
        return state, ()
    return _without_upload(state, vehicle.system_id), ()


def time_passed(state: GatewayState, now_ns: int) -> Stepped:
    """Ask again for items that did not come; end uploads after too many tries."""
    outputs: list[Any] = []
    for number, upload in tuple(state.uploads.items()):
        if now_ns - upload.asked_ns < AGAIN_NS:
            continue
        if upload.tries < MAX_TRIES:
            again = replace(upload, asked_ns=now_ns, tries=upload.tries + 1)
            state, asked = _asking(state, number, again)
        else:
            cancelled = mavlink.MAV_MISSION_OPERATION_CANCELLED
            state = _without_upload(state, number)
            state, asked = mission_answer(state, number, upload.sender, MISSION, cancelled)
        outputs += asked
    return state, tuple(outputs)


def mission_answer(
    state: GatewayState, system_id: int, sender: Sender, kind: int, result: int, words: str = ""
) -> Stepped:
    """Return a MISSION_ACK, with a sentence if there is one to say."""
    ack = mavlink.MAVLink_mission_ack_message(sender.system, sender.component, result, kind)
    text: tuple[Any, ...] = ()
    if words:
        state, text = with_text(state, words)
    return state, (Send(system_id, (*text, ack), sender.peer),)


def _asking(state: GatewayState, system_id: int, upload: Upload) -> Stepped:
    sender, seq = upload.sender, len(upload.items)
    question = mavlink.MAVLink_mission_request_int_message(
        sender.system, sender.component, seq, MISSION
    )
    state = replace(state, uploads={**state.uploads, system_id: upload})
    return state, (Send(system_id, (question,), sender.peer),)


def _cleared(
    state: GatewayState, vehicle: GatewayVehicle, sender: Sender, kind: int = MISSION
) -> Stepped:
    state = _without_upload(state, vehicle.system_id)
    state = state.with_vehicle(replace(vehicle, mission=None, order_id=None, is_done=False))
    return mission_answer(state, vehicle.system_id, sender, kind, ACCEPTED)


def _without_upload(state: GatewayState, system_id: int) -> GatewayState:
    left = {number: upload for number, upload in state.uploads.items() if number != system_id}
    return replace(state, uploads=left)
