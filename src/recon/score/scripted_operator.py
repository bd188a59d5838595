"""The scripted operator of `recon demo` and `recon score`: from what it sees to what it commands.

Theory of operation. `decide` is called about once a second with a `FieldView` and returns actions:

    no survey    plan one when all drones have been ready for SETTLED_S
    planned      start it with all drones, takeoff allowed
    flying       start a drone (again) on the ground with a good battery, or hovers without a task;
                 command return to home where a low-battery alarm is active and it is not returning;
                 dismiss the hazard area of one that has been lost in the air for FOUND_AFTER_S
    finished     nothing; with `repeats`, plan the next survey when all batteries are good again
    past limit_s abort, then call the fleet home, and one by one drones stopped on the way

An operator needs time to notice an alarm or a stopped drone, find out why, and press a button: a
condition has to last for REACTION_S before an action follows, and again before it is repeated.

The class knows neither the station nor its API. `station_operator` adapts it to events in virtual
time (`recon score`), `cli/scripted_operator` to HTTP (`recon demo`).
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from enum import Enum, auto

SETTLED_S = 3.0
"""Time from the last drone's readiness until battery and satellite count have arrived."""
REACTION_S = 20.0
FOUND_AFTER_S = 90.0
"""Time for an assistant to walk to a downed drone: longer than any lost link of a scenario."""


class SurveyStage(Enum):
    """What the operator distinguishes in the life of a survey."""

    PLANNING = auto()
    PLANNED = auto()
    FLYING = auto()
    """Started and not finished; a paused survey counts as flying, all of its drones as stopped."""
    FINISHED = auto()


@dataclass(frozen=True, slots=True)
class DroneView:
    """One vehicle as the operator sees it."""

    serial: str
    is_ready: bool = False
    """Whether its telemetry is live; over the API, also its preflight checklist is passed."""
    is_live: bool = False
    is_flying: bool | None = None
    is_descending: bool = False
    """Whether it returns to home or lands, by its own flight mode."""
    battery_fraction: float | None = None
    is_stopped: bool = False
    """The survey gives it no missions until it is started again."""
    is_called_home: bool = False
    """The survey recalled it; after landing it is started again with a good battery."""
    is_flying_home: bool = False
    """Whether it flies its landing mission now, after a recall."""
    is_in_fleet_return: bool = False
    """Whether it is being returned, or waits for its turn."""
    has_battery_alarm: bool = False
    """The watchdog that compares battery and route home has an active alarm."""
    is_under_pilot: bool = False
    """A pilot holds control authority; the operator takes it back before a start."""

    def stands_with(self, least_share: float) -> bool:
        """Whether it is on the ground with a battery at least this full."""
        share = self.battery_fraction
        return self.is_live and self.is_flying is False and (share or 0.0) >= least_share

    @property
    def is_out(self) -> bool:
        """Whether it is in the air and neither returns nor lands."""
        return self.is_flying is True and not self.is_descending


@dataclass(frozen=True, slots=True)
class FieldView:
    """All vehicles with the imaging drone, and the operator's survey; None before the first."""

    vehicles: Sequence[DroneView]
    stage: SurveyStage | None = None


@dataclass(frozen=True, slots=True)
class RequestPlan:
    """Ask the station to plan the task."""


@dataclass(frozen=True, slots=True)
class StartDrones:
    """Start or resume the survey with these drones, takeoff allowed."""

    serials: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class TakeAuthority:
    """Take control of a drone back from its pilot."""

    serial: str


@dataclass(frozen=True, slots=True)
class CallHome:
    """Command return to home."""

    serial: str


@dataclass(frozen=True, slots=True)
class CallFleetHome:
    """Command a fleet return: returning at once, several meet on the way."""

    serials: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class DismissHazard:
    """Clear the hazard area of a lost vehicle that has been located."""

    serial: str


@dataclass(frozen=True, slots=True)
class AbortSurvey:
    """End the survey for good."""


OperatorAction = (
    RequestPlan
    | StartDrones
    | TakeAuthority
    | CallHome
    | CallFleetHome
    | DismissHazard
    | AbortSurvey
)


