"""Fleet return: for each vehicle a layer of its own, a path to its pad, and its turn.

`plan_return` is pure: places, pads and the site's airspace in, flights in waves out. `hindrance`
returns why a planned flight must wait. `mission_of` makes its landing mission.
"""

from recon.guidance.fleet_return.flight import (
    CalledVehicle,
    ExcludedVehicle,
    Hovering,
    Pad,
    Place,
    ReturnFlight,
    ReturnPlan,
    Separation,
    mission_of,
)
from recon.guidance.fleet_return.paths import RouteHome, route_home
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
