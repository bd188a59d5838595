"""Orders as the API takes them."""

from dataclasses import asdict
from math import isfinite
from typing import Any

from recon.model.command import (
    BODY_NAMES,
    Body,
    FlyMission,
    GoTo,
    Nudge,
    Refusal,
    StartCamera,
    VirtualStick,
)


def order_form(body: Body) -> dict[str, Any] | Refusal:
    """Return an order's JSON values, or the refusal of numbers that JSON cannot carry."""
    form = {"kind": BODY_NAMES[type(body)], **_details(body)}
    fault = _not_finite(form, "")
    return form if fault is None else Refusal("finite_numbers", fault)


def _details(body: Body) -> dict[str, Any]:
    match body:
        case FlyMission(mission):
            return {
                "waypoints": [asdict(waypoint) for waypoint in mission.waypoints],
                "land_at_end": mission.land_at_end,
                "curved": mission.curved,
            }
        case VirtualStick():
            return {**asdict(body), "frame": body.frame.value}
        case GoTo(target, height_m, speed_mps, yaw_deg):
            return {
                **asdict(target),
                "height_above_takeoff_m": height_m,
                "speed_mps": speed_mps,
                "yaw_deg": yaw_deg,
            }
        case Nudge():
            return asdict(body)
        case StartCamera(fps_hz):
            return {"fps_hz": fps_hz}
        case _:
            return {}


def _not_finite(value: object, name: str) -> str | None:
    """Return the first number that is none, with the path to it."""
    if isinstance(value, float) and not isfinite(value):
        return f"{name} is {value}: a finite number is needed"
    parts: list[tuple[object, object]] = []
    if isinstance(value, dict):
        parts = list(value.items())
    elif isinstance(value, list):
        parts = list(enumerate(value, start=1))
    faults = (_not_finite(part, f"{name} {key}".strip()) for key, part in parts)
    return next((fault for fault in faults if fault is not None), None)
