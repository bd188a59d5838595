"""Which orders only stop: what is asked of motion is not asked of them."""

from recon.model.command import Command, VirtualStick
from recon.safety.path.order_path import as_sent
from recon.safety.situation import Situation


def is_stop(command: Command, situation: Situation) -> bool:
    """Return whether an order is a stick that only stops its vehicle, in height too.

    It has no velocity, and asks for the height that the vehicle was last heard at, within
    `same_height_m`; while its height is not known, for the height that its stick before asked for.
    Any other height is a climb or a descent, and judged as motion. So is what may take off.
    """
    body, vehicle = command.body, situation.vehicle
    if not isinstance(body, VirtualStick) or command.takeoff or vehicle is None:
        return False
    if body.velocity_x_mps != 0.0 or body.velocity_y_mps != 0.0:
        return False
    height_m = vehicle.height_above_takeoff_m.value
    height_m = situation.stick_height_above_takeoff_m if height_m is None else height_m
    if height_m is None:
        return False
    off_m = abs(as_sent(body.height_above_takeoff_m) - height_m)
    return off_m <= situation.settings.fences.same_height_m
