"""Missions repaired to what DJI accepts, and cut into parts that each fit; every repair is told.

DJI's SDK rejects what does not fit without a word (decisions on the ICD, "What DJI accepts").
What can be put right without changing where a mission goes is put right here, before the gate
judges the result:

- Waypoints nearer than 1 m to the one before are merged into it; no other waypoint ever moves.
- Legs longer than 2 km get waypoints on them; on a globe the straight line between two places is
  bowed, so these lie up to 0.1 % of the leg's length beside the line a map would draw.
- Speeds, stays, gimbal angles and corner radii are brought into their ranges. A corner is made
  smaller, never larger but for the least radius of 0.2 m; so the path stays inside its old corner.
- Too many waypoints, a path longer than 30 km, or ends nearer than 1 m or farther than 2 km
  from each other: the mission is flown in parts. A part begins at the waypoint where the one
  before ended, and hovers at its end, except the last.

What cannot be put right so (a single waypoint, a number that is none, a place off the globe, a
height out of range, a curved mission with actions) stays as it is; the gate refuses it.
"""

from recon.vehicles.mission_repair.limits import REPAIR_LIMITS, RepairLimits
from recon.vehicles.mission_repair.repair import Repaired, joined, repair

__all__ = ["REPAIR_LIMITS", "RepairLimits", "Repaired", "joined", "repair"]
