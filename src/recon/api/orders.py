"""Orders as they come over the API, into the model's bodies."""

from recon.api import schema
from recon.model.command import (
    Body,
    FlyMission,
    GoTo,
    HoldPosition,
    Hover,
    LandNow,
    Nudge,
    ReturnHome,
    StartCamera,
    StickFrame,
    StopCamera,
    VirtualStick,
)
from recon.model.geo import LatLon
from recon.model.mission import Mission, Waypoint


def to_body(order: schema.AnyOrder) -> Body:
    """Return the body of an order; whether it may be carried out is the gate's matter."""
    match order:
        case schema.HoverOrder():
            return Hover()
        case schema.LandOrder():
            return LandNow()
        case schema.ReturnHomeOrder():
            return ReturnHome()
        case schema.CameraStartOrder():
            return StartCamera(fps_hz=order.fps_hz)
        case schema.CameraStopOrder():
            return StopCamera()
        case schema.MissionOrder():
            return FlyMission(_mission(order))
        case schema.StickOrder():
            return _stick(order)
        case schema.GoToOrder():
            return _goto(order)
        case schema.NudgeOrder():
            return Nudge(**order.model_dump(exclude={"kind"}))
        case schema.HoldPositionOrder():
            return HoldPosition()


def _mission(order: schema.MissionOrder) -> Mission:
    return Mission(
        waypoints=tuple(Waypoint(**waypoint.model_dump()) for waypoint in order.waypoints),
        land_at_end=order.land_at_end,
        curved=order.curved,
    )


def _goto(order: schema.GoToOrder) -> GoTo:
    return GoTo(
        target=LatLon(order.latitude_deg, order.longitude_deg),
        height_above_takeoff_m=order.height_above_takeoff_m,
        speed_mps=order.speed_mps,
        yaw_deg=order.yaw_deg,
    )


def _stick(order: schema.StickOrder) -> VirtualStick:
    return VirtualStick(
        frame=StickFrame(order.frame),
        yaw_deg=order.yaw_deg,
        velocity_x_mps=order.velocity_x_mps,
        velocity_y_mps=order.velocity_y_mps,
        height_above_takeoff_m=order.height_above_takeoff_m,
        timeout_s=order.timeout_s,
    )
