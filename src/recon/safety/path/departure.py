"""From where a vehicle would set out, and how it would come home by itself."""

from dataclasses import dataclass
from math import inf

import numpy as np
import numpy.typing as npt

from recon.geo import OnGlobe
from recon.model.geo import LocalFrame
from recon.model.vehicle import Failsafe, VehicleProfile, VehicleState
from recon.safety import datum
from recon.safety.situation import Situation

FloatArray = npt.NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class UnknownPath:
    """Why nobody can say where the vehicle would fly."""

    reason: str


@dataclass(frozen=True, slots=True, eq=False)
class Departure:
    """What is known of a vehicle before it sets out, in the frame's metres.

    `here_m` and `home_m` are (3,). `go_home_m` are the least and the most up_m that it goes home
    at: the same, or -inf and +inf when nobody has told.
    """

    frame: LocalFrame
    here_m: FloatArray
    home_m: FloatArray
    go_home_m: tuple[float, float]
    failsafe: Failsafe
    vehicle: VehicleState

    @property
    def takeoff_m(self) -> float:
        """The up_m that the vehicle's own heights count from."""
        return float(self.home_m[2])


def departure(situation: Situation, vehicle: VehicleState) -> Departure | UnknownPath:
    """Return from where the vehicle sets out, or why that is not known."""
    airspace = situation.airspace
    name, position, home = vehicle.display_name, vehicle.position.value, datum.home(vehicle)
    height_m = vehicle.height_above_takeoff_m.value
    if position is None:
        return UnknownPath(f"{name} does not say where it is: wait until its GNSS has a position")
    if height_m is None:
        return UnknownPath(f"{name} does not say how high it is: look at its app")
    if home is None:
        return UnknownPath(
            f"{name}: its home is not known, for it took off before the station heard it; write "
            "its pad into site.toml, or let its pilot land it and take off again"
        )
    frame, takeoff_m = datum.frame_for(airspace, vehicle), datum.takeoff_up_m(airspace, vehicle)
    if frame is None or takeoff_m is None:
        return UnknownPath(
            f"{name}: the elevation model tells no ground where it took off, so its heights cannot "
            "be compared with anything; write its pad's altitude into site.toml"
        )
    places: list[OnGlobe] = [position, home]
    (east_m, north_m), (home_east_m, home_north_m) = datum.places_m(frame, places)
    return Departure(
        frame=frame,
        here_m=np.array([east_m, north_m, takeoff_m + height_m]),
        home_m=np.array([home_east_m, home_north_m, takeoff_m]),
        go_home_m=_go_home_m(vehicle.profile, takeoff_m),
        failsafe=_failsafe(vehicle.profile),
        vehicle=vehicle,
    )


def _go_home_m(profile: VehicleProfile | None, takeoff_m: float) -> tuple[float, float]:
    if profile is None or profile.go_home_height_m is None:
        return -inf, inf
    return takeoff_m + profile.go_home_height_m, takeoff_m + profile.go_home_height_m


def _failsafe(profile: VehicleProfile | None) -> Failsafe:
    """Going home is what aircraft do unless somebody has set them otherwise."""
    return (profile.failsafe if profile is not None else None) or Failsafe.GO_HOME
