"""Draws a survey above ground from the side: the ground, the wanted height, and what was flown.

    python -m studies.survey_terrain --out docs/images/survey-terrain.svg

A simulated aircraft flies the first row of a survey 40 m above three grounds, by the whole station
in virtual time; its pad is at the row's western end. Prints how far it was off the wanted height,
and how far a survey 40 m above takeoff would have been.
"""

import argparse
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from tests.guidance.survey.grounds import FloatArray, Ground, hills, model, ridge, slope
from tests.station.returning_world import FRAME
from tests.station.surveyed_world import asked, field, surveyed_world

from recon.guidance.survey.settings import DEFAULT
from recon.guidance.survey.terrain import Terrain
from recon.sim.flight.mission import MissionFlight

HEIGHT_M = 40.0
LENGTH_M, WIDTH_M = 300.0, 40.0
GROUNDS: dict[str, Ground] = {
    "slope of 10 %": slope,
    "ridge of 10 % to both sides": ridge,
    "hills": hills(4, 0.5),
}
LONGEST_S = 200
EASTS, EVERY = 150, 8
"""Places that are drawn: of the ground, and every so many of what was flown."""

PX_PER_M = 2.75
LEFT_PX, TOP_PX, GAP_PX = 46.0, 44.0, 34.0
"""Of the picture: the margin for heights, for the legend, and for a title above each ground."""

STYLE = """
text { font: 13px system-ui, sans-serif; fill: #1d2a20 }
.small { font-size: 11px; fill: #55625a }
.page { fill: #ffffff }
.ground { fill: #d9cdb4; stroke: #8a7a55 }
.band { fill: #3f8f5c; fill-opacity: 0.22 }
.wanted { stroke: #2f7a4b; stroke-dasharray: 5 4 }
.flown { stroke: #14539a; stroke-width: 2 }
.level { stroke: #a33d2c; stroke-dasharray: 1.5 4 }
.waypoint { fill: #14539a }
.grid { stroke: #c9d0c9; stroke-width: 0.6 }
path, line { fill: none; stroke-width: 1.6 }
path.ground, path.band { stroke-width: 1 }
path.ground { fill: #d9cdb4 }
path.band { fill: #3f8f5c; stroke: none }
@media (prefers-color-scheme: dark) {
text { fill: #e6ece6 }
.small { fill: #a3afa6 }
.page { fill: #151c1d }
path.ground { fill: #4a4331; stroke: #b8a778 }
path.band { fill: #6cc48d }
.wanted { stroke: #7fd39c }
.flown { stroke: #7db9ff }
.level { stroke: #ff9a86 }
.waypoint { fill: #7db9ff }
.grid { stroke: #364142 }
}
"""


@dataclass(frozen=True, slots=True)
class Profile:
    """A flown row: (N, 3) true places east, north, up, and the (M, 3) waypoints of its mission."""

    terrain: Terrain
    flown_m: FloatArray
    waypoints_m: FloatArray
    takeoff_up_m: float


def flown_row(ground: Ground) -> Profile:
    """Fly the first row of a survey over a ground."""
    elevation = model(ground, frame=FRAME)
    world = surveyed_world(1, height_m=0.0, pads=((0.0, -30.0),), elevation=elevation)
    region = field(LENGTH_M, WIDTH_M)
    world.asks(
        asked(
            region,
            height_above_takeoff_m=None,
            height_above_ground_m=HEIGHT_M,
            row_bearing_deg=90.0,
        )
    )
    world.starts("SIM-1", takeoff=True)
    places: list[tuple[float, float, float]] = []
    for _ in range(10 * LONGEST_S):
        world.runs(0.1)
        flight = world.state().flights.get("SIM-1")
        mode = world.fleet.world.app("SIM-1").aircraft.active_mode
        if flight is None or not isinstance(mode, MissionFlight):
            continue
        row = _first_row(np.column_stack([np.array(flight.corners_m), np.array(flight.up_m)]))
        begins = next(i for i, p in enumerate(mode.points) if p.gimbal_pitch_deg is not None)
        if mode.next_index > begins + len(row) - 1:
            break
        if mode.next_index > begins:
            places.append(world.fleet.place_m("SIM-1"))
    terrain = world.state().plan.terrain
    assert terrain is not None
    return Profile(terrain, np.array(places), row, world.fleet.pads_up_m["SIM-1"])


def _first_row(corners_m: FloatArray) -> FloatArray:
    """The corners up to the first that lies on another row."""
    is_same = np.abs(corners_m[:, 1] - corners_m[0, 1]) < 1.0
    return corners_m[: len(corners_m) if is_same.all() else int(np.argmin(is_same))]


