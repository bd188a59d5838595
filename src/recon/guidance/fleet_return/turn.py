"""Turns: the volumes a vehicle under way may still pass, and whether another flight may begin.

No times are predicted. A flight begins when all its places are apart from all places that the
others still have before them, so that neither wind nor a slow landing brings two together.
"""

from collections.abc import Iterable
from dataclasses import dataclass
from itertools import pairwise
from math import dist, hypot

from recon.guidance.fleet_return.flight import (
    Hovering,
    Place,
    ReturnFlight,
    Separation,
    Volume,
    are_apart,
    column,
    distance_to_leg_m,
    level_legs,
    point,
)
from recon.guidance.fleet_return.settings import FleetReturnSettings


def least_time_s(flight: ReturnFlight, settings: FleetReturnSettings) -> float:
    """Return how long a flight takes at least, from its order to the ground at its pad."""
    level_m = sum(dist(a, b) for a, b in pairwise(flight.path_m))
    upright_m = abs(flight.layer_up_m - flight.start_m[2]) + flight.layer_up_m - flight.pad.up_m
    return level_m / settings.speed_mps + upright_m / settings.fastest_upright_mps


@dataclass(frozen=True, slots=True)
class Claim:
    """What a vehicle's flight takes of the air: its layer, and places it may still come to."""

    name: str
    layer_up_m: float
    volumes: tuple[Volume, ...]


def whole_claim(flight: ReturnFlight) -> Claim:
    """Return what a flight takes that has not begun."""
    return Claim(flight.name, flight.layer_up_m, flight.volumes)


def claim_left(flight: ReturnFlight, place_m: Place, settings: FleetReturnSettings) -> Claim:
    """Return what a flight under way still takes, from its vehicle's last reported place."""
    return Claim(flight.name, flight.layer_up_m, places_left(flight, place_m, settings))


def layer_is_taken_by(
    flight: ReturnFlight, before: Iterable[ReturnFlight], under_way: Iterable[ReturnFlight]
) -> str | None:
    """Return which vehicle keeps a flight from its layer, or None: the layer is free."""
    for other in under_way:
        if other.layer_up_m == flight.layer_up_m:
            return f"{other.name} is still in its layer"
    for earlier in before:
        if earlier.layer_up_m == flight.layer_up_m:
            return f"{earlier.name} has its layer first"
    return None


def hindrance(
    flight: ReturnFlight,
    before: Iterable[Claim],
    under_way: Iterable[Claim],
    hovering: Iterable[Hovering],
    separation: Separation,
) -> str | None:
    """Return why a flight whose layer is free must wait, or None: it may begin now.

    `before` are those whose turn is earlier and that wait too; `hovering` are all that hover, and
    everything else in the air.
    """
    volumes = flight.volumes
    for other in under_way:
        if not are_apart(volumes, other.volumes, separation):
            return f"{other.name} has not yet passed"
    for other_one in hovering:
        place_m = other_one.place_m
        if not are_apart(flight.volumes_past(place_m), [point(place_m)], separation):
            return f"{other_one.name} hovers too near to its path"
    for earlier in before:
        if not are_apart(volumes, earlier.volumes, separation):
            return f"{earlier.name} goes first"
    return None


def places_left(
    flight: ReturnFlight, place_m: Place, settings: FleetReturnSettings
) -> tuple[Volume, ...]:
    """Return every place a vehicle under way may still come to, where it is included.

    A vehicle that is not where its flight leads may come to all of them.
    """
    here, everything = point(place_m), flight.volumes
    landing = column(flight.pad.east_north_m, flight.layer_up_m, flight.pad.up_m)
    if _is_over_pad(flight, flight.start_m, settings):
        return (here, *everything)
    if _is_over_pad(flight, place_m, settings):
        is_landing = place_m[2] < flight.layer_up_m - settings.at_layer_m
        high_m = place_m[2] if is_landing else flight.layer_up_m
        return here, column(flight.pad.east_north_m, high_m, flight.pad.up_m)
    if abs(place_m[2] - flight.layer_up_m) > settings.at_layer_m:
        return (here, *everything)
    leg = _leg(flight, place_m, settings)
    if leg is None:
        return (here, *everything)
    rest_m = (place_m[:2], *flight.path_m[leg + 1 :])
    return (here, *level_legs(rest_m, flight.layer_up_m), landing)


def _is_over_pad(flight: ReturnFlight, place_m: Place, settings: FleetReturnSettings) -> bool:
    pad = flight.pad
    return hypot(place_m[0] - pad.east_m, place_m[1] - pad.north_m) < settings.over_pad_m


def _leg(flight: ReturnFlight, place_m: Place, settings: FleetReturnSettings) -> int | None:
    """The first leg of the way that the vehicle is on; the first, for a path may meet itself."""
    for index in range(len(flight.path_m) - 1):
        beside_m = distance_to_leg_m(place_m[:2], *flight.path_m[index : index + 2])
        if beside_m <= settings.horizontal_slack_m:
            return index
    return None
