"""Whose turn it is: what a vehicle under way still has before it, and whether another may begin.

Nothing here foresees times. A flight begins when all its places are apart from all places that the
others still have before them, so that neither wind nor a slow landing brings two together.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from math import hypot

from recon.guidance.fleet_return.flight import Flight, Place
from recon.guidance.fleet_return.settings import FleetReturnSettings
from recon.guidance.fleet_return.volume import (
    Separation,
    Volume,
    are_apart,
    column,
    distance_to_leg_m,
    level_legs,
    point,
)


@dataclass(frozen=True, slots=True)
class UnderWay:
    """A flight that has begun, and where its vehicle was last heard to be."""

    flight: Flight
    place_m: Place


def hindrance(
    flight: Flight,
    before: Sequence[Flight],
    under_way: Sequence[UnderWay],
    hovering: Mapping[str, Place],
    separation: Separation,
    settings: FleetReturnSettings,
) -> str | None:
    """Return why a flight must wait, or None: it may begin now.

    `before` are the flights whose turn is earlier and that wait too; `hovering` are the places, by
    name, of all that hover and of everything else in the air.
    """
    volumes = flight.volumes
    for other in under_way:
        name = other.flight.name
        if other.flight.layer_up_m == flight.layer_up_m:
            return f"{name} is still in its layer"
        if not are_apart(volumes, places_left(other, settings), separation):
            return f"{name} has not yet passed"
    for name, place_m in hovering.items():
        if not are_apart(volumes, [point(place_m)], separation):
            return f"{name} hovers too near to its way"
    for earlier in before:
        if not are_apart(volumes, earlier.volumes, separation):
            return f"{earlier.name} goes first"
    return None


def places_left(under_way: UnderWay, settings: FleetReturnSettings) -> tuple[Volume, ...]:
    """Return every place a vehicle under way may still come to, where it is included.

    A vehicle that is not where its flight leads may come to all of them.
    """
    flight, place_m = under_way.flight, under_way.place_m
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
    rest_m = (place_m[:2], *flight.way_m[leg + 1 :])
    return (here, *level_legs(rest_m, flight.layer_up_m), landing)


def _is_over_pad(flight: Flight, place_m: Place, settings: FleetReturnSettings) -> bool:
    pad = flight.pad
    return hypot(place_m[0] - pad.east_m, place_m[1] - pad.north_m) < settings.over_pad_m


def _leg(flight: Flight, place_m: Place, settings: FleetReturnSettings) -> int | None:
    """The first leg of the way that the vehicle is on; the first, for a way may meet itself."""
    for index in range(len(flight.way_m) - 1):
        beside_m = distance_to_leg_m(place_m[:2], *flight.way_m[index : index + 2])
        if beside_m <= settings.horizontal_slack_m:
            return index
    return None
