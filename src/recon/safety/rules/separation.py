"""Separation of predicted trajectories in space and time.

Theory of operation. The order's trajectory is predicted to its end: its mission to the last
waypoint and the hover or landing there, a goto and its hover, a stick with reaction and braking
distance. So is the trajectory of every other vehicle in the air, from its state and its intent
(what it was last commanded). Both are cut into protected volumes: a straight piece with a radius, a
band of heights, and the time it may be occupied. That time widens with the time ahead (10 % and
some seconds), and a mission that has not begun may begin 8 s late.

A conflict is a pair of volumes that overlap in time and are nearer than the gate's minima both
horizontally and vertically (`separation_minima.py`: more than the watchdog's, so an order that
passes is not held a second later). Two vehicles that violate the minima already may be led apart:
for `escape_s` only volumes nearer than now count. That is for vehicles in the air: one on the
ground is apart as long as it stays there, and takes off when the other is out of the way.

A vehicle whose telemetry is lost is a hazard area about its last position and along its route home;
one that was sent a mission may also still fly it.

Order of work, cheapest first: bounds of the order's trajectory, vehicles that can reach them,
trajectories that touch them, boxes of volumes, and last the exact distances.
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
    Predictor,
    Trajectory,
    VehicleMotion,
    first_conflict,
    part_text,
    predict_order,
    predict_traffic,
    unknown_heights,
    vehicle_motion,
)
from recon.safety.prediction.predicted_trajectories import (
    is_too_far,
    may_conflict,
    may_enter,
    trajectory_bounds,
)
from recon.safety.separation_minima import SeparationMinima, gate_minima
from recon.safety.situation import Situation

RULE = "separation"
NO_POSITION = "no position telemetry, and other vehicles are in the air"


def separation(command: Command, situation: Situation) -> Refusal | None:
    """Refuse a path in conflict with another vehicle's, or with a lost vehicle's hazard area."""
    body, vehicle = command.body, situation.vehicle
    if not command.moves or is_stop(command, situation) or not situation.traffic:
        return None
    if vehicle is None:
        return None
    prediction, minima = situation.settings.prediction, _minima(situation)
    frame = frame_for(situation.airspace, vehicle)
    if frame is None:
        return _refusal(vehicle.display_name, NO_POSITION)
    plane = Plane(frame.origin)
    own = _placed(vehicle, plane, situation)
    if own is None:
        return _refusal(vehicle.display_name, NO_POSITION)
    trajectory = predict_order(own, body, prediction)
    others = _others(own, trajectory, plane, situation)
    if isinstance(others, Refusal):
        return others
    may_lead_apart = vehicle.is_flying.value is not False
    conflict = first_conflict(trajectory, others, minima, prediction, may_lead_apart=may_lead_apart)
    if conflict is None:
        return None
    return _conflict(own, conflict, others[conflict.other], minima)


def in_way_of_climb_home(vehicle: VehicleState, situation: Situation) -> str | None:
    """Return the name of another vehicle that a climb to go home now would conflict with.

    No rule: a person's return is never refused. It is for returns that the station gives
    automatically and that have time, because an aircraft climbs where it is, also under another
    one. None where that is unknown, and of a lost vehicle, which may be anywhere.
    """
    frame = frame_for(situation.airspace, vehicle)
    plane = None if frame is None else Plane(frame.origin)
    own = None if plane is None else _placed(vehicle, plane, situation)
    if plane is None or own is None:
        return None
    prediction, minima = situation.settings.prediction, _minima(situation)
    predictor = Predictor(own, prediction)
    predictor.return_home()
    trajectory = predictor.writer.trajectory(own.name, own.drift_m)
    others = _others(own, trajectory, plane, situation)
    for other in () if isinstance(others, Refusal) else others:
        conflict = first_conflict(trajectory, (other,), minima, prediction)
        parts = None if conflict is None else (conflict.own_part, conflict.other_part)
        if parts and parts[0] == FlightPart.CLIMBING_HOME and parts[1] != FlightPart.HAZARD:
            return other.name
    return None


def _placed(vehicle: VehicleState, plane: Plane, situation: Situation) -> VehicleMotion | None:
    prediction = situation.settings.prediction
    return vehicle_motion(vehicle, situation.airspace, plane, situation.now_ns, prediction)


def _others(
    own: VehicleMotion, trajectory: Trajectory, plane: Plane, situation: Situation
) -> tuple[Trajectory, ...] | Refusal:
    """The trajectories of all traffic that can come near the order's trajectory while it lasts."""
    prediction = situation.settings.prediction
    bounds = trajectory_bounds(trajectory, _minima(situation), prediction)
    trajectories: list[Trajectory] = []
    for other in situation.traffic:
        if is_too_far(other.vehicle, other.intent, plane, bounds, situation.now_ns, prediction):
            continue
        seen = _placed(other.vehicle, plane, situation)
        if seen is None:
            if other.vehicle.core_received_at_ns is None:
                continue  # an app without an aircraft: no telemetry shows flight
            name = other.vehicle.display_name
            text = f"{name} may be in the air at an unknown position: land it or dismiss it"
            return _refusal(own.name, text)
        unknown = unknown_heights((own, seen))
        if unknown is not None and unknown[0, 1]:
            seen = seen.at_any_height()
        if may_enter(seen, other.intent, bounds, prediction):
            predicted = predict_traffic(seen, other.intent, prediction, bounds.until_s)
            trajectories += (
                trajectory for trajectory in predicted if may_conflict(trajectory, bounds)
            )
    return tuple(trajectories)


def _minima(situation: Situation) -> SeparationMinima:
    return gate_minima(situation.airspace.airspace.limits, situation.settings)


def _conflict(
    own: VehicleMotion, conflict: Conflict, other: Trajectory, minima: SeparationMinima
) -> Refusal:
    where, when_s = part_text(conflict.own_part), ceil(conflict.at_s)
    when = f"{where}, about {when_s} s from now,"
    if conflict.other_part == FlightPart.HAZARD:
        reason = (
            f"{when} it would come within {conflict.horizontal_m:.0f} m of where {other.name} may "
            "be, telemetry lost; wait until it reconnects, or dismiss its hazard area once you "
            "have located it"
        )
    else:
        reason = (
            f"{when} it must keep {round(minima.horizontal_m, 1):g} m, or "
            f"{round(minima.vertical_m, 1):g} m in height, "
            f"from {other.name} ({part_text(conflict.other_part)}); got "
            f"{conflict.horizontal_m:.0f} m and {conflict.vertical_m:.0f} m in height: fly at "
            "another height, elsewhere, or later"
        )
    return _refusal(
        own.name,
        reason,
        other=other.name,
        time_s=conflict.at_s,
        horizontal_m=conflict.horizontal_m,
        vertical_m=conflict.vertical_m,
        min_horizontal_m=minima.horizontal_m,
        min_vertical_m=minima.vertical_m,
    )


def _refusal(name: str, why: str, **parameters: float | str) -> Refusal:
    return Refusal(RULE, f"{name}: {why}", parameters=parameters)
