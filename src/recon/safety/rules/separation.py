"""Vehicles keep apart: predicted paths are compared in space and time.

The trajectory of the order is predicted to its end, and so is that of every other vehicle in the
air, from its state and what it was last told. They must stay apart horizontally or vertically at
all times that they may be there together; how exactly those times are known falls with the time
ahead. A vehicle that is not heard any more is a hazard about its last place and along its way home.
"""

from math import ceil

from recon.model.command import Command, Refusal
from recon.model.vehicle import VehicleState
from recon.safety.datum import frame_for
from recon.safety.path.order_path import is_stop
from recon.safety.prediction import (
    Conflict,
    FlightPart,
    Plane,
    Trajectory,
    VehicleMotion,
    first_conflict,
    part_text,
    predict_order,
    predict_traffic,
    vehicle_motion,
)
from recon.safety.prediction.predicted_trajectories import (
    may_conflict,
    may_enter,
    trajectory_bounds,
)
from recon.safety.separation_minima import SeparationMinima, gate_minima
from recon.safety.situation import Situation

RULE = "separation"
NOWHERE = "it does not tell where it is, and others are in the air"


def separation(command: Command, situation: Situation) -> Refusal | None:
    """Refuse a path that comes too near to another vehicle's, or to where one may be lost."""
    body, vehicle = command.body, situation.vehicle
    if not command.moves or is_stop(command, situation) or not situation.traffic:
        return None
    if vehicle is None:
        return None
    prediction, need = situation.settings.prediction, _minima(situation)
    frame = frame_for(situation.airspace, vehicle)
    if frame is None:
        return _refusal(vehicle.display_name, NOWHERE)
    plane = Plane(frame.origin)
    own = _placed(vehicle, plane, situation)
    if own is None:
        return _refusal(vehicle.display_name, NOWHERE)
    trajectory = predict_order(own, body, prediction)
    others = _others(own, trajectory, plane, situation)
    if isinstance(others, Refusal):
        return others
    conflict = first_conflict(trajectory, others, need, prediction)
    if conflict is None:
        return None
    return _refusal(own.name, _text(conflict, others[conflict.other], need))


def _placed(vehicle: VehicleState, plane: Plane, situation: Situation) -> VehicleMotion | None:
    prediction = situation.settings.prediction
    return vehicle_motion(vehicle, situation.airspace, plane, situation.now_ns, prediction)


def _others(
    own: VehicleMotion, trajectory: Trajectory, plane: Plane, situation: Situation
) -> tuple[Trajectory, ...] | Refusal:
    """The trajectories of all traffic that can come near the order's trajectory while it lasts."""
    prediction = situation.settings.prediction
    around = trajectory_bounds(trajectory, _minima(situation), prediction)
    trajectories: list[Trajectory] = []
    for other in situation.traffic:
        seen = _placed(other.vehicle, plane, situation)
        if seen is None:
            if other.vehicle.core_received_at_ns is None:
                continue  # an app without an aircraft: nothing has said that it flies
            name = other.vehicle.display_name
            text = f"{name} may be in the air and has never told where: land it or dismiss it"
            return _refusal(own.name, text)
        if may_enter(seen, other.intent, around, prediction):
            predicted = predict_traffic(seen, other.intent, prediction, around.until_s)
            trajectories += (
                trajectory for trajectory in predicted if may_conflict(trajectory, around)
            )
    return tuple(trajectories)


def _minima(situation: Situation) -> SeparationMinima:
    return gate_minima(situation.airspace.airspace.limits, situation.settings)


def _text(conflict: Conflict, other: Trajectory, need: SeparationMinima) -> str:
    where, when_s = part_text(conflict.own_part), ceil(conflict.at_s)
    if conflict.other_part == FlightPart.HAZARD:
        return (
            f"{where}, about {when_s} s from now, it would come within "
            f"{conflict.horizontal_m:.0f} m of where {other.name} may be, telemetry lost; "
            "wait until it reconnects, or dismiss its hazard area once you have located it"
        )
    return (
        f"{where}, about {when_s} s from now, it could come within {conflict.horizontal_m:.0f} m "
        f"and {conflict.vertical_m:.0f} m in height of {other.name} "
        f"({part_text(conflict.other_part)}); {need.horizontal_m:g} m, or {need.vertical_m:g} m in "
        "height, must be kept: fly at another height, elsewhere, or later"
    )


def _refusal(name: str, why: str) -> Refusal:
    return Refusal(RULE, f"{name}: {why}")
