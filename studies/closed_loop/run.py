"""One run: station, apps and all who give orders in virtual time, and the oracles at each step."""

from collections import deque
from dataclasses import replace
from random import Random
from time import process_time

from tests.oracles.flown_air import Breach, breaches
from tests.oracles.flown_orders import (
    PilotGuard,
    ShownAges,
    StopClock,
    TakeoffPermits,
    missing_alarm,
)

from recon import wire
from recon.model.command import FlyMission, Hover, VirtualStick
from recon.model.control import AuthorityHolder
from recon.model.event import (
    AuthorityTaken,
    Event,
    OperatorOrder,
    PacketReceived,
    SeparationHoldSwitched,
    SurveyStarted,
    SurveyStopped,
)
from recon.model.report import CoreReport, ExtendedReport
from recon.model.units import NS_PER_S
from recon.model.vehicle import FlightMode
from recon.sim.flight.flight_modes import Land
from recon.station.kernel.build import first_state
from recon.station.kernel.virtual import VirtualDriver
from recon.station.kernel.worker import JobRunner
from recon.station.recovery.restart import LastRun, restored
from recon.station.recovery.snapshot import decode_snapshot, encode_snapshot, take_snapshot
from recon.station.state.station import Station
from recon.station.state.steps import StepTaken
from studies.closed_loop.links import LinkedApps
from studies.closed_loop.marks import Mark, StationMarks, VehicleMarks
from studies.closed_loop.order_generator import BATTERY_RULES, OrderGenerator
from studies.closed_loop.pilots import Pilot
from studies.closed_loop.scene import Scene, draw
from studies.closed_loop.truth import STEP_S, TrueFleet
from studies.closed_loop.violations import RunResult, ViolationLog

DOWN_S = 3.0
"""From a station's death to the next one's start."""
ARRIVALS_KEPT = 400
"""Packets of 40 s; what is shown for longer is judged by the link's delay now."""
CODE_FAULT, RULE_FAULT = "station_fault", "rule_fault"
"""What the station says of a fault in its own code: an alarm, and a refusal."""


