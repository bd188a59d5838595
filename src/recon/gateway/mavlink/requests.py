"""What clients ask for and no order is needed for: versions, single messages, parameters, time."""

from collections.abc import Callable
from typing import Any

from recon.gateway.mavlink import telemetry as shown
from recon.gateway.mavlink.dialect import COMPONENT, mavlink
from recon.gateway.mavlink.inputs_outputs import Send, Stepped
from recon.gateway.mavlink.shown import is_live_now
from recon.gateway.mavlink.values import GatewayState, GatewayVehicle, Sender

CAPABILITIES = (
    mavlink.MAV_PROTOCOL_CAPABILITY_MAVLINK2
    | mavlink.MAV_PROTOCOL_CAPABILITY_MISSION_INT
    | mavlink.MAV_PROTOCOL_CAPABILITY_COMMAND_INT
    | mavlink.MAV_PROTOCOL_CAPABILITY_MISSION_FENCE
)
"""MAVSDK sends no mission to a vehicle that answers without MISSION_INT."""
VERSION = 0 << 24 | 1 << 16 | 0 << 8 | 255
PARAMETER = b"RECON_SYSID"
"""The one parameter, read-only: clients wait long for a vehicle that has none."""
ACCEPTED, UNSUPPORTED = mavlink.MAV_RESULT_ACCEPTED, mavlink.MAV_RESULT_UNSUPPORTED


def autopilot_version(vehicle: GatewayVehicle, ground_m: float = 0.0) -> Any:
    """Return what a vehicle takes, and numbers by which clients know it again."""
    serial = vehicle.serial.encode()
    uid = int.from_bytes(serial[-8:], "big")
    uid2 = list(serial[:18].ljust(18, b"\0"))
    none = [0] * 8
    return mavlink.MAVLink_autopilot_version_message(
        CAPABILITIES, VERSION, 0, 0, 0, none, none, none, 0, 0, uid, uid2
    )


def _home(vehicle: GatewayVehicle, ground_m: float) -> Any:
    return shown.home(vehicle.telemetry, vehicle.ground_place, ground_m)


_ON_REQUEST: dict[int, Callable[[GatewayVehicle, float], Any]] = {
    mavlink.MAVLINK_MSG_ID_AUTOPILOT_VERSION: autopilot_version,
    mavlink.MAVLINK_MSG_ID_HOME_POSITION: _home,
}
_OLD_REQUESTS = {
    mavlink.MAV_CMD_REQUEST_AUTOPILOT_CAPABILITIES: mavlink.MAVLINK_MSG_ID_AUTOPILOT_VERSION,
    mavlink.MAV_CMD_GET_HOME_POSITION: mavlink.MAVLINK_MSG_ID_HOME_POSITION,
}
"""Commands of older clients, each for one message."""


def requested_message(
    state: GatewayState, vehicle: GatewayVehicle, command: int, number: float, now_ns: int
) -> tuple[int, tuple[Any, ...]] | None:
    """Return result and messages of a command that asks for a message; None of another command.

    A vehicle without live telemetry has no home now: what was known of it may be old.
    """
    if command == mavlink.MAV_CMD_REQUEST_MESSAGE:
        wanted = round(number) if 0 <= number < 2**24 else -1
    elif command in _OLD_REQUESTS:
        wanted = _OLD_REQUESTS[command]
    else:
        return None
    if wanted == mavlink.MAVLINK_MSG_ID_HOME_POSITION and not is_live_now(state, vehicle, now_ns):
        return mavlink.MAV_RESULT_TEMPORARILY_REJECTED, ()
    make = _ON_REQUEST.get(wanted)
    made = None if make is None else make(vehicle, state.settings.ground_above_sea_level_m)
    return (UNSUPPORTED, ()) if made is None else (ACCEPTED, (made,))


def parameters(
    state: GatewayState, vehicle: GatewayVehicle, sender: Sender, message: Any, now_ns: int
) -> Stepped:
    """Return the parameter to whoever lists, reads or sets it; nothing changes it."""
    name = getattr(message, "param_id", "")
    name = name.encode("ascii", "replace") if isinstance(name, str) else name
    asks_by_index = getattr(message, "param_index", -1) == 0
    is_list = message.get_msgId() == mavlink.MAVLINK_MSG_ID_PARAM_REQUEST_LIST
    if not (is_list or asks_by_index or name.rstrip(b"\0") == PARAMETER):
        return state, ()
    value = mavlink.MAVLink_param_value_message(
        PARAMETER, float(vehicle.system_id), mavlink.MAV_PARAM_TYPE_REAL32, 1, 0
    )
    return state, (Send(vehicle.system_id, (value,), sender.peer),)


def time_sync(
    state: GatewayState, vehicle: GatewayVehicle, sender: Sender, message: Any, now_ns: int
) -> Stepped:
    """Answer a question for the time; an answer of a client is nothing to the gateway."""
    if message.tc1 != 0:
        return state, ()
    answer = mavlink.MAVLink_timesync_message(now_ns, message.ts1)
    return state, (Send(vehicle.system_id, (answer,), sender.peer),)


def ping(
    state: GatewayState, vehicle: GatewayVehicle, sender: Sender, message: Any, now_ns: int
) -> Stepped:
    """Answer a ping that is a question: one to a system is an answer."""
    if message.target_system != 0:
        return state, ()
    answer = mavlink.MAVLink_ping_message(
        message.time_usec, message.seq, sender.system, sender.component
    )
    return state, (Send(vehicle.system_id, (answer,), sender.peer),)


def is_for_autopilot(message: Any) -> bool:
    """Return whether a message is for the vehicle itself, not for a camera or gimbal of it."""
    return getattr(message, "target_component", 0) in (0, COMPONENT)
