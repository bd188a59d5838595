"""What a state of the station shows of each vehicle: new samples once, and beats while it is live.

A vehicle's messages are made from its telemetry alone and only while that is live. Once its link
or its telemetry is lost, or the station's states no longer come, nothing is sent of it at all; each
sample is sent once, so no old position is ever repeated as a new one.
"""

from dataclasses import replace
from typing import Any

from recon.client.messages import StateMessage
from recon.client.telemetry import Telemetry
from recon.gateway.mavlink import telemetry as shown
from recon.gateway.mavlink.dialect import mavlink
from recon.gateway.mavlink.inputs_outputs import Output, Send, StationSeen, Stepped
from recon.gateway.mavlink.values import GatewayState, GatewayVehicle
from recon.gateway.samples import SAME_SAMPLE_NS, is_live, taken_ns
from recon.model.command import Phase
from recon.model.units import NS_PER_S, ns_to_seconds

HIGHEST_SYSTEM = 240
"""Ids above are those of ground stations."""
SLOW_NS = 950_000_000
"""A heartbeat a second, of states that come ten times a second."""


def station_seen(state: GatewayState, seen: StationSeen, now_ns: int) -> Stepped:
    """Return the vehicles of a state, and the messages about them."""
    vehicles: dict[int, GatewayVehicle] = {}
    outputs: list[Output] = []
    for each in seen.message.vehicles:
        if each.serial is None or not 1 <= each.number <= HIGHEST_SYSTEM:
            continue
        known = state.vehicles.get(each.number)
        if known is None or known.serial != each.serial:
            # Not all at once: what is sent once a second is spread over ten states.
            due_ns = now_ns + each.number % 10 * SLOW_NS // 10
            known = GatewayVehicle(each.number, each, slow_due_ns=due_ns)
        vehicle, messages = _shown(
            known, each, seen, state.settings.ground_above_sea_level_m, now_ns
        )
        vehicles[each.number] = vehicle
        if messages:
            outputs.append(Send(each.number, tuple(messages)))
    seen_ns = now_ns - round(seen.age_s * NS_PER_S)
    return replace(state, vehicles=vehicles, seen_ns=seen_ns), tuple(outputs)


def _shown(
    known: GatewayVehicle, telemetry: Telemetry, seen: StationSeen, ground_m: float, now_ns: int
) -> tuple[GatewayVehicle, list[Any]]:
    changes: dict[str, Any] = {"telemetry": telemetry}
    messages: list[Any] = []
    if is_live(telemetry, seen.age_s):
        _add_samples(changes, messages, known, telemetry, seen, ground_m)
        known = replace(known, ground_place=_ground_place(telemetry) or known.ground_place)
        if now_ns >= known.slow_due_ns:
            changes["slow_due_ns"] = now_ns + SLOW_NS
            messages += _slow(known, telemetry, seen, ground_m)
            messages += _progress(known, seen.message, changes)
    return replace(known, **changes), messages


def is_live_now(state: GatewayState, vehicle: GatewayVehicle, now_ns: int) -> bool:
    """Return whether a vehicle's telemetry is live, also while no state of the station comes."""
    return is_live(vehicle.telemetry, ns_to_seconds(now_ns - state.seen_ns))


def _add_samples(
    changes: dict[str, Any],
    messages: list[Any],
    known: GatewayVehicle,
    telemetry: Telemetry,
    seen: StationSeen,
    ground_m: float,
) -> None:
    """Add the position and the attitude, each if it is a new sample."""
    at_ns = _taken_ns(telemetry.position.age_s, seen)
    if at_ns is not None and at_ns > known.position_ns + SAME_SAMPLE_NS:
        place = shown.position(telemetry, _boot_ms(seen.message, at_ns), ground_m)
        if place is not None:
            changes["position_ns"] = at_ns
            messages.append(place)
    at_ns = _taken_ns(telemetry.attitude.age_s, seen)
    if at_ns is not None and at_ns > known.attitude_ns + SAME_SAMPLE_NS:
        pose = shown.attitude(telemetry, _boot_ms(seen.message, at_ns))
        if pose is not None:
            changes["attitude_ns"] = at_ns
            messages.append(pose)


def _taken_ns(age_s: float | None, seen: StationSeen) -> int | None:
    return taken_ns(age_s, seen.message.time_ns, seen.age_s)


def _boot_ms(message: StateMessage, time_ns: int) -> int:
    return max(0, time_ns - message.run_started_ns) // 1_000_000 & 0xFFFF_FFFF


def _ground_place(telemetry: Telemetry) -> shown.Place | None:
    place = telemetry.position
    if telemetry.is_flying.value is not False or place.latitude_deg is None:
        return None
    return None if place.longitude_deg is None else (place.latitude_deg, place.longitude_deg)


def _slow(
    known: GatewayVehicle, telemetry: Telemetry, seen: StationSeen, ground_m: float
) -> list[Any]:
    boot_ms = _boot_ms(seen.message, seen.message.time_ns)
    has_place = _taken_ns(telemetry.position.age_s, seen) is not None
    made = (
        shown.heartbeat(telemetry),
        shown.status(telemetry, has_place=has_place),
        shown.landed_state(telemetry),
        shown.battery(telemetry),
        shown.gnss(telemetry, boot_ms, ground_m) if has_place else None,
        shown.hud(telemetry, ground_m) if has_place else None,
        shown.home(telemetry, known.ground_place, ground_m),
    )
    return [message for message in made if message is not None]


def _progress(known: GatewayVehicle, message: StateMessage, changes: dict[str, Any]) -> list[Any]:
    """Return how far the uploaded mission is, as its order's phase shows; no waypoint is known."""
    count = 0 if known.mission is None else len(known.mission.items)
    order = next((o for o in message.commands if o.id == known.order_id), None)
    phase = None if order is None else order.phase
    mission_state = mavlink.MISSION_STATE_NOT_STARTED if count else mavlink.MISSION_STATE_NO_MISSION
    reached: list[Any] = []
    if phase is Phase.DONE:
        mission_state = mavlink.MISSION_STATE_COMPLETE
        if count and not known.is_done:
            reached = [mavlink.MAVLink_mission_item_reached_message(count - 1)]
            changes["is_done"] = True
    elif phase is not None and not phase.is_final:
        mission_state = mavlink.MISSION_STATE_ACTIVE
    seq = max(0, count - 1) if phase is Phase.DONE else 0
    return [mavlink.MAVLink_mission_current_message(seq, count, mission_state, 0), *reached]
