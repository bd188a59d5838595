"""An independent, slow model of the fence rules: dense points, with geometry of its own.

Uses nothing of `recon.safety` or `recon.geo`. A path is sampled at most every `STEP_M`; from each
point the distance to every edge is measured, and every return path is followed. The result is a
margin in metres for each rule: positive, kept; negative, broken; nearer to zero than the sampling
resolves, undecided (`is_sure`).
"""

from dataclasses import dataclass, field
from math import atan2, ceil, hypot, tan

import numpy as np
import numpy.typing as npt

FloatArray = npt.NDArray[np.float64]

STEP_M = 4.0
COLUMN_M = 5.0
ZONE_VERTICAL_M = 5.0
BRAKING_MPS2 = 2.5
OVERSHOOT_M = 3.0
HEIGHT_NOISE_M = 1.0


@dataclass(frozen=True, slots=True, eq=False)
class Ring:
    """A polygon: one outline and holes, each (N, 2) east and north."""

    outline_m: FloatArray
    holes_m: tuple[FloatArray, ...] = ()


@dataclass(frozen=True, slots=True, eq=False)
class SampledZone:
    """A zone; heights above ground, or above the frame's origin (`over_ground` False)."""

    ring: Ring
    is_keep_out: bool
    floor_m: float | None
    ceiling_m: float | None
    over_ground: bool


@dataclass(frozen=True, slots=True, eq=False)
class Place:
    """A site's air as the sampling sees it. `ground_m` (rows, cols) in cells of `cell_m`."""

    boundary: Ring
    zones: tuple[SampledZone, ...]
    margin_m: float
    least_height_m: float
    most_height_m: float
    most_distance_m: float
    ground_m: FloatArray
    west_m: float
    north_m: float
    cell_m: float


@dataclass(frozen=True, slots=True, eq=False)
class Aircraft:
    """Where it is, where it goes home to, and how; heights are above the frame's origin."""

    here_m: FloatArray
    home_m: FloatArray
    go_home_m: float
    failsafe: str


@dataclass(slots=True, eq=False)
class Piece:
    """Points (N, 2) that are flown at every height from low to high."""

    kind: str
    points_m: FloatArray
    low_m: float
    high_m: float
    is_entry: bool = False


@dataclass(slots=True)
class Margins:
    """For each rule, by how much it is kept, and how well the sampling knows it."""

    values_m: dict[str, float] = field(default_factory=dict)
    unsure: set[str] = field(default_factory=set)
    slope: float = 0.0

    def is_sure(self, rule: str) -> bool:
        """Whether the margin exceeds what lies between two samples."""
        step_m = STEP_M * (1.0 + self.slope) + 0.1
        return rule not in self.unsure and abs(self.values_m[rule]) > step_m


def margins(place: Place, aircraft: Aircraft, pieces: list[Piece]) -> Margins:
    """Return every rule's margin for a path."""
    found = Margins(slope=_steepest(place))
    found.values_m["boundary"] = min(
        float(_room_m(place.boundary, p.points_m).min()) - place.margin_m
        for p in pieces
        if p.kind != "climb"
    )
    found.values_m["keep_out"] = _zones_margin(place, pieces)
    found.values_m["height_zones"] = _height_zones_margin(place, aircraft, pieces, found)
    found.values_m["min_height"] = _ground_margin(place, aircraft, pieces, found)
    found.values_m["max_height"] = min(
        place.most_height_m - (p.high_m - float(ground_m(place, p.points_m).min()))
        for p in pieces
        if p.kind not in ("climb", "landing")
    )
    found.values_m["home_distance"] = min(
        place.most_distance_m - float(_distances_m(p.points_m, aircraft.home_m[:2]).max())
        for p in pieces
        if p.kind == "flight"
    )
    _doubt_where_it_is(place, aircraft, found)
    return found


def mission_pieces(
    aircraft: Aircraft,
    waypoints_m: FloatArray,
    radii_m: FloatArray,
    *,
    curved: bool,
    land_at_end: bool,
) -> list[Piece]:
    """Return what a mission past (N, 3) waypoints flies."""
    begin = aircraft.here_m.copy()
    begin[2] += np.clip(waypoints_m[0, 2] - begin[2], -HEIGHT_NOISE_M, HEIGHT_NOISE_M)
    stops = np.concatenate([begin[np.newaxis], waypoints_m])
    pieces = [_leg(stops[i], stops[i + 1], is_entry=i == 0) for i in range(len(stops) - 1)]
    if curved:
        pieces += [
            _corner(waypoints_m[i - 1 : i + 2], float(radii_m[i]))
            for i in range(1, len(waypoints_m) - 1)
        ]
    return _with_route_home(aircraft, pieces, waypoints_m[-1] if land_at_end else None)


def goto_pieces(aircraft: Aircraft, target_m: FloatArray) -> list[Piece]:
    """Return what a goto flies: a little beyond its target."""
    begin, end = aircraft.here_m.copy(), target_m.copy()
    begin[2] += np.clip(end[2] - begin[2], -HEIGHT_NOISE_M, HEIGHT_NOISE_M)
    offset = end[:2] - begin[:2]
    end[:2] += OVERSHOOT_M * offset / max(float(np.hypot(*offset)), 1e-9)
    return _with_route_home(aircraft, [_leg(begin, end, is_entry=True)], None)


