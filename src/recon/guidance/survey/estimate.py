"""What a survey will take before it is started: flights, time, photos and batteries of each drone.

It shares rows and fills batteries by the functions with which the planners do (`rounds.py`): each
row once, as under a clear sky. Ground flown again for sun comes on top.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from math import ceil, dist, floor

from recon.geo import shape_of
from recon.guidance.survey.imaging import SpeedLimit, blur_px
from recon.guidance.survey.lattice import EastNorth
from recon.guidance.survey.missions import Track, flight_time_s
from recon.guidance.survey.plan import RULE, SurveyPlan
from recon.guidance.survey.progress import first_pieces
from recon.guidance.survey.rounds import longest_mission, shares
from recon.guidance.survey.route import Route
from recon.guidance.survey.state import Surveyor
from recon.guidance.survey.terrain import LEAST_CLIMB_M
from recon.model.command import Refusal
from recon.model.units import HECTARE_M2

SWAP_S = 180.0
"""Time from touchdown to takeoff with a fresh battery, by a person at the pad."""

MOST_FLIGHTS = 500
"""Most flights of all drones; more come from a wrong endurance."""


@dataclass(frozen=True, slots=True)
class Batteries:
    """What a fresh battery gives. `level_s`: level flight that leaves reserve and landing; None:
    unknown, then one is taken to last for a drone's share."""

    level_s: float | None = None
    swap_s: float = SWAP_S
    landing_s: float = 0.0
    """Time from above the pad to the ground."""


@dataclass(frozen=True, slots=True)
class PlannedFlight:
    """One flight on one battery, from takeoff to landing; usually one mission."""

    route: Route
    tracks_m: tuple[tuple[EastNorth, ...], ...]
    """The corners of each mission."""
    rows_m: float
    """Length of its rows, lead-in included."""
    missions_s: float
    """Time from the takeoff point to the end of the last row."""
    time_s: float
    photos: int
    """Photos on its rows."""


@dataclass(frozen=True, slots=True)
class DroneEstimate:
    """One drone's flights in their order; `time_s` from the start to its last landing."""

    serial: str
    flights: tuple[PlannedFlight, ...]
    time_s: float

    @property
    def flown_s(self) -> float:
        """Return the time in the air."""
        return sum(flight.time_s for flight in self.flights)


@dataclass(frozen=True, slots=True)
class SurveyEstimate:
    """The figures of all drones together; a drone without a share is not among them."""

    drones: tuple[DroneEstimate, ...]
    timer_s: float
    knows_batteries: bool

    @property
    def time_s(self) -> float:
        """Return the time from the start to the last landing."""
        return max(drone.time_s for drone in self.drones)

    @property
    def flown_s(self) -> float:
        """Return the total time in the air of all drones."""
        return sum(drone.flown_s for drone in self.drones)

    @property
    def photos(self) -> int:
        """Return the photos on the rows."""
        return sum(flight.photos for drone in self.drones for flight in drone.flights)

    @property
    def photos_in_all(self) -> int:
        """Return the photos that a timer takes from takeoff to landing: what a card must hold."""
        return sum(
            ceil(flight.time_s / self.timer_s) for drone in self.drones for flight in drone.flights
        )

    @property
    def batteries(self) -> int | None:
        """Full ones, one a flight; None: it is not known how long one lasts."""
        flights = sum(len(drone.flights) for drone in self.drones)
        return flights if self.knows_batteries else None


def estimate(
    plan: SurveyPlan, surveyors: Sequence[Surveyor], batteries: Batteries
) -> SurveyEstimate | Refusal:
    """Return what a survey takes with these vehicles, at least one; takes tens of milliseconds.

    Each begins with the battery that is in it, a full one where that is unknown. A refusal names
    the row that no battery lasts for.
    """
    given = shares(plan, first_pieces(plan), surveyors)
    drones: list[DroneEstimate] = []
    for surveyor in surveyors:
        if surveyor.serial not in given:
            continue
        found = _flights(plan, given[surveyor.serial], surveyor, batteries)
        if isinstance(found, Refusal):
            return found
        flights, swaps = found
        time_s = sum(flight.time_s for flight in flights) + swaps * batteries.swap_s
        drones.append(DroneEstimate(surveyor.serial, flights, time_s))
    interval_s = plan.survey.camera.interval_s
    return SurveyEstimate(tuple(drones), interval_s, batteries.level_s is not None)


