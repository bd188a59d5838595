"""A station with events from apps, links and operators, timed in seconds, without sockets."""

from collections.abc import Iterable
from dataclasses import replace

from tests.fleet.reports import PLACE, S, core, extended, jittered
from tests.ready import ready_airspace, ready_profile

from recon.fleet.state import Fleet
from recon.model.command import Body, Phase
from recon.model.event import (
    CommandAnswered,
    CommandDropped,
    CommandSent,
    Event,
    LinkClosed,
    LinkOpened,
    OperatorOrder,
    PacketReceived,
    Tick,
)
from recon.model.failsafe_matrix import FailsafeCell, FailsafeMatrix, Reaction
from recon.model.geo import GeoPoint, LatLon
from recon.model.report import CoreReport, ExtendedReport, Report
from recon.model.vehicle import FlightMode, VelocityNed
from recon.safety import ApprovedCommand, PreparedAirspace
from recon.safety.failsafe import DEFAULT_MATRIX, ROWS
from recon.station.kernel.step import step
from recon.station.kernel.virtual import EPOCH_NS
from recon.station.state.alarm_book import Alarm
from recon.station.state.orders import OrderRecord
from recon.station.state.settings import StationSettings
from recon.station.state.station import Clock, Station
from recon.station.state.steps import SendCommand

HOME = GeoPoint(PLACE.latitude_deg, PLACE.longitude_deg, 260.0)
PROFILES = {serial: ready_profile(serial, HOME, n) for n, serial in enumerate("AB")}
CLOCK = Clock(EPOCH_NS, EPOCH_NS, EPOCH_NS)
AIRSPACE = PreparedAirspace(ready_airspace(HOME))


def _ordering_nothing() -> FailsafeMatrix:
    """The default, with an alarm for each reaction but the watchdogs' holds."""
    alarm = FailsafeCell(Reaction.ALARM)
    return FailsafeMatrix(
        {
            condition: dict.fromkeys(row, alarm) if ROWS[condition].is_timed else row
            for condition, row in DEFAULT_MATRIX.rows.items()
        }
    )


ORDERING_NOTHING = _ordering_nothing()


