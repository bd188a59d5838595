"""The fleet return's plan: the order of vehicles, and the layer and path of each.

Theory of operation. Vehicles hover, and are separated by height, not by time: arrival times depend
on wind and on how long each landing takes.

1. Layers are `layer_spacing_m` apart, or as far as vehicles must be kept, from the lowest height
   that clears ground and zones, to the ceiling (`airspace`).
2. Vehicles are ordered by battery, lowest first in tenths; equal ones by distance to their pads.
3. The first vehicle that can have a free layer gets the lowest one from which its whole flight
   (column up or down, level path, column over the pad) is separated from all vehicles that still
   hover; a column that leads away from one that is too near already need not be. Paths avoid
   closed zones by a visibility graph and Dijkstra's search (`paths`).
   Layers of flights that are under way are not free: a vehicle recalled later need not wait.
4. When no free layer is left or fits, the next wave begins with all layers free.
5. A vehicle that fits in no layer while all layers are free is excluded, with the reason.

Since each flight is separated from everything that hovers after it in the order, the next flight
can always begin once those under way have landed, whatever happens to them. When a flight may begin
is decided by `turn`, from the volumes that others may still pass: never from predicted times.

Source: layers assigned by priority are prioritized planning (Erdmann and Lozano-Perez 1987), with
whole volumes in place of trajectories in time.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise
from math import floor, hypot, isfinite

import shapely  # type: ignore[import-untyped, unused-ignore]

from recon.guidance.fleet_return.flight import (
    CalledVehicle,
    EastNorth,
    ExcludedVehicle,
    Hovering,
    Place,
    ReturnFlight,
    ReturnPlan,
    Separation,
    are_apart,
    column,
    distance_to_leg_m,
    leads_away,
    point,
)
from recon.guidance.fleet_return.paths import ReturnPaths, RouteHome
from recon.guidance.fleet_return.settings import FleetReturnSettings

NO_WAY = "no path to its pad in any layer around keep-out zones and hovering vehicles"


def layers_up_m(
    home: RouteHome, settings: FleetReturnSettings, separation: Separation
) -> tuple[float, ...]:
    """Return the heights of all layers, from the lowest; none where there is no room."""
    room_m = home.highest_up_m - home.lowest_up_m
    if not isfinite(room_m) or room_m < 0.0:
        return ()
    spacing_m = max(settings.layer_spacing_m, separation.vertical_m)
    count = floor(room_m / spacing_m) + 1
    return tuple(home.lowest_up_m + i * spacing_m for i in range(count))


def plan_return(
    vehicles: Sequence[CalledVehicle],
    home: RouteHome,
    separation: Separation,
    settings: FleetReturnSettings,
    others: Sequence[Hovering] = (),
    first_wave: int = 1,
    occupied_m: Sequence[float] = (),
) -> ReturnPlan:
    """Return the plan for vehicles that hover. `others` hover too and are not called.

    `separation` is the least one with its slack. `occupied_m` are the layers of flights that are
    under way. Everyone named is in a flight or excluded.
    """
    layers_m = layers_up_m(home, settings, separation)
    search = _Search(vehicles, home, separation, layers_m, others)
    waiting = sorted(vehicles, key=_turn)
    flights: list[ReturnFlight] = []
    wave = first_wave
    free_m = [
        layer_m
        for layer_m in layers_m
        if all(abs(layer_m - other_m) >= separation.vertical_m for other_m in occupied_m)
    ]
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
    excluded = tuple(ExcludedVehicle(v.serial, v.name, search.reason(v, waiting)) for v in waiting)
    return ReturnPlan(layers_m, tuple(flights), excluded)


def _turn(vehicle: CalledVehicle) -> tuple[int, float, str]:
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
        vehicles: Sequence[CalledVehicle],
        home: RouteHome,
        separation: Separation,
        layers_m: Sequence[float],
        others: Sequence[Hovering],
    ) -> None:
        self._home = home
        self._paths = ReturnPaths(home)
        self._separation = separation
        self._layers_m = layers_m
        self._others = others
        self._column_faults = {v.serial: self._closed_column(v) for v in vehicles}
        self._faults: dict[tuple[str, float], _Fault] = {}

    def next_flight(
        self, waiting: Sequence[CalledVehicle], free_m: Sequence[float], wave: int
    ) -> ReturnFlight | None:
        """Return the flight of the first vehicle, in their order, that can have one."""
        hovering = self._hovering(waiting)
        for vehicle in waiting:
            for layer_m in free_m:
                flight = self._flight(vehicle, hovering, layer_m, wave)
                if isinstance(flight, ReturnFlight):
                    return flight
        return None

    def reason(self, vehicle: CalledVehicle, waiting: Sequence[CalledVehicle]) -> str:
        """Return why a vehicle has no flight."""
        room_m = self._home.highest_up_m - self._home.lowest_up_m
        if not isfinite(room_m):
            return "the height of the ground is not known everywhere on the routes home"
        if not self._layers_m:
            return (
                "there is no height to return in: the lowest one above ground and zones is "
                f"{-room_m:.0f} m above the ceiling"
            )
        hovering = self._hovering(waiting)
        tried = (self._flight(vehicle, hovering, layer_m, 1) for layer_m in self._layers_m)
        return next(fault.reason for fault in tried if isinstance(fault, _Fault))

    def _hovering(self, waiting: Sequence[CalledVehicle]) -> dict[str, Hovering]:
        return {other.key: other for other in (*self._others, *(v.hovering for v in waiting))}

    def _flight(
        self, vehicle: CalledVehicle, hovering: Mapping[str, Hovering], layer_m: float, wave: int
    ) -> ReturnFlight | _Fault:
        known = self._faults.get((vehicle.serial, layer_m))
        if known is not None and known.while_hovering <= hovering.keys():
            return known
        others = [other for key, other in hovering.items() if key != vehicle.serial]
        found = self._column_fault(vehicle, layer_m, others) or self._path(vehicle, layer_m, others)
        if isinstance(found, _Fault):
            self._faults[vehicle.serial, layer_m] = found
            return found
        return ReturnFlight(
            vehicle.serial,
            vehicle.name,
            vehicle.place_m,
            vehicle.takeoff_up_m,
            vehicle.pad,
            layer_m,
            found,
            wave,
        )

    def _path(
        self, vehicle: CalledVehicle, layer_m: float, others: Sequence[Hovering]
    ) -> tuple[EastNorth, ...] | _Fault:
        start_m, end_m = vehicle.place_m[:2], vehicle.pad.east_north_m
        alone = self._paths.find(start_m, end_m, layer_m)
        if alone is None:
            return _Fault(self._no_path(vehicle, layer_m))
        near = [other for other in others if self._is_near_height(other.place_m, layer_m)]
        spots = [other.place_m[:2] for other in near]
        circle_m = self._separation.horizontal_m
        if all(
            distance_to_leg_m(spot, *leg) >= circle_m for spot in spots for leg in pairwise(alone)
        ):
            return alone
        around = self._paths.find_around(start_m, end_m, layer_m, spots, circle_m)
        return around or _Fault(NO_WAY, frozenset(other.key for other in near))

    def _is_near_height(self, place_m: Place, layer_m: float) -> bool:
        return abs(place_m[2] - layer_m) < self._separation.vertical_m

    def _no_path(self, vehicle: CalledVehicle, layer_m: float) -> str:
        if not self._paths.is_in_reach(vehicle.pad.east_north_m, layer_m):
            where = f"its pad {vehicle.pad.name}"
        elif not self._paths.is_in_reach(vehicle.place_m[:2], layer_m):
            where = "it"
        else:
            return NO_WAY
        return (
            f"{where} is outside the site, in a keep-out zone, or nearer than "
            f"{self._home.margin_m:.0f} m to its edge"
        )

    def _column_fault(
        self, vehicle: CalledVehicle, layer_m: float, others: Sequence[Hovering]
    ) -> _Fault | None:
        """Return why it cannot climb, sink or land: a zone, or a vehicle that hovers there."""
        closed = self._column_faults[vehicle.serial]
        if closed is not None:
            return _Fault(closed)
        pad, up_m = vehicle.pad, vehicle.place_m[2]
        own = column(vehicle.place_m[:2], up_m, layer_m)
        landing = column(pad.east_north_m, layer_m, pad.up_m)
        for other in others:
            leaves = leads_away(up_m, layer_m, other.place_m[2])
            columns = (landing,) if leaves else (own, landing)
            if not are_apart(columns, [point(other.place_m)], self._separation):
                reason = (
                    f"{other.name} hovers where it would climb, sink or land: nearer than "
                    f"{self._separation.horizontal_m:.0f} m beside and "
                    f"{self._separation.vertical_m:.0f} m in height"
                )
                return _Fault(reason, frozenset({other.key}))
        return None

    def _closed_column(self, vehicle: CalledVehicle) -> str | None:
        """Why the vehicle can climb or sink neither where it is nor at its pad."""
        if not self._layers_m:
            return None
        pad = vehicle.pad
        for words, spot in (
            ("it is over", column(vehicle.place_m[:2], vehicle.place_m[2], self._layers_m[0])),
            (f"its pad {pad.name} is in", column(pad.east_north_m, pad.up_m, self._layers_m[0])),
        ):
            here = shapely.Point(*spot.start_m)
            for piece in self._home.closed:
                reaches = spot.high_m > piece.low_up_m and spot.low_m < piece.high_up_m
                is_over = shapely.distance(piece.area, here) < self._home.margin_m
                if piece.blocks_vertical and reaches and is_over:
                    return f"{words} the keep-out zone {piece.name}"
        return None
