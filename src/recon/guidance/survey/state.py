"""A survey under way: who flies what, and how far it has come."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from types import MappingProxyType

from recon.guidance.survey.plan import SurveyPlan
from recon.guidance.survey.progress import Progress
from recon.guidance.survey.route import Place, Route
from recon.model.survey import SurveyPhase

Routes = Mapping[str, Route]
NO_ROUTES: Routes = MappingProxyType({})


@dataclass(frozen=True, slots=True)
class Surveyor:
    """What the planner must know of one of the survey's vehicles, now.

    `is_able`: it may be given a mission, or goes on with the one it has (it is heard, led by
    guidance, not on its way home). `ended_mission` is the number of its newest mission of this
    survey that has ended, however it ended. `time_left_s` is how long it can still fly, the reserve
    taken off; None when nobody knows, and then the gate alone says what its battery is good for.
    """

    serial: str
    place_m: Place
    """East-north metres of the site."""
    is_able: bool = True
    ended_mission: int = 0
    time_left_s: float | None = None
    home_m: Place | None = None
    """Where it lands; None: where it is now."""


@dataclass(frozen=True, slots=True)
class Flight:
    """A mission that was given, until it has ended."""

    number: int
    route: Route
    corners_m: tuple[Place, ...]
    """East-north metres of the site, for showing."""
    length_m: float


@dataclass(frozen=True, slots=True)
class Refused:
    """A mission that the gate refused."""

    reason: str
    at_ns: int


@dataclass(frozen=True, slots=True, eq=False)
class SurveyState:
    """One survey's state; by serial where it is a mapping.

    `waiting` holds what is left of each vehicle's share of the round. `refusals` are the newest of
    each vehicle. One refused while nobody else flew is `barred`: it is given nothing until the
    survey is started anew, for the reason lies with itself or with the rows.
    """

    plan: SurveyPlan
    progress: Progress
    serials: tuple[str, ...] = ()
    phase: SurveyPhase = SurveyPhase.CREATED
    reason: str = "not started yet"
    """Why it is in this phase, or what hinders it, in a sentence for people."""
    round: int = 0
    flights: Mapping[str, Flight] = field(default_factory=lambda: MappingProxyType({}))
    waiting: Routes = field(default_factory=lambda: NO_ROUTES)
    refusals: Mapping[str, Refused] = field(default_factory=lambda: MappingProxyType({}))
    barred: frozenset[str] = frozenset()
    missions: int = 0
    flown_m: float = 0.0
    """Planned metres of all missions given and not refused."""
    started_at_ns: int | None = None
    ended_at_ns: int | None = None
    quiet_since_ns: int = 0
    """Since when nobody flies."""
