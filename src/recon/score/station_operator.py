"""The scripted operator in virtual time: its view read from the station, its actions as events."""

from collections.abc import Iterator
from dataclasses import dataclass, replace

from recon.fleet.state import staleness
from recon.guidance.upwind_proposal import SPEED_MPS
from recon.model.command import Body, GoTo, ReturnHome
from recon.model.control import AuthorityHolder
from recon.model.event import (
    AuthorityTaken,
    Event,
    FleetReturnOrdered,
    HazardDismissed,
    OperatorOrder,
    SurveyRequested,
    SurveyStarted,
    SurveyStopped,
)
from recon.model.survey import Survey
from recon.model.units import NS_PER_S
from recon.model.vehicle import FlightMode, Staleness
from recon.score.scripted_operator import (
    AbortSurvey,
    CallFleetHome,
    CallHome,
    DismissHazard,
    DroneView,
    FieldView,
    OperatorAction,
    RequestPlan,
    ScriptedOperator,
    StartDrones,
    SurveyStage,
    TakeAuthority,
)
from recon.station.imaging.upwind import proposed
from recon.station.state.fleet_return_record import ENDED
from recon.station.state.station import Station
from recon.station.state.survey_record import SurveyRecord

BY = "scripted operator"
MOVES_EVERY_S = 60.0
"""Time between two moves of the imaging drone: the wind turns in minutes."""
SURVEY_ID = 1
"""The first survey; repeated ones count on."""
BATTERY_RULE = "battery_home"
DESCENDING = (FlightMode.GO_HOME, FlightMode.AUTO_LANDING, FlightMode.CONFIRM_LANDING)
FIRST_ORDER = 101


@dataclass(slots=True)
class StationOperator:
    """Scripted operator, called once a second with the station's state."""

    survey: Survey
    operator: ScriptedOperator
    moves_upwind: bool = False
    """Whether it has the imaging drone hover where it sees most of the shade to come."""
    _survey_id: int = SURVEY_ID - 1
    """The survey requested last, by which the next one is counted."""
    _moves_due_s: float = 0.0
    _next_order: int = FIRST_ORDER

    def events(self, station: Station, now_ns: int) -> Iterator[Event]:
        """Yield what the operator commands now."""
        if self.moves_upwind and now_ns >= self._moves_due_s * NS_PER_S:
            yield from self._move_upwind(station, now_ns)
        for action in self.operator.decide(
            view_of(station, self._survey_id, now_ns), now_ns / NS_PER_S
        ):
            yield self._event(action)

    def _move_upwind(self, station: Station, now_ns: int) -> Iterator[Event]:
        found = proposed(station, [self.survey.region], None, now_ns)
        if isinstance(found, str) or found.there is found.here:
            return
        self._moves_due_s = now_ns / NS_PER_S + MOVES_EVERY_S
        body = GoTo(found.place, found.height_above_takeoff_m, SPEED_MPS, found.yaw_deg)
        yield self._order(body, found.serial)

    def _order(self, body: Body, serial: str) -> OperatorOrder:
        self._next_order += 1
        return OperatorOrder(self._next_order - 1, body, BY, serial=serial)

    def _event(self, action: OperatorAction) -> Event:
        match action:
            case RequestPlan():
                self._survey_id += 1
                return SurveyRequested(replace(self.survey, id=self._survey_id), BY)
            case StartDrones(serials):
                return SurveyStarted(self._survey_id, serials, BY, takeoff=True)
            case TakeAuthority(serial):
                return AuthorityTaken(serial, AuthorityHolder.OPERATOR, BY)
            case DismissHazard(serial):
                return HazardDismissed(serial, BY)
            case AbortSurvey():
                return SurveyStopped(self._survey_id, BY, is_aborted=True)
            case CallHome(serial):
                return self._order(ReturnHome(), serial)
            case CallFleetHome(serials):
                self._next_order += len(serials)
                return FleetReturnOrdered(self._next_order - len(serials), serials, BY)


def view_of(station: Station, survey_id: int, now_ns: int) -> FieldView:
    """Return what an operator sees of the station: vehicles with a serial, alarms, the survey."""
    record = station.surveys.records.get(survey_id)
    alarms = (each for each in station.alarms.alarms.values() if each.is_active)
    at_risk = {each.condition.serial for each in alarms if each.condition.rule == BATTERY_RULE}
    views = (_drone(station, record, serial, now_ns) for serial in station.fleet.vehicles)
    vehicles = [replace(each, has_battery_alarm=each.serial in at_risk) for each in views]
    return FieldView(vehicles, None if record is None else _stage(record))


def _stage(record: SurveyRecord) -> SurveyStage:
    if record.is_over:
        return SurveyStage.FINISHED
    if record.state is None:
        return SurveyStage.PLANNING
    return SurveyStage.FLYING if record.members else SurveyStage.PLANNED


def _is_in_fleet_return(station: Station, serial: str) -> bool:
    called = station.fleet_return
    member = None if called is None else called.members.get(serial)
    return member is not None and member.stage not in ENDED


def _drone(station: Station, record: SurveyRecord | None, serial: str, now_ns: int) -> DroneView:
    vehicle = station.fleet.vehicles[serial]
    member = None if record is None else record.members.get(serial)
    is_live = staleness(vehicle, now_ns) is Staleness.LIVE
    is_called_home = member is not None and member.return_reason is not None
    mode = vehicle.flight_mode.value
    is_running = record is not None and record.is_running
    return DroneView(
        serial,
        is_ready=is_live,
        is_live=is_live,
        is_flying=vehicle.is_flying.value,
        is_descending=mode in DESCENDING,
        battery_fraction=vehicle.battery_fraction.value,
        is_stopped=not is_running or member is None or member.stop_reason is not None,
        is_called_home=is_called_home,
        is_flying_home=is_called_home and mode is FlightMode.GPS_WAYPOINT,
        is_in_fleet_return=_is_in_fleet_return(station, serial),
        is_under_pilot=station.control(serial).authority.holder is AuthorityHolder.PILOT,
    )
