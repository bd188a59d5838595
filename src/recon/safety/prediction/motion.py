"""A vehicle's position and velocity in the plane, as prediction needs them."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from recon.geo import OnGlobe
from recon.geo.distance import offset_north_east_m
from recon.model.arrays import BoolArray
from recon.model.geo import LatLon
from recon.model.units import NS_PER_S, Stamped, wrap_degrees
from recon.model.vehicle import Failsafe, VehicleState, VelocityNed
from recon.safety.airspace import PreparedAirspace
from recon.safety.datum import home, is_takeoff_height_known, takeoff_up_m_at
from recon.safety.go_home import seen_height_m
from recon.safety.prediction.trajectory import ALL_HEIGHTS_M
from recon.safety.prediction_settings import PredictionSettings

S_PER_HOUR = 3_600.0

SAME_GROUND_M = 10.0
"""Takeoff points this near to each other are at one height, to 2 m on a slope of 1 in 5."""


class Plane:
    """The tangent plane at a position."""

    def __init__(self, origin: OnGlobe) -> None:
        self._latitude_deg = origin.latitude_deg
        self._longitude_deg = origin.longitude_deg
        here = LatLon(origin.latitude_deg, origin.longitude_deg)
        there = LatLon(origin.latitude_deg + 1.0, origin.longitude_deg + 1.0)
        self._north_m_per_deg, self._east_m_per_deg = offset_north_east_m(here, there)

    def east_north_m(self, place: OnGlobe) -> tuple[float, float]:
        """Return how far east and north of the origin a place lies."""
        east_deg = wrap_degrees(place.longitude_deg - self._longitude_deg)
        north_deg = place.latitude_deg - self._latitude_deg
        return east_deg * self._east_m_per_deg, north_deg * self._north_m_per_deg


class VehicleMotion(NamedTuple):
    """A vehicle at its last telemetry, `age_s` ago.

    `low_m` and `high_m` are equal but for a vehicle of unknown height. `velocity_mps` is
    east, north, up. `go_home_up_m` is the height of its route home, as seen once that differs
    from what is asked, None when it is not known; `home_m` the place in the plane.
    """

    state: VehicleState
    plane: Plane
    east_m: float
    north_m: float
    low_m: float
    high_m: float
    velocity_mps: tuple[float, float, float]
    speed_mps: float
    age_s: float
    takeoff_up_m: float | None
    home_m: tuple[float, float] | None
    go_home_up_m: float | None
    goes_home: bool
    """Whether it may go home on its own when it loses its controller."""
    is_ground_known: bool = True
    """Whether the height of its takeoff point is that of a pad or of an elevation model."""
    drift_m: float = 0.0
    """How far its barometer may have drifted since takeoff: its heights are known to this, up and
    down. Where vehicles are compared it is taken off the gap; limits and zones have margins."""

    @property
    def name(self) -> str:
        """The display name."""
        return self.state.display_name

    def at_any_height(self) -> "VehicleMotion":
        """Return the same motion at an unknown height."""
        return self._replace(
            low_m=-ALL_HEIGHTS_M, high_m=ALL_HEIGHTS_M, takeoff_up_m=None, go_home_up_m=None
        )

    def up_m(self, height_above_takeoff_m: float) -> tuple[float, float]:
        """Return the band of heights that one above its takeoff point is in."""
        if self.takeoff_up_m is None:
            return -ALL_HEIGHTS_M, ALL_HEIGHTS_M
        up_m = self.takeoff_up_m + height_above_takeoff_m
        return up_m, up_m


def vehicle_motion(
    state: VehicleState,
    airspace: PreparedAirspace,
    plane: Plane,
    now_ns: int,
    settings: PredictionSettings,
) -> VehicleMotion | None:
    """Return a vehicle in the plane; None when it has never reported a position.

    One without a position now is at its last known one, with that position's age.
    """
    place, at_ns = last_place(state)
    if place is None:
        return None
    profile, home_place = state.profile, home(state)
    base_m = takeoff_up_m_at(airspace, state, home_place)
    height_m = state.height_above_takeoff_m.value
    up_m = None if base_m is None or height_m is None else base_m + height_m
    go_home_m = seen_height_m(state)
    if go_home_m is None and profile is not None:
        go_home_m = profile.go_home_height_m
    velocity_mps, speed_mps = _velocity(state, settings)
    east_m, north_m = plane.east_north_m(place)
    return VehicleMotion(
        state=state,
        plane=plane,
        east_m=east_m,
        north_m=north_m,
        low_m=-ALL_HEIGHTS_M if up_m is None else up_m,
        high_m=ALL_HEIGHTS_M if up_m is None else up_m,
        velocity_mps=velocity_mps,
        speed_mps=speed_mps,
        age_s=age_at(now_ns, at_ns),
        takeoff_up_m=base_m,
        home_m=None if home_place is None else plane.east_north_m(home_place),
        go_home_up_m=None if go_home_m is None or base_m is None else base_m + go_home_m,
        goes_home=profile is None or profile.failsafe in (None, Failsafe.GO_HOME),
        is_ground_known=is_takeoff_height_known(airspace, state, home_place),
        drift_m=height_drift_m(state, now_ns, settings),
    )


def height_drift_m(
    state: VehicleState, now_ns: int, settings: PredictionSettings, ahead_s: float = 0.0
) -> float:
    """Return how far a vehicle's height may have drifted by now, or `ahead_s` from now."""
    since_ns = state.airborne_since_ns
    if since_ns is None:
        return 0.0
    return settings.height_drift_m_per_h * (age_at(now_ns, since_ns) + ahead_s) / S_PER_HOUR