def corner_of(plan: SurveyPlan) -> EastNorth:
    """Return the region's south-west corner: where drones take off whose place is not known."""
    west_m, south_m = plan.survey.region.outline_m.min(axis=0).tolist()
    return west_m, south_m


@dataclass(frozen=True, slots=True)
class PlanFigures:
    """What operators see of a plan; times, photos and batteries are None without an estimate."""

    region_m2: float
    reached_m2: float
    """Area that the rows image with certainty."""
    least_height_above_ground_m: float | None
    most_height_above_ground_m: float | None
    """Largest height of rows over the region, for any of the drones; None: ground unknown."""
    rows: int
    gsd_m: float | None
    blur_px: float
    speed_limit_mps: float
    speed_limited_by: str
    time_s: float | None
    flown_s: float | None
    photos: int | None
    photos_in_all: int | None
    batteries: int | None
    rows_note: str
    """Whose rows these are, or why they are new; may be empty."""
    warnings: list[str]


def plan_figures(
    plan: SurveyPlan,
    surveyors: Sequence[Surveyor],
    needs: SurveyEstimate | None,
    limit: SpeedLimit,
    exposure_s: float,
) -> PlanFigures:
    """Return the figures of a plan. `limit`: the lowest of its speed limits."""
    takeoffs_m = [each.takeoff_up_m for each in surveyors if each.takeoff_up_m is not None]
    above_m = [range_m for up_m in takeoffs_m if (range_m := plan.above_ground_m(up_m))]
    survey, cells = plan.survey, plan.cells
    height_m, region_m2 = survey.height_m, shape_of(survey.region).area
    return PlanFigures(
        region_m2=region_m2,
        reached_m2=min(cells.area_m2(cells.is_reached), region_m2),
        least_height_above_ground_m=min((low for low, _ in above_m), default=None),
        most_height_above_ground_m=max((high for _, high in above_m), default=None),
        rows=plan.row_count,
        rows_note=survey.rows_note,
        gsd_m=survey.camera.gsd_m(height_m),
        blur_px=blur_px(survey.camera, height_m, survey.speed_mps, exposure_s),
        speed_limit_mps=limit.speed_mps,
        speed_limited_by=limit.reason,
        time_s=None if needs is None else needs.time_s,
        flown_s=None if needs is None else needs.flown_s,
        photos=None if needs is None else needs.photos,
        photos_in_all=None if needs is None else needs.photos_in_all,
        batteries=None if needs is None else needs.batteries,
        warnings=_warnings(plan, limit),
    )


MOST_SKIPPED = 0.005
"""Share of the region that rows may miss without a warning: cells at an edge."""


def _warnings(plan: SurveyPlan, limit: SpeedLimit) -> list[str]:
    """Return sentences: a speed above its lowest limit, a height near the site's limits, ground
    that is not reached."""
    found: list[str] = []
    speed_mps, cells = plan.survey.speed_mps, plan.cells
    if speed_mps > limit.speed_mps * (1.0 + 1e-9):
        allowed_mps = floor(100.0 * limit.speed_mps) / 100.0
        found.append(f"{speed_mps:g} m/s is more than {allowed_mps:g} m/s: {limit.reason}")
    if plan.terrain is not None and plan.terrain.is_near_height_limits:
        found.append(
            f"{plan.survey.height_m:g} m above ground leaves rows over this ground less than "
            f"{LEAST_CLIMB_M:g} m to climb or sink within the site's height limits: the gate may "
            "refuse them; choose a height farther from the limits"
        )
    inside = int(cells.is_inside.sum())
    skipped = inside - int(cells.is_reached.sum())
    if skipped > MOST_SKIPPED * inside:
        ha = cells.cell_m2 / HECTARE_M2
        found.append(
            f"{skipped * ha:.2f} ha of {inside * ha:.2f} ha cannot be reached inside the site's "
            "boundary and off its keep-out zones: move the region or the zones"
        )
    return found