def stick_pieces(
    aircraft: Aircraft, velocity_mps: FloatArray, up_m: float, timeout_s: float
) -> list[Piece]:
    """Return what a stick over the ground reaches: its time, and its braking."""
    speed_mps = float(np.hypot(*velocity_mps))
    reach_m = speed_mps * timeout_s + speed_mps**2 / (2.0 * BRAKING_MPS2)
    begin = aircraft.here_m.copy()
    begin[2] += np.clip(up_m - begin[2], -HEIGHT_NOISE_M, HEIGHT_NOISE_M)
    end = np.array([*(begin[:2] + reach_m * velocity_mps / speed_mps), up_m])
    return [_leg(begin, end, is_entry=True)]


def _leg(start: FloatArray, end: FloatArray, *, is_entry: bool) -> Piece:
    points = _between(start[:2], end[:2])
    return Piece("flight", points, min(start[2], end[2]), max(start[2], end[2]), is_entry)


def _corner(triple_m: FloatArray, radius_m: float) -> Piece:
    """The triangle that holds the corner, whichever way its radius is read."""
    back, ahead = triple_m[0] - triple_m[1], triple_m[2] - triple_m[1]
    back_m, ahead_m = float(np.linalg.norm(back)), float(np.linalg.norm(ahead))
    cross = float(np.linalg.norm(np.cross(-back, ahead)))
    turn = atan2(cross, float(-back @ ahead))
    stretch = max(1.0, tan(min(turn, 3.1415926) / 2.0))
    start = triple_m[1] + min(radius_m * stretch, back_m) * back / back_m
    end = triple_m[1] + min(radius_m * stretch, ahead_m) * ahead / ahead_m
    heights = (start[2], triple_m[1][2], end[2])
    rim = _between(start[:2], end[:2])
    points = np.concatenate([_between(triple_m[1][:2], point) for point in rim])
    return Piece("flight", points, min(heights), max(heights))


def _with_route_home(
    aircraft: Aircraft, flights: list[Piece], lands_at: FloatArray | None
) -> list[Piece]:
    pieces = list(flights)
    if aircraft.failsafe == "go_home":
        tops = []
        for flight in flights:
            top_m = max(flight.high_m, aircraft.go_home_m)
            tops.append(top_m)
            entry = flight.is_entry
            pieces.append(Piece("climb", flight.points_m, flight.low_m, top_m, entry))
            lines = [_between(point, aircraft.home_m[:2]) for point in flight.points_m]
            low_m = max(flight.low_m, aircraft.go_home_m)
            pieces.append(Piece("route home", np.concatenate(lines), low_m, top_m, entry))
        pieces.append(Piece("landing", aircraft.home_m[np.newaxis, :2], -np.inf, max(tops)))
    elif aircraft.failsafe == "land":
        pieces += [Piece("landing", f.points_m, -np.inf, f.high_m, f.is_entry) for f in flights]
    if lands_at is not None:
        pieces.append(Piece("landing", lands_at[np.newaxis, :2], -np.inf, float(lands_at[2])))
    return pieces


def _zones_margin(place: Place, pieces: list[Piece]) -> float:
    best = 1e9
    for zone in place.zones:
        if zone.is_keep_out:
            for piece in pieces:
                beside_m = -float(_room_m(zone.ring, piece.points_m).max()) - place.margin_m
                above_m = below_m = -np.inf
                if zone.ceiling_m is not None:
                    ground_m = _highest(place, zone, piece)
                    above_m = piece.low_m - ZONE_VERTICAL_M - (zone.ceiling_m + ground_m)
                if zone.floor_m is not None:
                    ground_m = _lowest(place, zone, piece)
                    below_m = zone.floor_m + ground_m - (piece.high_m + ZONE_VERTICAL_M)
                best = min(best, max(beside_m, above_m, below_m))
    return best


def _height_zones_margin(
    place: Place, aircraft: Aircraft, pieces: list[Piece], found: Margins
) -> float:
    best = 1e9
    for zone in place.zones:
        if zone.is_keep_out:
            continue
        for piece in pieces:
            beside_m = -float(_room_m(zone.ring, piece.points_m).max()) - place.margin_m
            if zone.floor_m is not None and not _is_column(aircraft, piece, found, "height_zones"):
                over_m = piece.low_m - (zone.floor_m + _highest(place, zone, piece))
                best = min(best, max(beside_m, over_m))
            if zone.ceiling_m is not None:
                under_m = zone.ceiling_m + _lowest(place, zone, piece) - piece.high_m
                best = min(best, max(beside_m, under_m))
                here_m = aircraft.here_m[np.newaxis, :2]
                if float(_room_m(zone.ring, here_m)[0]) >= -place.margin_m - 0.5:
                    found.unsure.add("height_zones")  # a vehicle inside already may descend
    return best


