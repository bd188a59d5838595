"""Which order a command of MAVLink means, or why it means none."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from math import isfinite, isnan
from typing import Any

from recon.gateway.mavlink.dialect import ENCODED_DEGREE, UNKNOWN_INT32, mavlink
from recon.gateway.mavlink.flight_modes import (
    AUTO,
    MISSION,
    STANDARD_STOPS,
    STOPS,
    main_and_sub_mode,
)
from recon.gateway.mavlink.heights import height_above_takeoff_m
from recon.gateway.mavlink.values import GatewaySettings, GatewayVehicle
from recon.model.command import Body, FlyMission, GoTo, Hover, LandNow, ReturnHome
from recon.model.geo import LatLon

DENIED, UNSUPPORTED = mavlink.MAV_RESULT_DENIED, mavlink.MAV_RESULT_UNSUPPORTED
SENSIBLE_FRAMES_ONLY = 9
"""MAV_RESULT_COMMAND_UNSUPPORTED_MAV_FRAME."""


@dataclass(frozen=True, slots=True)
class Wanted:
    """An order; without a body, whether the next mission may take off."""

    body: Body | None
    is_mission: bool = False
    arms: bool = False


@dataclass(frozen=True, slots=True)
class NoOrder:
    """A command that is no order of the station's."""

    result: int
    sentence: str


Meaning = Wanted | NoOrder

MODES = NoOrder(
    DENIED, "Not ordered: the modes that can be ordered are Hold, Return, Land and Mission"
)
NO_MISSION = NoOrder(DENIED, "Not started: no mission was uploaded to this vehicle")


def wanted(message: Any, vehicle: GatewayVehicle, settings: GatewaySettings) -> Meaning:
    """Return what a COMMAND_LONG, COMMAND_INT or SET_MODE orders."""
    if message.get_msgId() == mavlink.MAVLINK_MSG_ID_SET_MODE:
        return _mode(*main_and_sub_mode(message.custom_mode), vehicle)
    make = _COMMANDS.get(message.command)
    if make is None:
        return NoOrder(UNSUPPORTED, "")
    return make(message, vehicle, settings)


def _set_mode(message: Any, vehicle: GatewayVehicle, settings: GatewaySettings) -> Meaning:
    return _mode(_whole(message.param2), _whole(message.param3), vehicle)


def _mode(main: int, sub: int, vehicle: GatewayVehicle) -> Meaning:
    if (main, sub) == (AUTO, MISSION):
        return _mission(vehicle)
    body = STOPS.get((main, sub))
    return MODES if body is None else Wanted(body)


def _standard_mode(message: Any, vehicle: GatewayVehicle, settings: GatewaySettings) -> Meaning:
    number = _whole(message.param1)
    if number == mavlink.MAV_STANDARD_MODE_MISSION:
        return _mission(vehicle)
    body = STANDARD_STOPS.get(number)
    return MODES if body is None else Wanted(body)


def _start(message: Any, vehicle: GatewayVehicle, settings: GatewaySettings) -> Meaning:
    if message.param1 not in (0.0, 1.0) or isnan(message.param1):
        return NoOrder(DENIED, "Not started: a mission is flown from its first item only")
    return _mission(vehicle)


def _mission(vehicle: GatewayVehicle) -> Meaning:
    if vehicle.mission is None:
        return NO_MISSION
    return Wanted(FlyMission(vehicle.mission.mission), is_mission=True)


def _pause(message: Any, vehicle: GatewayVehicle, settings: GatewaySettings) -> Meaning:
    if _whole(message.param1) == 0:
        return Wanted(Hover())
    return NoOrder(DENIED, "Not ordered: a held mission is not continued; start it again")


def _arm(message: Any, vehicle: GatewayVehicle, settings: GatewaySettings) -> Meaning:
    if _whole(message.param1) == 1:
        return Wanted(None, arms=True)
    if vehicle.telemetry.is_flying.value is not False:
        return NoOrder(DENIED, "Not disarmed: the station never stops motors; land the vehicle")
    return Wanted(None)


def _reposition(message: Any, vehicle: GatewayVehicle, settings: GatewaySettings) -> Meaning:
    """Return a goto; without a place and a height a hold, as QGroundControl pauses."""
    is_int = message.get_msgId() == mavlink.MAVLINK_MSG_ID_COMMAND_INT
    place = _int_place(message) if is_int else _float_place(message)
    given_m = message.z if is_int else message.param7
    frame = message.frame if is_int else mavlink.MAV_FRAME_GLOBAL
    telemetry = vehicle.telemetry
    if place is None and isnan(given_m):
        return Wanted(Hover())
    height_m = telemetry.height_above_takeoff_m.value
    if not isnan(given_m):
        height_m = height_above_takeoff_m(given_m, frame, settings.ground_above_sea_level_m)
        if height_m is None:
            return NoOrder(
                SENSIBLE_FRAMES_ONLY, "Not ordered: use heights above sea level or above home"
            )
    own = telemetry.position
    latitude_deg, longitude_deg = place or (own.latitude_deg, own.longitude_deg)
    if latitude_deg is None or longitude_deg is None or height_m is None:
        return NoOrder(DENIED, "Not ordered: the vehicle's place or height is not known")
    speed_mps = message.param1
    if not (isfinite(speed_mps) and speed_mps > 0.0):
        speed_mps = settings.speed_mps
    return Wanted(GoTo(LatLon(latitude_deg, longitude_deg), height_m, speed_mps))


def _int_place(message: Any) -> tuple[float, float] | None:
    if UNKNOWN_INT32 in (message.x, message.y):
        return None
    return message.x / ENCODED_DEGREE, message.y / ENCODED_DEGREE


def _float_place(message: Any) -> tuple[float, float] | None:
    if isnan(message.param5) or isnan(message.param6):
        return None
    return message.param5, message.param6


def _always(body: Body) -> Callable[..., Meaning]:
    return lambda message, vehicle, settings: Wanted(body)


def _never(sentence: str) -> Callable[..., Meaning]:
    return lambda message, vehicle, settings: NoOrder(DENIED, sentence)


_COMMANDS: Mapping[int, Callable[[Any, GatewayVehicle, GatewaySettings], Meaning]] = {
    mavlink.MAV_CMD_DO_SET_MODE: _set_mode,
    mavlink.MAV_CMD_DO_SET_STANDARD_MODE: _standard_mode,
    mavlink.MAV_CMD_DO_PAUSE_CONTINUE: _pause,
    mavlink.MAV_CMD_NAV_LOITER_UNLIM: _always(Hover()),
    mavlink.MAV_CMD_NAV_RETURN_TO_LAUNCH: _always(ReturnHome()),
    mavlink.MAV_CMD_NAV_LAND: _always(LandNow()),
    mavlink.MAV_CMD_DO_REPOSITION: _reposition,
    mavlink.MAV_CMD_MISSION_START: _start,
    mavlink.MAV_CMD_COMPONENT_ARM_DISARM: _arm,
    mavlink.MAV_CMD_NAV_TAKEOFF: _never(
        "Not ordered: a vehicle takes off with a mission; arm it and start one"
    ),
    mavlink.MAV_CMD_DO_FLIGHTTERMINATION: _never(
        "Not ordered: the station never stops motors; land the vehicle"
    ),
}


def _whole(number: float) -> int:
    return round(number) if isfinite(number) else -1
