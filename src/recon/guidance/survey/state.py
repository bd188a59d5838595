"""The state of a survey, its figures, and the reasons for its end."""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from types import MappingProxyType

from recon.guidance.survey.closed_areas import ClosedArea
from recon.guidance.survey.lattice import EastNorth
from recon.guidance.survey.plan import SurveyPlan
from recon.guidance.survey.progress import CoverageProgress, missing_cells, not_shown_cells
from recon.guidance.survey.route import Route
from recon.guidance.survey.settings import SurveySettings
from recon.model.arrays import BoolArray
from recon.model.survey import CellState, SurveyPhase, planner_goal
from recon.model.units import HECTARE_M2, ns_to_seconds, seconds_to_ns

Routes = Mapping[str, Route]
NO_ROUTES: Routes = MappingProxyType({})


@dataclass(frozen=True, slots=True)
class Surveyor:
    """One of the survey's vehicles, as the planner needs it now.

    `is_available`: it can take a mission (telemetry live, under guidance, not returning), or
    flies its present one, with or without telemetry. `ended_mission` is the number of its newest
    mission of this survey that has ended, in whatever way. `time_left_s` is its remaining flight
    time without the reserve; None if unknown: then only the gate checks the battery.
    """

    serial: str
    place_m: EastNorth
    is_available: bool = True
    ended_mission: int = 0
    time_left_s: float | None = None
    keeps_battery: bool | None = None
    """Whether its battery could stay in after a landing at home now; None if unknown."""
    home_m: EastNorth | None = None
    """Where it lands; None: at its present place."""
    is_flying: bool = True
    height_above_takeoff_m: float | None = None
    takeoff_up_m: float | None = None
    """The height of its takeoff point, up of the site's frame; a survey above ground needs it."""
    extra_corner_s: float = 0.0
    """Time at each corner beyond a mission's: the station steers it."""


