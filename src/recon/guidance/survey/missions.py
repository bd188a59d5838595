"""Rows as the missions that are sent: a stop at both ends of each row, the camera straight down."""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from math import hypot

import numpy as np

from recon.geo import geo_from_enu
from recon.guidance.survey.lattice import RowLattice
from recon.guidance.survey.route import Place, Route
from recon.guidance.survey.settings import SurveySettings
from recon.guidance.survey.ways import Ways
from recon.model.geo import LocalFrame
from recon.model.mission import Mission, Waypoint
from recon.model.survey import Survey

NADIR_DEG = -90.0
LEAST_LEG_M = 1.0
"""DJI refuses waypoints nearer than 0.5 m."""


@dataclass(frozen=True, slots=True)
class Track:
    """A route with its ways between rows: the corners in east-north metres of the site."""

    corners_m: tuple[Place, ...]

    @property
    def length_m(self) -> float:
        """From the first corner to the last."""
        return sum(apart_m(a, b) for a, b in pairwise(self.corners_m))


def track_of(route: Route, lattice: RowLattice, lead_m: float, ways: Ways) -> Track | None:
    """Return where a route leads; between rows inside the ways' area, None where it has no way."""
    corners: list[Place] = []
    for leg in route:
        start_m, end_m = _east_north(leg.ends_m(lattice, lead_m), lattice)
        if corners:
            between = ways.between(corners[-1], start_m)
            if between is None:
                return None
            corners += between
        corners += [start_m, end_m]
    return Track(_thinned(corners))


def flight_time_s(
    track: Track, speed_mps: float, start_m: Place, home_m: Place, settings: SurveySettings
) -> float:
    """Return how long a track takes with the way to it and the way home, stops included."""
    stops = len(track.corners_m) + 1
    way_m = apart_m(start_m, track.corners_m[0]) + apart_m(track.corners_m[-1], home_m)
    return (track.length_m + way_m) / speed_mps + stops * speed_mps / settings.turning_mps2


def mission_of(track: Track, survey: Survey, frame: LocalFrame, purpose: str) -> Mission:
    """Return the mission that flies a track. It hovers at its end."""
    flat_m = np.column_stack([np.array(track.corners_m), np.zeros(len(track.corners_m))])
    latitude_deg, longitude_deg, _ = geo_from_enu(frame, flat_m)
    return Mission(
        tuple(
            Waypoint(
                float(latitude),
                float(longitude),
                survey.height_above_takeoff_m,
                survey.speed_mps,
                gimbal_pitch_deg=NADIR_DEG if index == 0 else None,
            )
            for index, (latitude, longitude) in enumerate(
                zip(latitude_deg, longitude_deg, strict=True)
            )
        ),
        purpose=purpose,
    )


def apart_m(a: Place, b: Place) -> float:
    """Return how far two places are from each other."""
    return hypot(a[0] - b[0], a[1] - b[1])


def _east_north(ends: Sequence[Place], lattice: RowLattice) -> tuple[Place, Place]:
    start, end = lattice.east_north_m(np.array(ends)).tolist()
    return (start[0], start[1]), (end[0], end[1])


def _thinned(corners: Sequence[Place]) -> tuple[Place, ...]:
    """Without the corners that are too near to the one before."""
    kept: list[Place] = []
    for corner in corners:
        if not kept or apart_m(kept[-1], corner) >= LEAST_LEG_M:
            kept.append(corner)
    return tuple(kept)