class Panel:
    """One ground's part of the picture; heights are up of the site."""

    def __init__(self, title: str, profile: Profile, ground: Ground, top_px: float) -> None:
        self._title, self._profile = title, profile
        east_m = np.linspace(profile.flown_m[:, 0].min(), profile.flown_m[:, 0].max(), EASTS)
        places_m = np.column_stack([east_m, np.full(EASTS, profile.waypoints_m[0, 1])])
        self._east_m, self._ground_m = east_m, ground(*places_m.T)
        self._wanted_m = profile.terrain.up_m(places_m)
        self._low_m = 10.0 * np.floor(self._ground_m.min() / 10.0) - 5.0
        self._high_m = max(self._wanted_m.max(), profile.takeoff_up_m + HEIGHT_M) + 8.0
        self._top_px = top_px + GAP_PX

    @property
    def bottom_px(self) -> float:
        return self._top_px + PX_PER_M * (self._high_m - self._low_m)

    def svg(self) -> list[str]:
        """Return the elements of the panel."""
        profile, below_m, above_m = self._profile, DEFAULT.terrain_below_m, DEFAULT.terrain_above_m
        band_m = np.concatenate([self._wanted_m + above_m, (self._wanted_m - below_m)[::-1]])
        around_m = np.concatenate([self._east_m, self._east_m[::-1]])
        ground_m = np.concatenate([self._ground_m, [self._low_m, self._low_m]])
        ground_east_m = np.concatenate([self._east_m, self._east_m[[-1, 0]]])
        level_m = np.full(2, profile.takeoff_up_m + HEIGHT_M)
        dots = [
            f'<circle class="waypoint" cx="{x:.1f}" cy="{y:.1f}" r="4"/>'
            for x, y in self._px(profile.waypoints_m[:, 0], profile.waypoints_m[:, 2])
        ]
        return [
            f'<text x="{LEFT_PX}" y="{self._top_px - 10.0:.1f}">{self._title}</text>',
            *self._grid(),
            self._path("ground", ground_east_m, ground_m, closed=True),
            self._path("band", around_m, band_m, closed=True),
            self._path("level", self._east_m[[0, -1]], level_m),
            self._path("wanted", self._east_m, self._wanted_m),
            self._path("flown", profile.flown_m[::EVERY, 0], profile.flown_m[::EVERY, 2]),
            *dots,
        ]

    def _grid(self) -> list[str]:
        lines = []
        right = self._px(self._east_m[-1:], np.zeros(1))[0][0]
        for up_m in np.arange(20.0 * np.ceil(self._low_m / 20.0), self._high_m, 20.0):
            ((_, y),) = self._px(self._east_m[:1], np.array([up_m]))
            lines.append(f'<line class="grid" x1="{LEFT_PX}" x2="{right:.1f}" y1="{y}" y2="{y}"/>')
            lines.append(
                f'<text class="small" x="{LEFT_PX - 6}" y="{y + 4:.1f}" text-anchor="end">'
                f"{up_m + 0.0:.0f} m</text>"
            )
        return lines

    def _px(self, east_m: FloatArray, up_m: FloatArray) -> list[tuple[float, float]]:
        x = LEFT_PX + PX_PER_M * (east_m - self._east_m[0])
        y = self._top_px + PX_PER_M * (self._high_m - up_m)
        return list(zip(np.round(x, 1).tolist(), np.round(y, 1).tolist(), strict=True))

    def _path(
        self, kind: str, east_m: FloatArray, up_m: FloatArray, *, closed: bool = False
    ) -> str:
        points = " L".join(f"{x} {y}" for x, y in self._px(east_m, up_m))
        return f'<path class="{kind}" d="M{points}{"Z" * closed}"/>'


LEGEND = (
    ("flown", "flown, with its waypoints"),
    ("wanted", "wanted: 40 m above ground"),
    ("band", f"{DEFAULT.terrain_below_m:g} m below to {DEFAULT.terrain_above_m:g} m above it"),
    ("level", "40 m above takeoff"),
)


def legend() -> list[str]:
    """Return the elements of the legend."""
    found, x = list[str](), LEFT_PX
    for kind, words in LEGEND:
        if kind == "band":
            found.append(f'<path class="band" d="M{x} 16 h26 v12 h-26Z"/>')
        else:
            found.append(f'<path class="{kind}" d="M{x} 22 h26"/>')
        if kind == "flown":
            found.append(f'<circle class="waypoint" cx="{x + 13}" cy="22" r="4"/>')
        found.append(f'<text x="{x + 32}" y="26">{words}</text>')
        x += 46.0 + 7.0 * len(words)
    return found


def stated(name: str, profile: Profile) -> str:
    """Return how far a flown row was off, in a sentence."""
    off_m = profile.flown_m[:, 2] - profile.terrain.up_m(profile.flown_m[:, :2])
    level_m = profile.takeoff_up_m + HEIGHT_M - profile.terrain.up_m(profile.flown_m[:, :2])
    stops = len(profile.waypoints_m) - 2
    climbs_m = sum(abs(b - a) for a, b in pairwise(profile.waypoints_m[:, 2].tolist()))
    return (
        f"{name}: {off_m.min():.1f} to {off_m.max():.1f} m off with {stops} waypoints between, "
        f"{climbs_m:.0f} m climbed and sunk; above takeoff {level_m.min():.1f} to "
        f"{level_m.max():.1f} m off"
    )


def main() -> None:
    """Fly all grounds and draw them into one file."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawTextHelpFormatter
    )
    parser.add_argument("--out", default="survey-terrain.svg", help="where the picture goes")
    out = parser.parse_args().out
    elements, top_px = legend(), TOP_PX
    for name, ground in GROUNDS.items():
        profile = flown_row(ground)
        print(stated(name, profile))
        panel = Panel(name, profile, ground, top_px)
        elements += panel.svg()
        top_px = panel.bottom_px
    width, height = LEFT_PX + PX_PER_M * LENGTH_M + 24.0, top_px + 12.0
    head = (
        f'<svg xmlns="http://www.w3.org/2000/svg" width="{width:.0f}" height="{height:.0f}" '
        f'viewBox="0 0 {width:.0f} {height:.0f}" role="img" aria-label="Rows over a slope, a '
        f'ridge and hills, from the side">'
    )
    page = '<rect class="page" width="100%" height="100%"/>'
    with open(out, "w", encoding="utf-8") as file:
        file.write("\n".join([head, f"<style>{STYLE}</style>", page, *elements, "</svg>\n"]))


if __name__ == "__main__":
    main()