def _ground_margin(place: Place, aircraft: Aircraft, pieces: list[Piece], found: Margins) -> float:
    best = 1e9
    for piece in pieces:
        if piece.kind in ("climb", "landing"):
            continue
        if _is_column(aircraft, piece, found, "min_height"):
            continue
        over_m = piece.low_m - float(ground_m(place, piece.points_m).max())
        best = min(best, over_m - place.least_height_m)
    return best


def _is_column(aircraft: Aircraft, piece: Piece, found: Margins, rule: str) -> bool:
    """Whether a piece keeps to where the vehicle takes off and lands; nearly so is not known."""
    for centre in (aircraft.home_m, aircraft.here_m):
        reach_m = float(_distances_m(piece.points_m, centre[:2]).max())
        if centre is aircraft.here_m:
            if piece.is_entry and reach_m <= COLUMN_M + STEP_M:
                found.unsure.add(rule)
        elif reach_m <= COLUMN_M - 1.0:
            return True
        elif reach_m <= COLUMN_M + STEP_M:
            found.unsure.add(rule)
    return False


def _doubt_where_it_is(place: Place, aircraft: Aircraft, found: Margins) -> None:
    """Who already breaks a rule may be moved back: the sampling leaves such cases out."""
    here = aircraft.here_m[np.newaxis, :2]
    if float(_room_m(place.boundary, here)[0]) <= place.margin_m + 0.5:
        found.unsure.add("boundary")
    for zone in place.zones:
        if zone.is_keep_out and float(-_room_m(zone.ring, here)[0]) <= place.margin_m + 0.5:
            found.unsure.add("keep_out")
    if aircraft.here_m[2] - float(ground_m(place, here)[0]) >= place.most_height_m - 0.5:
        found.unsure.add("max_height")
    if float(_distances_m(here, aircraft.home_m[:2])[0]) >= place.most_distance_m - 0.5:
        found.unsure.add("home_distance")


def _highest(place: Place, zone: SampledZone, piece: Piece) -> float:
    return float(ground_m(place, piece.points_m).max()) if zone.over_ground else 0.0


def _lowest(place: Place, zone: SampledZone, piece: Piece) -> float:
    return float(ground_m(place, piece.points_m).min()) if zone.over_ground else 0.0


def _between(start: FloatArray, end: FloatArray) -> FloatArray:
    """Points from start to end, at most STEP_M apart, both ends included."""
    count = max(1, ceil(hypot(*(end - start)) / STEP_M))
    share = np.linspace(0.0, 1.0, count + 1)[:, np.newaxis]
    points: FloatArray = start + share * (end - start)
    return points


def _distances_m(points_m: FloatArray, centre_m: FloatArray) -> FloatArray:
    distances: FloatArray = np.hypot(*(points_m - centre_m).T)
    return distances


def _room_m(ring: Ring, points_m: FloatArray) -> FloatArray:
    """How far inside the polygon each point is; negative outside. Crossing numbers, every edge."""
    inside = np.zeros(len(points_m), dtype=bool)
    nearest_m = np.full(len(points_m), np.inf)
    for corners in (ring.outline_m, *ring.holes_m):
        for start, end in zip(corners, np.roll(corners, -1, axis=0), strict=True):
            nearest_m = np.minimum(nearest_m, _to_edge_m(points_m, start, end))
            spans = (start[1] > points_m[:, 1]) != (end[1] > points_m[:, 1])
            rise = end[1] - start[1]
            if rise != 0.0:
                east = start[0] + (points_m[:, 1] - start[1]) / rise * (end[0] - start[0])
                inside ^= spans & (points_m[:, 0] < east)
    return np.where(inside, nearest_m, -nearest_m)


def _to_edge_m(points_m: FloatArray, start: FloatArray, end: FloatArray) -> FloatArray:
    along = end - start
    length2 = max(float(along @ along), 1e-18)
    share = np.clip(((points_m - start) @ along) / length2, 0.0, 1.0)
    return _distances_m(points_m, start + share[:, np.newaxis] * along)


def ground_m(place: Place, points_m: FloatArray) -> FloatArray:
    """The ground's height at each point, bilinear between the middles of cells."""
    rows, cols = place.ground_m.shape
    col = (points_m[:, 0] - place.west_m) / place.cell_m - 0.5
    row = (place.north_m - points_m[:, 1]) / place.cell_m - 0.5
    left = np.clip(np.floor(col).astype(int), 0, cols - 2)
    top = np.clip(np.floor(row).astype(int), 0, rows - 2)
    x, y, ground = col - left, row - top, place.ground_m
    heights: FloatArray = (1 - y) * ((1 - x) * ground[top, left] + x * ground[top, left + 1]) + (
        y * ((1 - x) * ground[top + 1, left] + x * ground[top + 1, left + 1])
    )
    return heights


def _steepest(place: Place) -> float:
    down, right = (np.abs(np.diff(place.ground_m, axis=axis)).max() for axis in (0, 1))
    return float(hypot(down, right)) / place.cell_m
