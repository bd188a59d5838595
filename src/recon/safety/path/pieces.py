"""What a command makes a vehicle fly, in pieces: where each is, how high, and what it is called."""

from dataclasses import dataclass
from enum import IntEnum
from functools import cached_property
from math import inf, isfinite

import numpy as np

from recon.geo import Footprints, OnGlobe
from recon.model.arrays import BoolArray, FloatArray, IntArray
from recon.model.geo import LocalFrame
from recon.model.vehicle import Failsafe, VehicleProfile, VehicleState
from recon.safety import datum
from recon.safety.situation import Situation


@dataclass(frozen=True, slots=True)
class UnknownPath:
    """Why the path of an order cannot be determined."""

    reason: str


@dataclass(frozen=True, slots=True, eq=False)
class Departure:
    """What is known of a vehicle before it sets out, in the frame's metres.

    `here_m` and `home_m` are (3,). `go_home_m` are the least and the most up_m that it goes home
    at: equal, or -inf and +inf while unknown.
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
        return UnknownPath(f"{name}: position unknown; wait for a GNSS fix")
    if height_m is None:
        return UnknownPath(f"{name}: no height telemetry; check its companion app")
    if home is None:
        return UnknownPath(
            f"{name}: home unknown: it took off before telemetry was received; write its pad into "
            "site.toml, or let its pilot land it and take off again"
        )
    frame, takeoff_m = datum.frame_for(airspace, vehicle), datum.takeoff_up_m(airspace, vehicle)
    if frame is None or takeoff_m is None:
        return UnknownPath(
            f"{name}: the elevation model has no ground at its takeoff point, so its heights "
            "cannot be related to the site; write its pad's altitude into site.toml"
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
    """Aircraft go home unless their profile states otherwise."""
    return (profile.failsafe if profile is not None else None) or Failsafe.GO_HOME


class Kind(IntEnum):
    """What a piece of a path is."""

    FLIGHT = 0
    """Part flown by the station's order: the path there, a leg, what a stick may cover."""
    CORNER = 1
    """Where a curved mission may fly at a waypoint: the hull of the corner."""
    CLIMB = 2
    """Straight up from a flight or a corner to the go-home height."""
    ROUTE_HOME = 3
    """Straight home at the go-home height, from every point of a flight."""
    LANDING = 4
    """Straight down to the ground: at the end, at home, or by the aircraft's failsafe."""


_WORDS = {
    Kind.FLIGHT: "{}",
    Kind.CORNER: "{}",
    Kind.CLIMB: "the climb before the route home from {}",
    Kind.ROUTE_HOME: "the route home from {}",
    Kind.LANDING: "the landing at {}",
}


@dataclass(frozen=True, slots=True, eq=False)
class Pieces:
    """N pieces. Each is somewhere in the hull of its three points, between low and high.

    `triangles_m` is (N, 3, 2), east and north; a leg is (start, end, end). `low_m` and `high_m`
    (N,) are up_m of the frame; -inf is the ground, +inf an unknown height. `is_entry`
    (N,) tells which begin where the vehicle is. `names` has what each piece, or the flight that it
    is about, is called.
    """

    kinds: IntArray
    triangles_m: FloatArray
    low_m: FloatArray
    high_m: FloatArray
    is_entry: BoolArray
    names: tuple[str, ...]

    def __len__(self) -> int:
        return len(self.kinds)

    def only(self, mask: BoolArray) -> "Pieces":
        """Return the pieces of a mask (N,)."""
        return Pieces(
            self.kinds[mask],
            self.triangles_m[mask],
            self.low_m[mask],
            self.high_m[mask],
            self.is_entry[mask],
            tuple(self.names[index] for index in np.flatnonzero(mask)),
        )

    def label(self, index: int) -> str:
        """Return the name of a piece, as refusals show it."""
        return _WORDS[Kind(self.kinds[index])].format(self.names[index])


