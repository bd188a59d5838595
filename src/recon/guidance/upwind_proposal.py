"""The proposal of a place upwind: what an imaging drone sees from there, and what it costs to go.

The question is what the station knows at one moment; the answer is 12 ms of geometry for a field
of 14 ha, and pure, so that a worker finds it. `MoveUpwindSettings` decides whether the drone flies
there automatically: the wind as measured wavers, and each flight interrupts the view.
"""

from dataclasses import dataclass
from math import hypot

import numpy as np

from recon.geo import Polygon, enu_from_point, point_from_enu
from recon.guidance.upwind_place import (
    GroundView,
    UpwindPlace,
    best_place,
    field_points_m,
    seen_from,
)
from recon.model.airspace import Region
from recon.model.arrays import BoolArray, FloatArray
from recon.model.geo import GeoPoint, LatLon, LocalFrame
from recon.model.units import wrap_degrees

SPEED_MPS = 8.0
EDGE_M = 30.0
"""Distance from boundary and keep-out zones: more than the gate, which decides, requires."""
LEAST_GAIN = 0.03
"""Least gain in a place's worth for a flight there."""
LEAST_TILT_RAD = 0.1
"""A camera tilted by less sees as much in every direction: the heading stays."""
STATED_LEAD_S = 60.0


@dataclass(frozen=True, slots=True)
class MoveUpwindSettings:
    """Limits of an imaging drone's automatic flights upwind, for a survey that allows them."""

    asked_every_s: float = 10.0
    """Time between two proposals: the wind turns in minutes; one costs the worker 12 ms or more."""

    answered_within_s: float = 30.0
    """A proposal waits behind a frame's job or two; after this it counts as lost."""

    better_by: float = 0.06
    """Least automatic gain in a place's worth: with the same view of the field now, an eighth more
    of its shade in the next two minutes. Smaller gains are within the measured velocity's error."""

    better_for_s: float = 30.0
    """Time for which a place is better before a move; a gain below `LEAST_GAIN` begins the time
    anew. Velocities measured in the first half minute of shade still change."""

    every_s: float = 180.0
    """Shortest time between two automatic ones: the wind turns in minutes; a flight takes 30 s."""

    refused_again_s: float = 60.0
    """Time after a refusal before the next attempt."""

    late_by_s: float = 30.0
    """Allowance for picking up speed, gusts and headwind; a flight that exceeds its own time by
    more is not flown as it was ordered."""


MOVE_UPWIND_SETTINGS = MoveUpwindSettings()


@dataclass(frozen=True, slots=True, eq=False)
class UpwindQuestion:
    """One imaging drone, the shadows' velocity, and where the drone may hover, at one moment.

    Regions and places are in east-north metres of `frame`.
    """

    serial: str
    frame: LocalFrame
    regions: tuple[Region, ...]
    """Regions to be seen; at least one."""
    velocity_mps: tuple[float, float]
    """Velocity of the shadows, east and north."""
    view: GroundView
    followed_for_s: float
    """Time for which shade that has left the view is followed."""
    position: LatLon
    height_above_takeoff_m: float
    yaw_deg: float
    off_front_deg: float
    """Where the camera looks, clockwise from the aircraft's front."""
    boundary: Region | None = None
    keep_out: tuple[Region, ...] = ()


@dataclass(frozen=True, slots=True)
class UpwindProposal:
    """What an imaging drone sees from its place, and from the best one."""

    serial: str
    place: LatLon
    height_above_takeoff_m: float
    yaw_deg: float
    """The aircraft's heading there."""
    distance_m: float
    """0: no allowed place is much better than its own."""
    here: UpwindPlace
    there: UpwindPlace

    @property
    def takes_s(self) -> float:
        """The time to fly there."""
        return self.distance_m / SPEED_MPS

    @property
    def gain(self) -> float:
        """Return by how much the place there is worth more, in [0, 1]."""
        return self.there.worth - self.here.worth

    @property
    def sentence(self) -> str:
        """What it costs and sees; the drone's name goes before it."""
        if self.there is self.here:
            return f"sees {_seen(self.here)}; no place that is allowed sees much more"
        return (
            f"sees {_seen(self.here)}; {self.distance_m:.0f} m away, in {self.takes_s:.0f} s, it "
            f"would see {_seen(self.there)}"
        )


def propose(asked: UpwindQuestion) -> UpwindProposal:
    """Return the best place, or the present one if none is much better.

    Raises `ValueError` for an invalid polygon.
    """
    field_m = np.concatenate([_points_m(region) for region in asked.regions])
    east_m, north_m = _east_north_m(asked.frame, asked.position)
    looks_deg = wrap_degrees(asked.yaw_deg + asked.off_front_deg)
    seen_by = (asked.velocity_mps, asked.view, asked.followed_for_s)
    here = seen_from(field_m, (east_m, north_m), looks_deg, *seen_by)
    best = best_place(field_m, *seen_by, lambda places_m: _may_hover(asked, places_m))
    there = here if best is None or best.worth < here.worth + LEAST_GAIN else best
    is_turned = there is not here and asked.view.tilt_rad >= LEAST_TILT_RAD
    place = point_from_enu(asked.frame, (there.east_m, there.north_m, 0.0))
    return UpwindProposal(
        asked.serial,
        LatLon(place.latitude_deg, place.longitude_deg),
        asked.height_above_takeoff_m,
        wrap_degrees(there.heading_deg - asked.off_front_deg) if is_turned else asked.yaw_deg,
        hypot(there.east_m - east_m, there.north_m - north_m),
        here,
        there,
    )


def _seen(place: UpwindPlace) -> str:
    now, later = (round(100.0 * place.predicted_at(lead_s)) for lead_s in (0.0, STATED_LEAD_S))
    return f"{now} % of the region now and {later} % of its shade in {STATED_LEAD_S:.0f} s"


def _points_m(region: Region) -> FloatArray:
    return field_points_m(region.outline_m, Polygon(region).contains)


def _east_north_m(frame: LocalFrame, place: LatLon) -> tuple[float, float]:
    ground = GeoPoint(place.latitude_deg, place.longitude_deg, frame.origin.ellipsoid_height_m)
    east_m, north_m, _up_m = enu_from_point(frame, ground).tolist()
    return east_m, north_m


def _may_hover(asked: UpwindQuestion, places_m: FloatArray) -> BoolArray:
    """Return which places (N, 2) lie inside the boundary and outside keep-out zones."""
    allowed = np.ones(len(places_m), dtype=np.bool_)
    if asked.boundary is not None:
        allowed &= Polygon(asked.boundary).distance_to_edge_m(places_m) >= EDGE_M
    for region in asked.keep_out:
        allowed &= Polygon(region).distance_to_edge_m(places_m) <= -EDGE_M
    return allowed
