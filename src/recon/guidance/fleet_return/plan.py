"""The plan: who flies when, in which layer, along which way.

One after the other, each vehicle gets the lowest layer that is left in its wave and from which its
whole flight (column, way, pad's column) stays apart from all that still hover. So, whatever happens
to those that are under way, the next in the plan can always begin when they have landed.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise
from math import floor, hypot, isfinite

import shapely  # type: ignore[import-untyped, unused-ignore]

from recon.guidance.fleet_return.airspace import WayHome
from recon.guidance.fleet_return.flight import (
    EastNorth,
    Flight,
    Hovering,
    LeftOut,
    Place,
    Returning,
    ReturnPlan,
)
from recon.guidance.fleet_return.settings import FleetReturnSettings
from recon.guidance.fleet_return.volume import (
    Separation,
    are_apart,
    column,
    distance_to_leg_m,
    point,
)
from recon.guidance.fleet_return.ways import Ways

NO_WAY = "there is no way to its pad in any layer around keep-out zones and those that hover"


def layers_up_m(home: WayHome, settings: FleetReturnSettings) -> tuple[float, ...]:
    """Return the heights of all layers, from the lowest; none where there is no room."""
    room_m = home.highest_up_m - home.lowest_up_m
    if not isfinite(room_m) or room_m < 0.0:
        return ()
    count = floor(room_m / settings.layer_spacing_m) + 1
    return tuple(home.lowest_up_m + i * settings.layer_spacing_m for i in range(count))


def plan_return(
    vehicles: Sequence[Returning],
    home: WayHome,
    separation: Separation,
    settings: FleetReturnSettings,
    others: Sequence[Hovering] = (),
    first_wave: int = 1,
) -> ReturnPlan:
    """Return the plan for vehicles that hover. `others` hover too and are not called.

    `separation` is the least one with its slack. Everyone named is in a flight or left out.
    """
    layers_m = layers_up_m(home, settings)
    search = _Search(vehicles, home, separation, layers_m, others)
    waiting = sorted(vehicles, key=_turn)
    flights: list[Flight] = []
    wave, free_m = first_wave, list(layers_m)
    while waiting:
        flight = search.next_flight(waiting, free_m, wave)
        if flight is not None:
            flights.append(flight)
            free_m.remove(flight.layer_up_m)
            waiting = [v for v in waiting if v.serial != flight.serial]
        elif len(free_m) < len(layers_m):
            wave, free_m = wave + 1, list(layers_m)
        else:
            break
    left_out = tuple(LeftOut(v.serial, v.name, search.reason(v, waiting)) for v in waiting)
    return ReturnPlan(layers_m, tuple(flights), left_out)


def _turn(vehicle: Returning) -> tuple[int, float, str]:
    """The lowest battery first, in tenths; among those the nearest to its pad."""
    tenths = floor((vehicle.battery_fraction or 0.0) * 10.0)
    east_m, north_m, _ = vehicle.place_m
    far_m = hypot(vehicle.pad.east_m - east_m, vehicle.pad.north_m - north_m)
    return tenths, far_m, vehicle.serial


@dataclass(frozen=True, slots=True)
class _Fault:
    """Why a vehicle has no flight in a layer: so it stays while all these hover where they do."""

    reason: str
    while_hovering: frozenset[str] = frozenset()


class _Search:
    """Tries vehicles in layers; what has failed is tried anew only when something has changed."""

    def __init__(
        self,
        vehicles: Sequence[Returning],
        home: WayHome,
        separation: Separation,
        layers_m: Sequence[float],
        others: Sequence[Hovering],
    ) -> None:
        self._home = home
        self._ways = Ways(home)
        self._separation = separation
        self._layers_m = layers_m
        self._others = others
        self._column_faults = {v.serial: self._shut_column(v) for v in vehicles}
        self._faults: dict[tuple[str, float], _Fault] = {}

    def next_flight(
        self, waiting: Sequence[Returning], free_m: Sequence[float], wave: int
    ) -> Flight | None:
        """Return the flight of the first vehicle, in their order, that can have one."""
        hovering = self._hovering(waiting)
        for vehicle in waiting:
            for layer_m in free_m:
                flight = self._flight(vehicle, hovering, layer_m, wave)
                if isinstance(flight, Flight):
                    return flight
        return None

    def reason(self, vehicle: Returning, waiting: Sequence[Returning]) -> str:
        """Return why a vehicle has no flight."""
        room_m = self._home.highest_up_m - self._home.lowest_up_m
        if not isfinite(room_m):
            return "the height of the ground is not known everywhere on the ways home"
        if not self._layers_m:
            return (
                "there is no height to return in: the lowest one above ground and zones is "
                f"{-room_m:.0f} m above the ceiling"
            )
        hovering = self._hovering(waiting)
        tried = (self._flight(vehicle, hovering, layer_m, 1) for layer_m in self._layers_m)
        return next(fault.reason for fault in tried if isinstance(fault, _Fault))

    def _hovering(self, waiting: Sequence[Returning]) -> dict[str, Hovering]:
        return {other.key: other for other in (*self._others, *(v.hovering for v in waiting))}

    def _flight(
        self, vehicle: Returning, hovering: Mapping[str, Hovering], layer_m: float, wave: int
    ) -> Flight | _Fault:
        known = self._faults.get((vehicle.serial, layer_m))
        if known is not None and known.while_hovering <= hovering.keys():
            return known
        others = [other for key, other in hovering.items() if key != vehicle.serial]
        found = self._column_fault(vehicle, layer_m, others) or self._way(vehicle, layer_m, others)
        if isinstance(found, _Fault):
            self._faults[vehicle.serial, layer_m] = found
            return found
        return Flight(
            vehicle.serial,
            vehicle.name,
            vehicle.place_m,
            vehicle.takeoff_up_m,
            vehicle.pad,
            layer_m,
            found,
            wave,
        )

    def _way(
        self, vehicle: Returning, layer_m: float, others: Sequence[Hovering]
    ) -> tuple[EastNorth, ...] | _Fault:
        start_m, end_m = vehicle.place_m[:2], vehicle.pad.east_north_m
        alone = self._ways.find(start_m, end_m, layer_m)
        if alone is None:
            return _Fault(self._no_way(vehicle, layer_m))
        near = [other for other in others if self._is_near_height(other.place_m, layer_m)]
        spots = [other.place_m[:2] for other in near]
        circle_m = self._separation.horizontal_m
        if all(
            distance_to_leg_m(spot, *leg) >= circle_m for spot in spots for leg in pairwise(alone)
        ):
            return alone
        around = self._ways.find_around(start_m, end_m, layer_m, spots, circle_m)
        return around or _Fault(NO_WAY, frozenset(other.key for other in near))

    def _is_near_height(self, place_m: Place, layer_m: float) -> bool:
        return abs(place_m[2] - layer_m) < self._separation.vertical_m

    def _no_way(self, vehicle: Returning, layer_m: float) -> str:
        if not self._ways.is_in_reach(vehicle.pad.east_north_m, layer_m):
            where = f"its pad {vehicle.pad.name}"
        elif not self._ways.is_in_reach(vehicle.place_m[:2], layer_m):
            where = "it"
        else:
            return NO_WAY
        return (
            f"{where} is outside the site, in a keep-out zone, or nearer than "
            f"{self._home.margin_m:.0f} m to its edge"
        )

    def _column_fault(
        self, vehicle: Returning, layer_m: float, others: Sequence[Hovering]
    ) -> _Fault | None:
        """Why it cannot climb, sink or land: for a zone, or for somebody who hovers there."""
        shut = self._column_faults[vehicle.serial]
        if shut is not None:
            return _Fault(shut)
        pad = vehicle.pad
        columns = (
            column(vehicle.place_m[:2], vehicle.place_m[2], layer_m),
            column(pad.east_north_m, layer_m, pad.up_m),
        )
        for other in others:
            if not are_apart(columns, [point(other.place_m)], self._separation):
                reason = (
                    f"{other.name} hovers where it would climb, sink or land: nearer than "
                    f"{self._separation.horizontal_m:.0f} m beside and "
                    f"{self._separation.vertical_m:.0f} m in height"
                )
                return _Fault(reason, frozenset({other.key}))
        return None

    def _shut_column(self, vehicle: Returning) -> str | None:
        """Why the vehicle can climb or sink neither where it is nor at its pad."""
        if not self._layers_m:
            return None
        pad = vehicle.pad
        for words, spot in (
            ("it is over", column(vehicle.place_m[:2], vehicle.place_m[2], self._layers_m[0])),
            (f"its pad {pad.name} is in", column(pad.east_north_m, pad.up_m, self._layers_m[0])),
        ):
            here = shapely.Point(*spot.start_m)
            for piece in self._home.shut:
                reaches = spot.high_m > piece.low_up_m and spot.low_m < piece.high_up_m
                is_over = shapely.distance(piece.area, here) < self._home.margin_m
                if piece.is_shut_to_columns and reaches and is_over:
                    return f"{words} the keep-out zone {piece.name}"
        return None
