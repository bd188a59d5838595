"""Calling a fleet home: a height of its own for each vehicle, a way to its pad, and its turn.

`plan_return` is pure: places, pads and what the site allows in; flights in waves out. `hindrance`
says whether a planned flight may begin now. `mission_of` makes the landing mission of it.
"""

from recon.guidance.fleet_return.airspace import WayHome, way_home
from recon.guidance.fleet_return.flight import (
    Flight,
    Hovering,
    LeftOut,
    Pad,
    Place,
    Returning,
    ReturnPlan,
    mission_of,
)
from recon.guidance.fleet_return.plan import plan_return
from recon.guidance.fleet_return.settings import FleetReturnSettings
from recon.guidance.fleet_return.turn import (
    Claim,
    claim_left,
    hindrance,
    layer_is_taken_by,
    least_time_s,
    whole_claim,
)
from recon.guidance.fleet_return.volume import Separation

__all__ = [
    "Claim",
    "FleetReturnSettings",
    "Flight",
    "Hovering",
    "LeftOut",
    "Pad",
    "Place",
    "ReturnPlan",
    "Returning",
    "Separation",
    "WayHome",
    "claim_left",
    "hindrance",
    "layer_is_taken_by",
    "least_time_s",
    "mission_of",
    "plan_return",
    "way_home",
    "whole_claim",
]