class PathVolume:
    """Where a command may take a vehicle; flights are in the order in which they are flown."""

    def __init__(self, pieces: Pieces, departure: Departure) -> None:
        self.pieces = pieces
        self.departure = departure

    @property
    def here_m(self) -> FloatArray:
        """Where the vehicle is now, (3,)."""
        return self.departure.here_m

    @property
    def home_m(self) -> FloatArray:
        """Where it would go home to, (3,)."""
        return self.departure.home_m

    @cached_property
    def footprints(self) -> Footprints:
        """What each piece covers on the ground."""
        return Footprints(self.pieces.triangles_m)

    @cached_property
    def here(self) -> Footprints:
        """The place where the vehicle is."""
        return Footprints(self.here_triangle_m)

    @property
    def here_triangle_m(self) -> FloatArray:
        """The same as three times one point, (1, 3, 2)."""
        return np.broadcast_to(self.here_m[:2], (1, 3, 2))

    def subject(self, index: int) -> str:
        """Return the vehicle's name and a piece's label, as a refusal begins."""
        return f"{self.departure.vehicle.display_name}: {self.pieces.label(index)}"

    def heights(self, index: int) -> str:
        """Return a piece's heights as a pilot reads them: above the takeoff point."""
        low_m, high_m = float(self.pieces.low_m[index]), float(self.pieces.high_m[index])
        takeoff_m = self.departure.takeoff_m
        low = "the ground" if low_m == -inf else f"{low_m - takeoff_m:.1f} m"
        high = "an unknown go-home height" if high_m == inf else f"{high_m - takeoff_m:.1f} m"
        return f"{high} above takeoff" if low == high else f"{low} to {high} above takeoff"

    def height_parameters(self, index: int) -> dict[str, float]:
        """Return a piece's finite heights above takeoff as a refusal's parameters."""
        low_m, high_m = float(self.pieces.low_m[index]), float(self.pieces.high_m[index])
        heights_m = {"lowest_above_takeoff_m": low_m, "highest_above_takeoff_m": high_m}
        return {
            name: up_m - self.departure.takeoff_m
            for name, up_m in heights_m.items()
            if isfinite(up_m)
        }

    @cached_property
    def held_to_heights(self) -> IntArray:
        """The indices of the pieces that the site's height limits are for: not climbs, landings."""
        return np.flatnonzero(self.of_kinds(Kind.FLIGHT, Kind.CORNER, Kind.ROUTE_HOME))

    def of_kinds(self, *kinds: Kind) -> BoolArray:
        """Return which pieces are of these kinds, (N,)."""
        wanted = np.zeros(len(Kind), dtype=np.bool_)
        wanted[[*kinds]] = True
        return wanted[self.pieces.kinds]


def joined(*blocks: Pieces) -> Pieces:
    """Return all pieces of all blocks, in order."""
    return Pieces(
        np.concatenate([block.kinds for block in blocks]),
        np.concatenate([block.triangles_m for block in blocks]),
        np.concatenate([block.low_m for block in blocks]),
        np.concatenate([block.high_m for block in blocks]),
        np.concatenate([block.is_entry for block in blocks]),
        tuple(name for block in blocks for name in block.names),
    )


def block(
    kind: Kind,
    triangles_m: FloatArray,
    low_m: FloatArray,
    high_m: FloatArray,
    names: tuple[str, ...],
    *,
    is_entry: BoolArray | None = None,
) -> Pieces:
    """Return pieces of one kind, none of them an entry by default."""
    count = len(triangles_m)
    return Pieces(
        np.full(count, int(kind)),
        triangles_m,
        low_m,
        high_m,
        np.zeros(count, dtype=np.bool_) if is_entry is None else is_entry,
        names,
    )


def legs_between(
    points_m: FloatArray,
    names: tuple[str, ...],
    *,
    is_entry: BoolArray | None = None,
) -> Pieces:
    """Return the flights from each of (N + 1, 3) points to the next, every height between."""
    starts, ends = points_m[:-1], points_m[1:]
    triangles_m = np.stack([starts[:, :2], ends[:, :2], ends[:, :2]], axis=1)
    low_m = np.minimum(starts[:, 2], ends[:, 2])
    high_m = np.maximum(starts[:, 2], ends[:, 2])
    return block(Kind.FLIGHT, triangles_m, low_m, high_m, names, is_entry=is_entry)
