"""What people at a field say to the station while a survey is flown: nothing else is said by them.

They plan it, start it when every vehicle is heard, send those with fresh batteries off again, look
after one that was stopped and start it again, call home whose battery an alarm is about, and end it
all when the time is over.
"""

from collections.abc import Iterator
from dataclasses import dataclass, field, replace

from recon.fleet.state import staleness
from recon.model.authority import AuthorityHolder
from recon.model.command import ReturnHome
from recon.model.event import (
    AuthorityTaken,
    Event,
    OperatorOrder,
    SurveyAsked,
    SurveyStarted,
    SurveyStopped,
)
from recon.model.survey import Survey
from recon.model.units import NS_PER_S, seconds_to_ns
from recon.model.vehicle import FlightMode, Staleness, VehicleState
from recon.station.state.station import Station
from recon.station.state.survey_record import Member, SurveyRecord

BY = "the crew"
SURVEY_ID = 1
SETTLED_S = 3.0
"""After the last vehicle was first heard: until battery and satellites are known."""
LOOKED_S = 20.0
"""Until somebody has seen an alarm, looked why a vehicle was stopped, and pressed a button."""
WAY_HOME = "battery_home"
"""The watchdog that compares a battery with its way home."""
WAYS_DOWN = (FlightMode.GO_HOME, FlightMode.AUTO_LANDING, FlightMode.CONFIRM_LANDING)
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
    _since_ns: dict[str, int] = field(default_factory=dict)
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
        elif record.state is not None and not record.is_over:
            yield from self._save_batteries(station, record, now_ns)
            for serial in self.serials:
                yield from self._send_off(station, record, serial, now_ns)

    def _all_heard(self, station: Station, now_ns: int) -> bool:
        found = [station.fleet.vehicles.get(serial) for serial in self.serials]
        heard = all(v is not None and staleness(v, now_ns) is Staleness.LIVE for v in found)
        self._settled_ns = (self._settled_ns or now_ns) if heard else None
        return self._settled_ns is not None and now_ns - self._settled_ns >= SETTLED_S * NS_PER_S

    def _save_batteries(
        self, station: Station, record: SurveyRecord, now_ns: int
    ) -> Iterator[OperatorOrder]:
        """Call home whose battery an alarm is about, for as long as it is on no way home."""
        for alarm in station.alarms.alarms.values():
            about = alarm.condition
            vehicle = station.fleet.vehicles.get(about.serial or "")
            if about.rule != WAY_HOME or not alarm.is_active or vehicle is None:
                continue
            is_coming = _is_coming_home(record.members.get(about.serial or ""), vehicle)
            is_out = _hovers_or_flies(vehicle) and not is_coming
            if is_out and self._lasts(f"{about.serial}: battery", now_ns):
                yield self._home(about.serial or "")

    def _send_off(
        self, station: Station, record: SurveyRecord, serial: str, now_ns: int
    ) -> Iterator[Event]:
        """Let one fly for the survey (again), when it has been looked at."""
        member = record.members.get(serial)
        vehicle = station.fleet.vehicles.get(serial)
        if vehicle is None or staleness(vehicle, now_ns) is not Staleness.LIVE:
            return
        if not self._is_to_fly(record, member, vehicle):
            self._since_ns.pop(serial, None)
        elif self._lasts(serial, now_ns):
            if station.control(serial).authority.holder is AuthorityHolder.PILOT:
                yield AuthorityTaken(serial, AuthorityHolder.OPERATOR, BY)
            yield SurveyStarted(SURVEY_ID, (serial,), BY, takeoff=True)

    def _is_to_fly(
        self, record: SurveyRecord, member: Member | None, vehicle: VehicleState
    ) -> bool:
        """Whether it does nothing for the survey, and could: its battery is fresh, or it flies."""
        is_called = member is not None and member.homeward is not None
        is_idle = not record.is_running or member is None or member.stopped is not None
        if vehicle.is_flying.value is True:
            return is_idle and not is_called and vehicle.flight_mode.value not in WAYS_DOWN
        share = vehicle.battery_fraction.value
        is_fresh = share is not None and share >= FRESH_FRACTION
        return (is_idle or is_called) and is_fresh

    def _home(self, serial: str) -> OperatorOrder:
        self._next_order += 1
        return OperatorOrder(self._next_order, ReturnHome(), BY, serial=serial)

    def _end(self, station: Station, record: SurveyRecord, now_ns: int) -> Iterator[Event]:
        """When the time is over: abort, and call everyone home; and again, who was held since."""
        if not record.is_over:
            yield SurveyStopped(SURVEY_ID, BY, is_aborted=True)
        elif not self._is_ended or self._lasts("the way home", now_ns):
            self._is_ended = True
            vehicles = (station.fleet.vehicles.get(serial) for serial in self.serials)
            for vehicle in vehicles:
                if vehicle is not None and _hovers_or_flies(vehicle):
                    yield self._home(vehicle.serial or "")

    def _lasts(self, what: str, now_ns: int) -> bool:
        """Whether something has gone on for as long as people need; it counts anew then."""
        began_ns = self._since_ns.setdefault(what, now_ns)
        if now_ns - began_ns < seconds_to_ns(LOOKED_S):
            return False
        del self._since_ns[what]
        return True


def _hovers_or_flies(vehicle: VehicleState) -> bool:
    """Whether a vehicle is in the air and on no way down."""
    return vehicle.is_flying.value is True and vehicle.flight_mode.value not in WAYS_DOWN


def _is_coming_home(member: Member | None, vehicle: VehicleState) -> bool:
    """Whether a vehicle that its survey called home flies there: it comes by a landing mission."""
    is_called = member is not None and member.homeward is not None
    return is_called and vehicle.flight_mode.value is FlightMode.GPS_WAYPOINT