class ClosedLoopRun:
    """One seed, flown."""

    def __init__(self, seed: int, seconds: float = 300.0, *, verbose: bool = False) -> None:
        self.scene: Scene = draw(seed, seconds)
        self.rng = Random(f"{seed}/run")
        self.seconds, self.verbose = seconds, verbose
        self.driver = VirtualDriver(
            first_state(self.scene.site), jobs=JobRunner(self.scene.site), keeps_log=False
        )
        self.driver.observe = self._observe
        self.apps = {app.settings.serial: app for app in self.scene.apps}
        self.marks = {serial: VehicleMarks() for serial in self.apps}
        self.result = RunResult(seed, seconds, vehicles=len(self.apps))
        self.log = ViolationLog(self.result, self.marks, lambda: self.now_s, verbose)
        self.stops, self.permits = StopClock(), TakeoffPermits()
        self.guard, self.ages = PilotGuard(), ShownAges()
        settings, random = self.scene.settings, Random(f"{seed}/links")
        self.links = LinkedApps(
            self.driver,
            random,
            settings.has_bad_links,
            self._packet_arrived,
            self._core_made,
            self._damaged,
        )
        self.fleet = TrueFleet(
            self.scene, self.apps, self.links, self.log, self.stops, self.permits
        )
        random = Random(f"{seed}/parties")
        place, is_flying = self.fleet.place, self.fleet.is_flying
        self.orders = OrderGenerator(self.scene, random, self._handle, place, is_flying)
        self.pilots = self._pilots() if settings.has_pilots else {}
        self._next_link_s = {serial: self.rng.uniform(8.0, 120.0) for serial in self.apps}
        self._arrivals: dict[str, deque[tuple[int, float]]] = {
            serial: deque(maxlen=ARRIVALS_KEPT) for serial in self.apps
        }
        """When core telemetry arrived, and its link's longest delay then."""
        self._takes_off_for: dict[str, int] = {}
        """The survey by which each vehicle was last allowed to take off."""
        self._named_links: set[int] = set()
        """Links on which a serial has arrived: on another no one can know whom it reaches."""
        self._alarm_ids: set[int] = set()
        self._died_s: float | None = None
        self._snapshot = b""

    @property
    def now_s(self) -> float:
        """Virtual time."""
        return self.driver.now_ns / NS_PER_S

    def run(self) -> RunResult:
        """Fly to the end; return what was found."""
        began_s = process_time()
        try:
            self.start()
            while self.now_s < self.seconds:
                self.step()
        except Exception as problem:  # the station's own code must never raise
            self.result.error = f"{type(problem).__name__}: {problem}"
            if self.verbose:
                raise
        self.result.cpu_s = process_time() - began_s
        self.result.stop_latencies_s = self.stops.latencies_s
        return self.result

    def start(self) -> None:
        """Connect the apps."""
        self.links.join(self.scene.apps)

    def step(self) -> None:
        """Let 0.1 s pass, then check everything."""
        self.driver.run_for(STEP_S)
        self.links.step()
        now_s = self.now_s
        self._restart(now_s)
        self._disturb_links(now_s)
        for serial, pilot in self.pilots.items():
            done = pilot.act(now_s)
            if done is not None:
                self._pilot_acted(serial, pilot, done)
        if self._died_s is None:
            self.orders.act(self.driver.station, now_s)
        self.fleet.mark_all(now_s)
        self._check(now_s)

    def _pilots(self) -> dict[str, Pilot]:
        rng = Random(f"{self.scene.seed}/pilots")
        return {
            serial: Pilot(Random(rng.random()), app.aircraft, rng.uniform(10.0, 200.0))
            for serial, app in self.apps.items()
            if rng.random() < 0.5
        }

    def _handle(self, event: Event) -> None:
        """Give an event of a party to the station, and tell the oracles."""
        now_s = self.now_s
        match event:
            case OperatorOrder(serial=serial, body=body, takeoff=takeoff) if serial in self.apps:
                assert serial is not None
                if takeoff:
                    self.permits.allow(serial, now_s)
                if isinstance(body, Hover) and not takeoff:
                    self.stops.ordered(serial, now_s, is_expected=self._expects_stop(serial))
            case AuthorityTaken(serial=serial, holder=holder) if serial in self.apps:
                is_pilots = holder is AuthorityHolder.PILOT
                self.marks[serial].is_given_to_pilot = is_pilots
                if not is_pilots:
                    self.guard.ends(serial)
            case SeparationHoldSwitched(is_on=is_on):
                self.log.station_marks = replace(self.log.station_marks, are_holds_off=not is_on)
            case SurveyStarted(survey_id=number, serials=serials, takeoff=True):
                for serial in serials:
                    self.permits.allow(serial, now_s, float("inf"))
                    self._takes_off_for[serial] = number
            case SurveyStopped(survey_id=number):
                for serial, flown in self._takes_off_for.items():
                    if flown == number:
                        self.permits.withdraw(serial)
        self.driver.handle(event)
        self._note_answer(event)

    def _note_answer(self, event: Event) -> None:
        if not isinstance(event, OperatorOrder):
            self.log.note(
                getattr(event, "serial", "") or "", f"{type(event).__name__} {_said(event)}"
            )
            return
        self.result.orders += 1
        record = self.driver.station.orders.records.get(event.command_id)
        answer = "no record" if record is None else f"{record.phase.value} {record.note}"
        if record is not None and record.refusal is not None and record.refusal.rule == RULE_FAULT:
            self.log.found(Breach("code fault", (), RULE_FAULT, 0.0, record.refusal.reason))
        what = f"order {event.command_id} {_body_text(event)} -> {answer}"
        self.log.note(event.serial or "", what[:260])

    def _expects_stop(self, serial: str) -> bool:
        is_known = self.links.link_of(serial) in self._named_links
        return is_known and self.apps[serial].aircraft.is_flying and self.links.has_downlink(serial)

    def _pilot_acted(self, serial: str, pilot: Pilot, done: str) -> None:
        self.log.note(serial, done)
        if not pilot.is_flying:
            self.guard.ends(serial)
        elif pilot.has_just_taken and pilot.aircraft.has_pilot_control:
            self.guard.takes(serial, self.now_s)

    def _packet_arrived(self, serial: str, packet: wire.Packet, delay_s: float) -> None:
        now_s, marks = self.now_s, self.marks[serial]
        self.result.packets += 1
        moves = isinstance(packet, wire.ExecuteWaypointMission | wire.VirtualStickCommand)
        if isinstance(packet, wire.EmergencyCommand):
            # A hold leaves low what it stops on its way down.
            is_landing = isinstance(self.apps[serial].aircraft.active_mode, Land)
            marks.is_coming_down |= packet.action in (1, 2) or is_landing
            self.log.note(serial, f"received {('hover', 'land', 'return')[packet.action]}")
            if packet.action == 0:
                self.stops.arrived(serial, now_s)
        if moves:
            if marks.is_coming_down:
                marks.landing_ended_s = now_s
            marks.is_coming_down = marks.left_by_pilot = False
            if isinstance(packet, wire.ExecuteWaypointMission):
                self.log.note(serial, f"received a mission of {len(packet.waypoints)}")
            found = self.guard.motion_arrived(serial, now_s, delay_s, type(packet).__name__)
            if found is not None:
                self.log.found(found)

    def _core_made(self, serial: str, place: tuple[float, float]) -> None:
        self.ages.made(serial, self.now_s, place)

    def _damaged(self, serial: str) -> None:
        self.marks[serial].mark(Mark.DAMAGED, self.now_s, "the protocol has no checksum")

    def _observe(self, step: StepTaken) -> None:
        after, event = step.after, step.event
        if not isinstance(event, PacketReceived):
            return
        serial = self.links.serial_of_link.get(event.link_id)
        if serial is None:
            return
        now_s, marks = self.now_s, self.marks[serial]
        if isinstance(event.report, CoreReport):
            self.fleet.core_s[serial] = now_s
            arrival = event.received_at_ns(self.driver.now_ns), self.links.delay_s(serial)
            self._arrivals[serial].append(arrival)
            if marks.known_since_s is None and serial in after.fleet.vehicles:
                marks.known_since_s = now_s
        elif isinstance(event.report, ExtendedReport):
            if event.report.serial is not None:
                self._named_links.add(event.link_id)
            is_pilots = event.report.flight_mode is FlightMode.GPS_SPORT
            if is_pilots and event.report.serial is not None:
                self.guard.reported(serial, now_s)

    def _restart(self, now_s: float) -> None:
        at_s = self.scene.settings.restart_at_s
        if self._died_s is None and at_s is not None and now_s >= at_s:
            self.scene = replace(
                self.scene, settings=replace(self.scene.settings, restart_at_s=None)
            )
            self._died_s = now_s
            old = self.driver.station
            self._snapshot = encode_snapshot(take_snapshot(old, self.driver.now_ns))
            self.links.drop_all()
            self.log.note("", "the station dies")
        elif self._died_s is not None and now_s >= self._died_s + DOWN_S:
            self._died_s = None
            fresh = replace(first_state(self.scene.site), clock=self.driver.station.clock)
            last = LastRun(decode_snapshot(self._snapshot))
            self.driver.station = restored(fresh, last, self.driver.now_ns)
            self.log.station_marks = StationMarks(now_s)
            self._alarm_ids.clear()
            for marks in self.marks.values():
                marks.known_since_s = None
            self.links.return_all()
            self.log.note("", "the station starts again")

    def _disturb_links(self, now_s: float) -> None:
        if not self.scene.settings.has_bad_links or self._died_s is not None:
            return
        for serial, at_s in self._next_link_s.items():
            if now_s >= at_s:
                self._next_link_s[serial] = now_s + self.rng.uniform(20.0, 200.0)
                self.log.note(serial, self.links.disturb(serial))

    def _check(self, now_s: float) -> None:
        station = self.driver.station
        if self._died_s is None:
            self._note_alarms(station)
            self._check_ages(station, now_s)
        for late in list(self.stops.late(now_s)):
            self.log.found(late)
        places = {
            s: self.fleet.true_place(s) for s, app in self.apps.items() if app.aircraft.is_flying
        }
        for breach in breaches(self.scene.truth, places):
            self.log.found(breach)
        self.log.end_old()
        self._check_alarms(station, now_s)

    def _check_ages(self, station: Station, now_s: float) -> None:
        for serial, vehicle in station.fleet.vehicles.items():
            place, core_ns = vehicle.position, vehicle.core_received_at_ns
            if serial not in self.apps or place.value is None or core_ns is None:
                continue
            age_s = place.age_s(self.driver.now_ns)
            if age_s is None or self.marks[serial].known_since_s is None:
                continue
            where = place.value.latitude_deg, place.value.longitude_deg
            delay_s = self._delay_at_arrival_s(serial, place.received_at_ns)
            found = self.ages.shown(serial, now_s, where, age_s, delay_s)
            if found is not None:
                self.log.found(found)

    def _delay_at_arrival_s(self, serial: str, received_at_ns: int | None) -> float:
        """The link's longest delay when a packet arrived; the link may have recovered since."""
        delays_s = (d for at_ns, d in self._arrivals[serial] if at_ns == received_at_ns)
        return max(delays_s, default=self.links.delay_s(serial))

    def _check_alarms(self, station: Station, now_s: float) -> None:
        if self._died_s is not None or now_s - self.log.station_marks.started_s < 12.0:
            return
        waiting = {k: v for k, v in self.log.episodes.items() if k not in self.log.alarmed}
        if not waiting:
            return
        alarms = {
            (a.condition.rule, a.condition.serial, a.condition.key)
            for a in station.alarms.alarms.values()
            if a.is_active
        }
        for key, violation in waiting.items():
            lasted_s = violation.until_s - violation.at_s
            if violation.until_s < now_s - STEP_S / 2.0:
                continue  # it is over, or interrupted
            found = missing_alarm(violation.breach, lasted_s, alarms)
            if found is not None:
                self.log.alarmed.add(key)
                self.log.found(found)

    def _note_alarms(self, station: Station) -> None:
        for number, alarm in station.alarms.alarms.items():
            if number not in self._alarm_ids:
                self._alarm_ids.add(number)
                self.log.note(alarm.condition.serial or "", f"ALARM {alarm.condition.text[:200]}")
                if alarm.condition.rule == CODE_FAULT:
                    self.log.found(
                        Breach("code fault", (), alarm.condition.key, 0.0, alarm.condition.text)
                    )
        battery = {
            a.condition.serial
            for a in station.alarms.alarms.values()
            if a.is_active and a.condition.rule in BATTERY_RULES
        }
        for serial, marks in self.marks.items():
            if serial not in battery:
                marks.battery_alarm_since_s = None
            elif marks.battery_alarm_since_s is None:
                marks.battery_alarm_since_s = self.now_s


def fly(seconds: float, seed: int) -> RunResult:
    """Fly one seed."""
    return ClosedLoopRun(seed, seconds).run()


def _said(event: Event) -> str:
    serials = getattr(event, "serials", None)
    holder = getattr(event, "holder", None)
    return " ".join(str(each) for each in (serials, holder) if each is not None)


def _body_text(order: OperatorOrder) -> str:
    body, more = order.body, " with takeoff" if order.takeoff else ""
    if isinstance(body, FlyMission):
        return f"mission of {len(body.mission.waypoints)}{more}"
    if isinstance(body, VirtualStick):
        return (
            f"stick {body.velocity_x_mps:.1f} {body.velocity_y_mps:.1f} m/s at "
            f"{body.height_above_takeoff_m:.0f} m for {body.timeout_s:.1f} s{more}"
        )
    return f"{type(body).__name__}{more}"
