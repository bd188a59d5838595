"""Repairs missions to what DJI accepts and divides them into parts; every repair is reported.

DJI's SDK silently rejects missions outside its limits (decisions on the ICD, "What DJI accepts").
What can be repaired without changing where a mission goes is repaired here, before the gate judges
the result:

- Waypoints closer than 1 m to the previous one are merged into it; no other waypoint ever moves.
- Legs longer than 2 km get intermediate waypoints; because the straight line on a map differs from
  the geodesic, these lie up to 0.1 % of the leg's length beside the line.
- Speeds, loiter times, gimbal angles and corner radii are limited to their ranges. A corner only
  becomes smaller (down to the least radius of 0.2 m), so the path stays inside its old corner.
- Too many waypoints, a path longer than 30 km, or ends closer than 1 m or farther than 2 km from
  each other: the mission is flown in parts. A part begins at the waypoint where the previous one
  ended, and hovers at its end, except the last.

What cannot be repaired (a single waypoint, NaN, an invalid position, a height out of range, a
curved mission with actions) stays as it is, and the gate refuses it.
"""

from recon.vehicles.mission_repair.repair import Repaired, joined, repair
from recon.vehicles.mission_repair.steps import REPAIR_LIMITS, RepairLimits
