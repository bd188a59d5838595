"""Writes the missions of `wpml/` and, by the station's writer, the documents of their files.

The companion app must produce the same documents, element by element:

    python vectors/make_wpml.py [FOLDER]      # default: the folder of this file

`wpml/<case>.json` is a mission with SI units in its names; `<case>.template.kml` and
`<case>.waylines.wpml` are what a KMZ of it holds. `wpml/aircraft.json` has DJI's numbers of each
aircraft and camera.
"""

import json
import sys
from dataclasses import asdict, dataclass, replace
from pathlib import Path

from recon.model.mission import Waypoint
from recon.plans.aircraft import AIRCRAFT, PAYLOADS, CameraNumber
from recon.plans.flight_plan import AtEnd, ExportedPlan, PhotoTrigger
from recon.plans.wpml import WpmlOptions, template_kml, waylines_wpml

CREATED_MS = 1_700_000_000_000


def spiral(count: int, **known: float) -> list[Waypoint]:
    """Return waypoints on a square that grows: no two are near each other."""
    steps = ((0, 0), (1, 0), (1, 1), (-1, 1), (-1, -2), (3, -2), (3, 4))[:count]
    return [
        Waypoint(41.9 + 0.0005 * north, -93.6 + 0.0007 * east, **{**MOVING, **known})
        for north, east in steps
    ]


MOVING = {"height_above_takeoff_m": 60.0, "speed_mps": 7.5}


@dataclass(frozen=True)
class Case:
    """A mission, and what its file states beside it."""

    plan: ExportedPlan
    aircraft: str | None = None
    go_home_height_m: float | None = None

    def stated(self) -> dict[str, object]:
        """Return the mission in plain values."""
        photos = self.plan.photos
        return {
            "created_ms": CREATED_MS,
            "aircraft": self.aircraft,
            "go_home_height_m": self.go_home_height_m,
            "photo_every_s": None if photos is None else photos.every_s,
            "curved": self.plan.curved,
            "land_at_end": self.plan.at_end is AtEnd.LAND,
            "waypoints": [asdict(each) for each in self.plan.waypoints],
        }


def missions() -> dict[str, Case]:
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
    low = {"height_above_takeoff_m": -12.0, "speed_mps": 1.0}
    return {
        "rows": Case(hovering(rows), "Mavic 3M"),
        "slope": Case(replace(hovering(slope), at_end=AtEnd.LAND)),
        "actions": Case(hovering(acts), "Matrice 4E"),
        "curved": Case(
            replace(hovering(spiral(6, corner_radius_m=8.0)), at_end=AtEnd.LAND, curved=True),
            "Matrice 30T",
        ),
        "below_takeoff": Case(hovering(spiral(2, **low))),
        "photos": Case(replace(hovering(rows), photos=PhotoTrigger(every_s=2.0)), "Mavic 3E", 55.0),
        "fly": Case(hovering(rows), "DJI Fly", 40.0),
    }


def hovering(waypoints: list[Waypoint]) -> ExportedPlan:
    """Return a plan that ends in a hover."""
    return ExportedPlan("", "", tuple(waypoints), at_end=AtEnd.HOVER)


def numbers() -> dict[str, object]:
    """Return DJI's numbers of each aircraft and of each camera that is mounted by hand."""

    def camera(known: CameraNumber | None) -> list[object] | None:
        return None if known is None else [known.enum_value, known.lens]

    aircraft = {
        name: {
            "drone": [each.enum_value, each.sub_enum_value],
            "camera": camera(each.payload),
            "takes_payloads": each.takes_payloads,
            "photos": each.photos,
        }
        for name, each in AIRCRAFT.items()
    }
    return {
        "aircraft": aircraft,
        "payloads": {name: camera(each) for name, each in PAYLOADS.items()},
    }


def main(root: Path) -> None:
    """Writes every case below `root`."""
    folder = root / "wpml"
    folder.mkdir(parents=True, exist_ok=True)
    _write(folder / "aircraft.json", numbers())
    for name, case in missions().items():
        aircraft = None if case.aircraft is None else AIRCRAFT[case.aircraft]
        options = WpmlOptions(CREATED_MS, aircraft, case.go_home_height_m)
        _write(folder / f"{name}.json", case.stated())
        (folder / f"{name}.template.kml").write_bytes(template_kml(case.plan, options) + b"\n")
        (folder / f"{name}.waylines.wpml").write_bytes(waylines_wpml(case.plan, options) + b"\n")


def _write(path: Path, value: dict[str, object]) -> None:
    path.write_text(json.dumps(value, indent=1, sort_keys=True) + "\n", encoding="ascii")


if __name__ == "__main__":
    main(Path(sys.argv[1]) if len(sys.argv) > 1 else Path(__file__).parent)