@dataclass(slots=True)
class ScriptedOperator:
    """Remembers for how long each condition has lasted, and nothing else of the field."""

    serials: tuple[str, ...]
    """The survey drones."""
    kept_share: float
    """A battery this full is good: it stays in; others are changed."""
    limit_s: float | None = None
    repeats: bool = False
    _is_started: bool = False
    _is_called_home: bool = False
    _since_s: dict[str, float] = field(default_factory=dict)

    def decide(self, view: FieldView, now_s: float) -> Iterator[OperatorAction]:
        """Yield the actions for this moment; `now_s` is seconds since any fixed origin."""
        drones = [each for each in view.vehicles if each.serial in self.serials]
        if view.stage is None:
            yield from self._plan(drones, now_s)
        elif self.limit_s is not None and now_s >= self.limit_s:
            yield from self._end(view.stage, drones, now_s)
        elif view.stage is SurveyStage.PLANNED and not self._is_started:
            self._is_started = True
            yield StartDrones(self.serials)
        elif view.stage in (SurveyStage.PLANNED, SurveyStage.FLYING):
            yield from self._supervise(view, drones, now_s)
        elif view.stage is SurveyStage.FINISHED and self.repeats:
            yield from self._repeat(drones, now_s)

    def _plan(self, drones: Sequence[DroneView], now_s: float) -> Iterator[OperatorAction]:
        are_ready = len(drones) == len(self.serials) and all(each.is_ready for each in drones)
        if self._lasts("ready", are_ready, now_s, SETTLED_S):
            yield RequestPlan()

    def _repeat(self, drones: Sequence[DroneView], now_s: float) -> Iterator[OperatorAction]:
        are_ready = all(each.is_ready and each.stands_with(self.kept_share) for each in drones)
        if self._lasts("next survey", are_ready, now_s):
            self._is_started = False
            yield RequestPlan()

    def _supervise(
        self, view: FieldView, drones: Sequence[DroneView], now_s: float
    ) -> Iterator[OperatorAction]:
        for each in view.vehicles:
            is_at_risk = each.has_battery_alarm and each.is_out and not each.is_flying_home
            if self._lasts(f"{each.serial}: battery", is_at_risk, now_s):
                yield CallHome(each.serial)
            is_lost = not each.is_live and each.is_flying is True
            if self._lasts(f"{each.serial}: lost", is_lost, now_s, FOUND_AFTER_S):
                yield DismissHazard(each.serial)
        for each in drones:
            if self._lasts(f"{each.serial}: no task", self._needs_start(each), now_s):
                if each.is_under_pilot:
                    yield TakeAuthority(each.serial)
                yield StartDrones((each.serial,))

    def _needs_start(self, drone: DroneView) -> bool:
        """Whether a live drone has no task and could fly: it hovers, or is ready on the ground."""
        if not drone.is_live:
            return False
        if drone.is_flying is True:
            return drone.is_stopped and not drone.is_called_home and not drone.is_descending
        is_waiting = drone.is_stopped or drone.is_called_home
        return is_waiting and drone.stands_with(self.kept_share)

    def _end(
        self, stage: SurveyStage, drones: Sequence[DroneView], now_s: float
    ) -> Iterator[OperatorAction]:
        if stage is not SurveyStage.FINISHED:
            yield AbortSurvey()
            return
        if not self._is_called_home:
            self._is_called_home = True
            out = tuple(each.serial for each in drones if each.is_out)
            if out:
                yield CallFleetHome(out)
            return
        stopped = [each.serial for each in drones if each.is_out and not each.is_in_fleet_return]
        if self._lasts("stopped on the way", bool(stopped), now_s):
            yield CallHome(stopped[0])

    def _lasts(self, what: str, holds: bool, now_s: float, for_s: float = REACTION_S) -> bool:
        """Whether a condition has held for `for_s`; the time starts again when it has."""
        if not holds:
            self._since_s.pop(what, None)
            return False
        if now_s - self._since_s.setdefault(what, now_s) < for_s:
            return False
        del self._since_s[what]
        return True