def unknown_heights(motions: Sequence[VehicleMotion]) -> BoolArray | None:
    """Return the pairs of V vehicles whose heights cannot be compared, (V, V); None: no pair.

    Where the ground of a takeoff point is not known, flat ground is assumed: right for two that
    took off within `SAME_GROUND_M` of each other, and for others wrong by the slope between.
    """
    if all(motion.is_ground_known for motion in motions):
        return None
    known = np.array([motion.is_ground_known for motion in motions])
    homes_m = np.array([motion.home_m or (np.nan, np.nan) for motion in motions])
    east_m, north_m = homes_m.T[:, :, np.newaxis]
    apart_m = np.hypot(east_m - east_m.T, north_m - north_m.T)
    # For an unknown home the comparison is False.
    return np.asarray(~((known & known[:, np.newaxis]) | (apart_m <= SAME_GROUND_M)))


def age_at(now_ns: int, at_ns: int) -> float:
    """Return the age in seconds of what was received at a time; never negative."""
    return max(0.0, (now_ns - at_ns) / NS_PER_S)


def last_place(state: VehicleState) -> tuple[LatLon | None, int]:
    """Return a vehicle's last known position and its time; None if it never reported one."""
    position: Stamped[LatLon] = state.position
    if position.value is not None:
        return position.value, position.received_at_ns or 0
    if not state.track:
        return None, 0
    last = state.track[-1]
    return LatLon(last.latitude_deg, last.longitude_deg), last.at_ns


def plausible_speed_mps(state: VehicleState, settings: PredictionSettings) -> float:
    """Return a vehicle's horizontal speed, no faster than any flies; unknown counts as fast."""
    velocity = state.velocity_ned.value
    if velocity is None:
        return settings.unknown_speed_mps
    return min(_speed_mps(velocity), settings.plausible_speed_mps)


def _speed_mps(velocity: VelocityNed) -> float:
    return float((velocity.north_mps**2 + velocity.east_mps**2) ** 0.5)


def _velocity(
    state: VehicleState, settings: PredictionSettings
) -> tuple[tuple[float, float, float], float]:
    """The velocity east, north, up and its plausible horizontal speed; unknown counts as fast."""
    velocity, plausible_mps = state.velocity_ned.value, plausible_speed_mps(state, settings)
    if velocity is None:
        return (0.0, 0.0, 0.0), plausible_mps
    speed_mps = _speed_mps(velocity)
    share = 1.0 if speed_mps <= plausible_mps else plausible_mps / speed_mps
    return (
        (velocity.east_mps * share, velocity.north_mps * share, -velocity.down_mps),
        plausible_mps,
    )
