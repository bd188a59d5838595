"""What people at a field say to the station while a survey is flown: nothing else is said by them.

They plan it, start it when every vehicle is heard, send those with fresh batteries off again, look
after one that was stopped for a while and start it again, and end it all when the time is over.
"""

from collections.abc import Iterator
from dataclasses import dataclass, replace

from recon.fleet.state import staleness
from recon.model.command import ReturnHome
from recon.model.event import Event, OperatorOrder, SurveyAsked, SurveyStarted, SurveyStopped
from recon.model.survey import Survey, SurveyPhase
from recon.model.units import NS_PER_S, seconds_to_ns
from recon.model.vehicle import FlightMode, Staleness, VehicleState
from recon.station.state import Station
from recon.station.survey.record import Member, SurveyRecord

BY = "the crew"
SURVEY_ID = 1
SETTLED_S = 3.0
"""After the last vehicle was first heard: until battery and satellites are known."""
LOOKED_S = 30.0
"""Until somebody has looked why a vehicle was stopped, or a survey paused by itself."""
FRESH_FRACTION = 0.9


@dataclass(slots=True)
class People:
    """Who stands at the field; `says` is asked once a second."""

    survey: Survey
    serials: tuple[str, ...]
    limit_s: float
    _settled_ns: int | None = None
    _is_begun: bool = False
    _is_ended: bool = False
    _since_ns: dict[str, int] | None = None
    _next_order: int = 100

    def says(self, station: Station, now_ns: int) -> Iterator[Event]:
        """Yield what is said to a station in this state now."""
        record = station.surveys.records.get(SURVEY_ID)
        if record is None:
            if self._all_heard(station, now_ns):
                yield SurveyAsked(replace(self.survey, id=SURVEY_ID), BY)
        elif now_ns >= seconds_to_ns(self.limit_s):
            yield from self._end(station, record, now_ns)
        elif record.state is not None and not self._is_begun:
            self._is_begun = True
            yield SurveyStarted(SURVEY_ID, self.serials, BY, takeoff=True)
        elif record.state is not None and record.state.phase is SurveyPhase.RUNNING:
            yield from self._look_after(station, record, now_ns)
        elif _is_paused(record) and self._lasts("the survey", now_ns):
            yield SurveyStarted(SURVEY_ID, self.serials, BY, takeoff=True)

    def _all_heard(self, station: Station, now_ns: int) -> bool:
        found = [station.fleet.vehicles.get(serial) for serial in self.serials]
        heard = all(v is not None and staleness(v, now_ns) is Staleness.LIVE for v in found)
        self._settled_ns = (self._settled_ns or now_ns) if heard else None
        return self._settled_ns is not None and now_ns - self._settled_ns >= SETTLED_S * NS_PER_S

    def _look_after(
        self, station: Station, record: SurveyRecord, now_ns: int
    ) -> Iterator[SurveyStarted]:
        for member in record.members.values():
            vehicle = station.fleet.vehicles.get(member.serial)
            if vehicle is None or staleness(vehicle, now_ns) is not Staleness.LIVE:
                continue
            if self._is_to_fly_again(member, vehicle, now_ns):
                yield SurveyStarted(SURVEY_ID, (member.serial,), BY, takeoff=True)

    def _is_to_fly_again(self, member: Member, vehicle: VehicleState, now_ns: int) -> bool:
        """Whether somebody sends it off: its battery is fresh, or it was stopped and looked at."""
        is_idle = member.homeward is not None or member.stopped is not None
        is_down = vehicle.is_flying.value is False
        share = vehicle.battery_fraction.value
        is_fit = not is_down or (share is not None and share >= FRESH_FRACTION)
        is_coming_home = member.homeward is not None and not is_down
        if not is_idle or not is_fit or is_coming_home:
            self._forget(member.serial)
            return False
        return self._lasts(member.serial, now_ns)

    def _end(self, station: Station, record: SurveyRecord, now_ns: int) -> Iterator[Event]:
        """When the time is over: abort, and call everyone home; and again, who was held since."""
        if not record.is_over:
            yield SurveyStopped(SURVEY_ID, BY, is_aborted=True)
        elif not self._is_ended or self._lasts("the way home", now_ns):
            self._is_ended = True
            vehicles = (station.fleet.vehicles.get(serial) for serial in self.serials)
            for vehicle in vehicles:
                if vehicle is not None and _hovers(vehicle):
                    self._next_order += 1
                    home = ReturnHome()
                    yield OperatorOrder(self._next_order, home, BY, serial=vehicle.serial)

    def _lasts(self, what: str, now_ns: int) -> bool:
        """Whether something has gone on for as long as people need; it counts anew then."""
        since = self._since_ns = {} if self._since_ns is None else self._since_ns
        began_ns = since.setdefault(what, now_ns)
        if now_ns - began_ns < seconds_to_ns(LOOKED_S):
            return False
        del since[what]
        return True

    def _forget(self, what: str) -> None:
        if self._since_ns is not None:
            self._since_ns.pop(what, None)


def _is_paused(record: SurveyRecord) -> bool:
    return record.state is not None and record.state.phase is SurveyPhase.PAUSED


def _hovers(vehicle: VehicleState) -> bool:
    """Whether a vehicle is in the air and on no way anywhere."""
    is_going = vehicle.flight_mode.value in (FlightMode.GO_HOME, FlightMode.AUTO_LANDING)
    return vehicle.is_flying.value is True and not is_going