class CommandedStation:
    """Links carry an order at once, unless `is_stuck`; time goes on in ticks of 0.1 s.

    The failsafe matrix orders nothing unless it is given: a test looks at one mechanism.
    """

    def __init__(self, matrix: FailsafeMatrix = ORDERING_NOTHING) -> None:
        settings = StationSettings(failsafe_matrix=matrix)
        fleet = Fleet(profiles=PROFILES)
        self.station = Station(settings=settings, fleet=fleet, airspace=AIRSPACE, clock=CLOCK)
        self.now_ns = 0
        self.is_stuck = False
        self.sent: list[tuple[float, int, int]] = []
        """When, on which link, which order."""
        self.handed: list[ApprovedCommand] = []
        self.talk: dict[int, tuple[Report, ...]] = {}
        """Reports of each link, every 0.1 s."""
        self._next_order = 1
        self._packets = 0

    def happens(self, event: Event) -> "CommandedStation":
        self.station, outputs = step(self.station, event, self.now_ns)
        for output in outputs:
            if isinstance(output, SendCommand):
                self._carry(output.approved)
        return self

    def _carry(self, approved: ApprovedCommand) -> None:
        self.handed.append(approved)
        for link_id in () if self.is_stuck else approved.link_ids:
            self.sent.append((self.now_ns / S, link_id, approved.command.id))
            self.happens(CommandSent(link_id, approved.command.id))

    def opens(self, link_id: int, *reports: Report) -> "CommandedStation":
        self.happens(LinkOpened(link_id, f"10.0.0.{link_id}:5000"))
        return self.receives(link_id, *reports)

    def closes(self, link_id: int) -> "CommandedStation":
        self.talk.pop(link_id, None)
        return self.happens(LinkClosed(link_id, "gone"))

    def receives(self, link_id: int, *reports: Report) -> "CommandedStation":
        for report in reports:
            self._packets += 1
            self.happens(PacketReceived(link_id, jittered(report, self._packets)))
        return self

    def keeps_receiving(self, link_id: int, *reports: Report) -> "CommandedStation":
        self.talk[link_id] = reports
        return self

    def passes(self, seconds: float) -> "CommandedStation":
        for _ in range(round(seconds * 10)):
            self.now_ns += S // 10
            for link_id, reports in self.talk.items():
                self.receives(link_id, *reports)
            self.happens(Tick())
        return self

    def lands(
        self, link_id: int, *reports: Report, mode: FlightMode = FlightMode.AUTO_LANDING
    ) -> "CommandedStation":
        """The vehicle comes down to where these reports show it, at 10 m/s; then they go on."""
        talk = [report for report in self.talk.get(link_id, ()) if isinstance(report, CoreReport)]
        (down,) = (report for report in reports if isinstance(report, CoreReport))
        up = talk[0] if talk else core()
        altitude_m = (up.reported_altitude_m or 0.0) - (up.height_above_takeoff_m or 0.0)
        down = replace(
            down,
            height_above_takeoff_m=0.0,
            reported_altitude_m=altitude_m,
            velocity_ned=VelocityNed(0.0, 0.0, 0.0),
        )
        (serial,) = {r.serial for r in reports if isinstance(r, ExtendedReport)} or {"A"}
        height_m = up.height_above_takeoff_m or 0.0
        for metre in range(int(height_m)):
            left = 1.0 - (metre + 1) / height_m
            sinking = replace(
                up,
                position=_between(down.position, up.position, left),
                height_above_takeoff_m=height_m * left,
                reported_altitude_m=altitude_m + height_m * left,
                velocity_ned=VelocityNed(0.0, 0.0, 10.0),
            )
            self.keeps_receiving(link_id, sinking, extended(serial, mode=mode)).passes(0.1)
        others = (report for report in reports if not isinstance(report, CoreReport))
        return self.keeps_receiving(link_id, down, *others).passes(1.2)

    def order(
        self,
        body: Body,
        serial: str | None = "A",
        *,
        link: int | None = None,
        takeoff: bool = False,
        person: str = "",
    ) -> int:
        number = self._next_order
        self._next_order += 1
        self.happens(OperatorOrder(number, body, "test", serial, link, takeoff, person=person))
        return number

    def answered(self, order: int, positive: bool | None, link_id: int = 1) -> "CommandedStation":
        return self.happens(CommandAnswered(link_id, order, positive))

    def dropped(self, order: int, phase: Phase, link_id: int = 1) -> "CommandedStation":
        return self.happens(CommandDropped(link_id, order, phase, "dropped"))

    def record(self, order: int) -> OrderRecord:
        return self.station.orders.records[order]

    def phase(self, order: int) -> Phase:
        return self.record(order).phase

    def refusal_rule(self, order: int) -> str | None:
        """The rule that refused an order or its next part."""
        refusal = self.record(order).refusal
        return None if refusal is None else refusal.rule

    def phases(self, order: int) -> list[Phase]:
        return [change.phase for change in self.record(order).history]

    def times_s(self, order: int) -> list[float]:
        return [at_s for at_s, _, number in self.sent if number == order]

    def bodies(self) -> list[Body]:
        """What was handed to the links, in order."""
        return [approved.command.body for approved in self.handed]

    def alarms(self, *, active: bool = True) -> set[str]:
        every: Iterable[Alarm] = self.station.alarms.alarms.values()
        return {alarm.condition.rule for alarm in every if alarm.is_active is active}


def _between(end: LatLon | None, start: LatLon | None, left: float) -> LatLon | None:
    """The place on the way from `start` to `end` with this share left."""
    if end is None or start is None:
        return end
    return LatLon(
        end.latitude_deg + left * (start.latitude_deg - end.latitude_deg),
        end.longitude_deg + left * (start.longitude_deg - end.longitude_deg),
    )


def flying(serial: str = "A") -> CommandedStation:
    """One vehicle on link 1 that flies a mission and goes on doing so whatever is ordered."""
    reports = (core(velocity=(5.0, 0.0, 0.0)), extended(serial, mode=FlightMode.GPS_WAYPOINT))
    return CommandedStation().opens(1, *reports).keeps_receiving(1, *reports).passes(0.5)
