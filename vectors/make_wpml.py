"""Writes the missions of `wpml/` and, by the station's writer, the documents of their files.

The companion app must produce the same documents, element by element:

    python vectors/make_wpml.py [FOLDER]      # default: the folder of this file

`wpml/<case>.json` is a mission with SI units in its names; `<case>.template.kml` and
`<case>.waylines.wpml` are what a KMZ of it holds.
"""

import json
import sys
from dataclasses import asdict
from pathlib import Path

from recon.model.mission import Waypoint
from recon.plans.aircraft import AircraftModel
from recon.plans.flight_plan import AtEnd, ExportedPlan
from recon.plans.wpml import WpmlOptions, template_kml, waylines_wpml

CREATED_MS = 1_700_000_000_000
MAVIC_3M = AircraftModel(77, 2, None)


def spiral(count: int, **known: float) -> list[Waypoint]:
    """Return waypoints on a square that grows: no two are near each other."""
    steps = ((0, 0), (1, 0), (1, 1), (-1, 1), (-1, -2), (3, -2), (3, 4))[:count]
    return [
        Waypoint(41.9 + 0.0005 * north, -93.6 + 0.0007 * east, **{**MOVING, **known})
        for north, east in steps
    ]


MOVING = {"height_above_takeoff_m": 60.0, "speed_mps": 7.5}


def missions() -> dict[str, tuple[ExportedPlan, AircraftModel | None]]:
    """Return the cases by their names: the ends, turns, heights and actions that both know."""
    rows = spiral(6)
    rows[0] = Waypoint(41.9, -93.6, 60.0, 7.5, gimbal_pitch_deg=-90.0)
    slope = [
        Waypoint(each.latitude_deg, each.longitude_deg, 40.125 + 3.25 * k, 4.0 + k)
        for k, each in enumerate(spiral(5))
    ]
    acts = spiral(7)
    acts[2] = Waypoint(41.9005, -93.5993, 60.0, 7.5, loiter_s=2.5)
    acts[4] = Waypoint(41.8995, -93.6014, 60.0, 7.5, loiter_s=1.0, gimbal_pitch_deg=-45.0)
    curved = spiral(6, corner_radius_m=8.0)
    return {
        "rows": (ExportedPlan("", "", tuple(rows), at_end=AtEnd.HOVER), MAVIC_3M),
        "slope": (ExportedPlan("", "", tuple(slope), at_end=AtEnd.LAND), None),
        "actions": (ExportedPlan("", "", tuple(acts), at_end=AtEnd.HOVER), MAVIC_3M),
        "curved": (ExportedPlan("", "", tuple(curved), at_end=AtEnd.LAND, curved=True), MAVIC_3M),
        "below_takeoff": (ExportedPlan("", "", tuple(spiral(2, **LOW)), at_end=AtEnd.HOVER), None),
    }


LOW = {"height_above_takeoff_m": -12.0, "speed_mps": 1.0}


def main(root: Path) -> None:
    """Writes every case below `root`."""
    folder = root / "wpml"
    folder.mkdir(parents=True, exist_ok=True)
    for name, (plan, aircraft) in missions().items():
        options = WpmlOptions(CREATED_MS, aircraft)
        stated = {
            "created_ms": CREATED_MS,
            "drone": None if aircraft is None else [aircraft.enum_value, aircraft.sub_enum_value],
            "curved": plan.curved,
            "land_at_end": plan.at_end is AtEnd.LAND,
            "waypoints": [asdict(each) for each in plan.waypoints],
        }
        text = json.dumps(stated, indent=1, sort_keys=True)
        (folder / f"{name}.json").write_text(text + "\n", encoding="ascii")
        (folder / f"{name}.template.kml").write_bytes(template_kml(plan, options) + b"\n")
        (folder / f"{name}.waylines.wpml").write_bytes(waylines_wpml(plan, options) + b"\n")


if __name__ == "__main__":
    main(Path(sys.argv[1]) if len(sys.argv) > 1 else Path(__file__).parent)