def _flights(
    plan: SurveyPlan, route: Route, surveyor: Surveyor, batteries: Batteries
) -> tuple[tuple[PlannedFlight, ...], int] | Refusal:
    """Fly a share battery by battery, the first may be too empty for any row; also return how often
    the battery is changed."""
    home_m = surveyor.home_m or surveyor.place_m
    fresh = replace(surveyor, place_m=home_m, time_left_s=batteries.level_s)
    flights: list[PlannedFlight] = []
    vehicle, swaps = surveyor, 0
    if surveyor.time_left_s is None:
        vehicle = replace(surveyor, time_left_s=batteries.level_s)
    while route:
        flight, rest = _flight(plan, route, vehicle, batteries)
        if flight is None and vehicle == fresh:
            return Refusal(RULE, _too_far(plan, route[:1], fresh))
        if flight is not None:
            flights.append(flight)
        if len(flights) > MOST_FLIGHTS:
            return Refusal(RULE, f"the survey takes more than {MOST_FLIGHTS} flights of a drone")
        vehicle, route = fresh, rest
        swaps += bool(route)
    return tuple(flights), swaps


def _flight(
    plan: SurveyPlan, route: Route, vehicle: Surveyor, batteries: Batteries
) -> tuple[PlannedFlight | None, Route]:
    """Fly missions until the battery lasts for no further row; also return the rest.

    As in flight: a mission is planned with a share of what is left, and what it did not use gives
    another one. It also ends where no path leads on to the next row.
    """
    vehicle = replace(vehicle, home_m=vehicle.home_m or vehicle.place_m)
    tracks: list[Track] = []
    flown, missions_s = 0, 0.0
    while flown < len(route):
        track, count = longest_mission(plan, route[flown:], vehicle)
        if track is None:
            break
        used_s = _mission_s(plan, track, vehicle)
        vehicle = _after_mission(vehicle, track, used_s)
        missions_s += used_s
        tracks.append(track)
        flown += count
    if not tracks:
        return None, route
    return _planned(plan, route[:flown], tracks, missions_s, vehicle, batteries), route[flown:]


def _mission_s(plan: SurveyPlan, track: Track, vehicle: Surveyor) -> float:
    """How long a mission takes with the leg to it, stops at corners included."""
    settings, speed_mps = plan.settings, plan.survey.speed_mps
    end_m = track.corners_m[-1]
    used_s = flight_time_s(track, speed_mps, vehicle.place_m, end_m, settings)
    return used_s + (settings.corner_s + vehicle.extra_corner_s) * len(track.corners_m)


def _after_mission(vehicle: Surveyor, track: Track, used_s: float) -> Surveyor:
    left_s = vehicle.time_left_s
    if left_s is not None:
        left_s = max(0.0, left_s - used_s)
    return replace(vehicle, place_m=track.corners_m[-1], time_left_s=left_s)


def _planned(
    plan: SurveyPlan,
    legs: Route,
    tracks: Sequence[Track],
    missions_s: float,
    landed: Surveyor,
    batteries: Batteries,
) -> PlannedFlight:
    """The flight of these missions, with takeoff, return and landing."""
    settings, home_m = plan.settings, landed.home_m or landed.place_m
    first_m = plan.height_above_takeoff_m(tracks[0].corners_m[0], landed.takeoff_up_m)
    climb_m = plan.survey.height_m if first_m is None else max(first_m, 0.0)
    up_s = settings.takeoff_s + climb_m / settings.climb_mps
    return_s = dist(tracks[-1].corners_m[-1], home_m) / plan.survey.speed_mps
    return PlannedFlight(
        legs,
        tuple(track.corners_m for track in tracks),
        sum(leg.piece.length_m + 2.0 * plan.swath.lead_m for leg in legs),
        missions_s,
        up_s + missions_s + return_s + batteries.landing_s,
        sum(_photos(plan, leg.piece.length_m) for leg in legs),
    )


def _photos(plan: SurveyPlan, row_m: float) -> int:
    """The most that the timer takes along a row with its lead, whatever its phase."""
    return floor((row_m + 2.0 * plan.swath.lead_m) / plan.swath.photo_m) + 1


def _too_far(plan: SurveyPlan, first: Route, vehicle: Surveyor) -> str:
    track, _ = longest_mission(plan, first, replace(vehicle, time_left_s=None))
    home_m = vehicle.home_m or vehicle.place_m
    assert track is not None  # one row has no path between rows
    speed_mps, settings = plan.survey.speed_mps, plan.settings
    needs_s = flight_time_s(track, speed_mps, vehicle.place_m, home_m, settings)
    has_s = (vehicle.time_left_s or 0.0) * settings.flight_time_share
    return (
        f"a full battery gives {floor(has_s)} s for rows, and row {first[0].piece.row + 1}, "
        f"with the flights there and back, takes {ceil(needs_s)} s: "
        "take off nearer to it, divide the region, or turn the rows"
    )