@dataclass(frozen=True, slots=True)
class AssignedMission:
    """A mission given to a vehicle, until it ends."""

    number: int
    route: Route
    corners_m: tuple[EastNorth, ...]
    """Corners to show."""
    length_m: float
    ends_at_ns: int = 0
    """Planned end, for planners that share rows by it."""
    up_m: tuple[float, ...] = ()
    """The height at each corner, up of the site's frame, of a survey above ground."""
    ends_passed: int = 0
    """Passed beginnings and ends of its rows, in order, for planners that replace missions."""
    replaces: "AssignedMission | None" = None
    """The mission that is flown on if this one is refused."""
    is_chosen: bool = False
    """Whether it is for its vehicle alone, not a share of a round: another is chosen if refused."""
    is_beside_closed: bool = False
    """Whether ground was closed when it was given: its rows are what was left beside."""
    is_in_any_light: bool = False
    """Given without known light, and not decided on since."""

    @property
    def rows_left(self) -> Route:
        """The rows whose end it has not reached yet."""
        return self.route[self.ends_passed // 2 :]

    @property
    def rows_taken(self) -> Route:
        """These and the row flown last, whose photos may not have counted yet."""
        return self.route[max(0, self.ends_passed // 2 - 1) :]

    @property
    def unflown_m(self) -> float:
        """Return the rest of its length, as far as its rows show."""
        left_m = sum(leg.piece.length_m for leg in self.rows_left)
        return left_m / sum(leg.piece.length_m for leg in self.route) * self.length_m


@dataclass(frozen=True, slots=True)
class Refused:
    """A mission that the gate refused; from `again_ns` on the next one may be requested."""

    reason: str
    again_ns: int
    rows_most: int | None = None
    """Most rows of the next one, after a mission that would have met another vehicle on its way."""
    waits_for: str = ""
    """Name of the vehicle in its way, if one is."""


@dataclass(frozen=True, slots=True)
class Decision:
    """What a vehicle does and why, for operators; a vehicle that waits is asked again then."""

    text: str
    again_ns: int = 0
    returns: bool = False


@dataclass(frozen=True, slots=True)
class JustFlown:
    """Rows of a mission that has ended, until all photos of them have counted."""

    route: Route
    until_ns: int


COUNTED_S = 2.0
"""Time from settled positions until the survey's next step has counted them."""


def flown_just_now(route: Route, settings: SurveySettings, now_ns: int) -> JustFlown:
    """Return rows that have been flown just now."""
    return JustFlown(route, now_ns + seconds_to_ns(settings.settle_s + COUNTED_S))


@dataclass(frozen=True, slots=True, eq=False)
class SurveyState:
    """One survey's state; mappings are by serial.

    `waiting` is the rest of each vehicle's share of the round. `refusals` are the newest of each
    vehicle. A vehicle refused while no other flew is `barred` until the next start: the cause is
    the vehicle or its rows, unless the refusal may end without a command.
    """

    plan: SurveyPlan
    progress: CoverageProgress
    serials: tuple[str, ...] = ()
    phase: SurveyPhase = SurveyPhase.CREATED
    reason: str = "not started yet"
    """Why it is in this phase or cannot continue, for operators."""
    round: int = 0
    flights: Mapping[str, AssignedMission] = field(default_factory=lambda: MappingProxyType({}))
    waiting: Routes = field(default_factory=lambda: NO_ROUTES)
    refusals: Mapping[str, Refused] = field(default_factory=lambda: MappingProxyType({}))
    barred: frozenset[str] = frozenset()
    decisions: Mapping[str, Decision] = field(default_factory=lambda: MappingProxyType({}))
    """The newest of each vehicle, of planners that explain themselves."""
    just_flown: Mapping[str, JustFlown] = field(default_factory=lambda: MappingProxyType({}))
    closed: tuple[ClosedArea, ...] = ()
    """Where vehicles without telemetry may be, as of the newest step."""
    missions: int = 0
    flown_m: float = 0.0
    """Planned metres of all missions given, and neither refused nor broken off by a pause."""
    started_at_ns: int | None = None
    ended_at_ns: int | None = None
    quiet_since_ns: int = 0
    """Time since which no vehicle flies."""

    def missing(self, wanted: CellState | None = None) -> BoolArray:
        """Return (R, C): the reached cells that are to be imaged yet, up to the `wanted` state, or
        the one that the survey's planner wants."""
        goal = planner_goal(self.plan.survey.planner) if wanted is None else wanted
        return missing_cells(self.progress, self.plan, goal)

    def with_flight(self, serial: str, flight: AssignedMission) -> "SurveyState":
        """Return it with a vehicle on a mission."""
        return replace(self, flights=MappingProxyType({**self.flights, serial: flight}))

    def without_flight(self, serial: str) -> "SurveyState":
        """Return it with a vehicle on no mission."""
        flights = {key: each for key, each in self.flights.items() if key != serial}
        return replace(self, flights=MappingProxyType(flights))

    def with_decision(self, serial: str, decision: Decision) -> "SurveyState":
        """Return it with the newest decision on a vehicle."""
        return replace(self, decisions=MappingProxyType({**self.decisions, serial: decision}))


@dataclass(frozen=True, slots=True)
class CoverageFigures:
    """Areas by counted cells of the region; times from the start, None: not yet."""

    region_m2: float
    reached_m2: float
    """Certain to be on photos of the rows; less than the region where rows had to be cut."""
    not_yet_m2: float
    in_shade_m2: float
    """Area imaged in known light, and not certainly in sun."""
    in_sun_m2: float
    sun_unknown_m2: float
    """Area imaged while no shade map had a value: neither in sun nor in shade."""
    not_shown_m2: float
    """Reached ground that shade maps do not show: it is imaged in unknown light."""
    time_to_95_imaged_s: float | None
    time_to_95_in_sun_s: float | None
    """Time until 95 % of the reached cells are imaged in sun."""


def figures(state: SurveyState) -> CoverageFigures:
    """Return the present figures of a survey."""
    cells, progress, inside = state.plan.cells, state.progress, state.plan.cells.is_inside
    not_in_sun, is_known = progress.state == CellState.IN_SHADE, progress.is_sun_known
    return CoverageFigures(
        region_m2=cells.area_m2(inside),
        reached_m2=cells.area_m2(cells.is_reached),
        not_yet_m2=cells.area_m2(inside & (progress.state == CellState.NOT_YET)),
        in_shade_m2=cells.area_m2(inside & not_in_sun & is_known),
        in_sun_m2=cells.area_m2(inside & (progress.state == CellState.IN_SUN)),
        sun_unknown_m2=cells.area_m2(inside & not_in_sun & ~is_known),
        not_shown_m2=cells.area_m2(not_shown_cells(progress, state.plan)),
        time_to_95_imaged_s=_after_s(state, progress.imaged_95_at_ns),
        time_to_95_in_sun_s=_after_s(state, progress.in_sun_95_at_ns),
    )


def _after_s(state: SurveyState, at_ns: int | None) -> float | None:
    if at_ns is None or state.started_at_ns is None:
        return None
    return ns_to_seconds(at_ns - state.started_at_ns)


def has_settled(state: SurveyState, now_ns: int) -> bool:
    """Return whether the photos of the mission that ended last have counted."""
    return now_ns >= state.quiet_since_ns + seconds_to_ns(state.plan.settings.settle_s)


def spent_budget(state: SurveyState, wanted: CellState, now_ns: int) -> str | None:
    """Return which budget is spent; None while there is budget left."""
    budget = state.plan.survey.budget
    since_s = 0.0 if state.started_at_ns is None else ns_to_seconds(now_ns - state.started_at_ns)
    if budget.time_s is not None and since_s >= budget.time_s:
        return f"Time budget of {budget.time_s:g} s spent; {_missing(state, wanted)}"
    if budget.flown_m is not None and state.flown_m >= budget.flown_m:
        return f"Distance budget of {budget.flown_m:g} m flown; {_missing(state, wanted)}"
    return None


def end_between_rounds(state: SurveyState, wanted: CellState) -> str | None:
    """Return why the survey is done, between two rounds; None: it continues."""
    if is_enough(state, wanted):
        sun = _sun_text(state) if wanted == CellState.IN_SUN else ""
        return f"Complete: all reachable ground photographed{sun}"
    if is_enough(state, CellState.IN_SHADE) and not state.progress.is_sun_known.any():
        return (
            "Complete: all reachable ground photographed, light unknown; without an imaging drone "
            "over the field nothing is flown again for sun"
        )
    rounds = state.plan.survey.budget.rounds
    if state.round < rounds:
        return None
    flown = "The only round" if rounds == 1 else f"All {rounds} rounds"
    return f"{flown} flown; {_missing(state, wanted)}"


def is_enough(state: SurveyState, wanted: CellState) -> bool:
    """Return whether `enough_share` of the reached cells are not missing up to the wanted state."""
    return not _is_much(state, state.missing(wanted))


def _is_much(state: SurveyState, cells: BoolArray) -> bool:
    """Whether these reached cells are more than is left when enough is done."""
    plan = state.plan
    share_most = 1.0 - plan.settings.enough_share
    return float(cells.sum()) > share_most * float(plan.cells.is_reached.sum())


def _sun_text(state: SurveyState) -> str:
    reached, not_shown = state.plan.cells.is_reached, not_shown_cells(state.progress, state.plan)
    if not _is_much(state, not_shown):
        return " in sun"
    return (
        f" in sun where shade maps show it; of {_area_text(state, reached)}, "
        f"{_area_text(state, not_shown)} are not shown by them: photographed, light unknown"
    )


def _missing(state: SurveyState, wanted: CellState) -> str:
    """Return the reached area that is not imaged, and that is imaged without certain sun."""
    progress, reached = state.progress, state.plan.cells.is_reached
    is_imaged = reached & (progress.state == CellState.IN_SHADE)
    is_unknown = is_imaged & ~progress.is_sun_known
    parts = [f"of {_area_text(state, reached)}"]
    if wanted == CellState.IN_SUN:
        parts.append(f"{_area_text(state, is_imaged & ~is_unknown)} imaged in shade only")
    if wanted == CellState.IN_SUN and is_unknown.any():
        parts.append(f"{_area_text(state, is_unknown)} imaged in unknown light")
    not_yet = reached & (progress.state == CellState.NOT_YET)
    return ", ".join((*parts, f"{_area_text(state, not_yet)} not imaged"))


def _area_text(state: SurveyState, cells: BoolArray) -> str:
    return f"{state.plan.cells.area_m2(cells) / HECTARE_M2:.2f} ha"
