"""Everything that must be in the audit is there, once, with who asked; nothing of it is a flood."""

import pytest
from tests.fleet.reports import jittered
from tests.link.approved import core, extended
from tests.station.audited import Audited
from tests.station.commanded import AIRSPACE, CLOCK, PROFILES
from tests.station.station_world import from_the_ground, square_mission, world

from recon import wire
from recon.fleet.state import Fleet
from recon.model.command import (
    FlyMission,
    Hover,
    LandNow,
    Phase,
    ReturnHome,
    StickFrame,
    VirtualStick,
)
from recon.model.control import AuthorityHolder
from recon.model.event import (
    AlarmAcknowledged,
    AuditFailed,
    AuthorityTaken,
    HazardDismissed,
    LinkClosed,
    LinkLimitReached,
    LinkOpened,
    OperatorOrder,
    PacketReceived,
    PreflightOverridden,
    SeparationHoldSwitched,
    Tick,
)
from recon.model.units import NS_PER_S
from recon.record.audit.audit import AuditEntry
from recon.sim.fleet import Airborne
from recon.station.audit.entries import Auditing, audit
from recon.station.audit.link_entries import MAX_IN_A_WINDOW
from recon.station.kernel.step import step
from recon.station.state.orders import PhaseChange
from recon.station.state.station import Station
from recon.vehicles.reports import to_report

STICK = VirtualStick(StickFrame.GROUND, 0.0, 1.0, 0.0, 40.0, 1.0)


class Steps:
    """A station stepped by hand, audited."""

    def __init__(self) -> None:
        self.station = Station(fleet=Fleet(profiles=PROFILES), airspace=AIRSPACE, clock=CLOCK)
        self.memory = Auditing()
        self.now_ns = NS_PER_S
        self.entries: list[AuditEntry] = []
        self.heard = 0

    def handle(self, *events: object) -> list[AuditEntry]:
        new: list[AuditEntry] = []
        for event in events:
            before = self.station
            self.station, _ = step(before, event, self.now_ns)  # type: ignore[arg-type]
            self.memory, scene = audit(
                self.memory,
                before,
                event,  # type: ignore[arg-type]
                self.station,
                self.now_ns,
            )
            new += scene
        self.entries += new
        return new

    def hear(self, link_id: int, *packets: bytes) -> list[AuditEntry]:
        reports = [to_report(wire.decode(packet)) for packet in packets]
        self.heard += 1
        return self.handle(*(PacketReceived(link_id, jittered(r, self.heard)) for r in reports))

    def connect(self, link_id: int, serial: bytes = b"A", **telemetry: float) -> list[AuditEntry]:
        opened = self.handle(LinkOpened(link_id, f"10.0.0.{link_id % 250}:5"))
        return opened + self.hear(link_id, core(**telemetry), extended(serial), core(**telemetry))

    def pass_s(self, seconds: float) -> list[AuditEntry]:
        self.now_ns += round(seconds * NS_PER_S)
        return self.handle(Tick())


@pytest.fixture
def steps() -> Steps:
    return Steps()


def kinds(entries: list[AuditEntry]) -> list[str]:
    return [entry.kind for entry in entries]


class TestOrders:
    def test_the_audit_has_every_change_of_every_life(self) -> None:
        """Against the lives themselves: the same changes, in the same order."""
        here = world(2)
        audited = Audited(here)
        here.run_for(2.0)
        given = [
            here.order("SIM-1", FlyMission(square_mission())),
            here.order("SIM-2", Hover()),
            here.order("SIM-2", FlyMission(square_mission(height_m=9_000.0))),
        ]
        here.run_for(10.0)
        given.append(here.order("SIM-1", LandNow()))
        here.run_for(60.0)
        for number in given:
            scene = [
                (entry.kind, entry.details["note"])
                for _, entry in audited.entries
                if entry.kind.startswith("order.") and entry.details["id"] == number
            ]
            lived: tuple[PhaseChange, ...] = here.record(number).history
            assert scene == [(f"order.{c.phase.value}", c.note) for c in lived]
            assert len(scene) >= 1
        assert here.record(given[2]).phase is Phase.REFUSED_BY_STATION

    def test_who_asked_and_what_exactly_is_in_the_first_line(self) -> None:
        here = world(1)
        audited = Audited(here)
        here.run_for(2.0)
        mission = square_mission()
        here.order("SIM-1", FlyMission(mission))
        (entry,) = audited.of("order.queued")
        assert (entry.by, entry.serial, entry.vehicle) == ("test", "SIM-1", "SIM-1")
        assert entry.details["order"] == "mission"
        waypoints = entry.details["body"]["mission"]["waypoints"]
        assert [w["latitude_deg"] for w in waypoints] == [w.latitude_deg for w in mission.waypoints]
        assert entry.details["takeoff"] is False

    def test_a_repeated_stop_is_written_each_time_it_is_sent(self) -> None:
        here = world(1, faults=("ack-then-nothing",), wanders=True)
        audited = Audited(here)
        here.run_for(5.0)
        number = here.order("SIM-1", Hover())
        here.run_for(5.0)
        sent = [e for _, e in audited.entries if "sent again" in str(e.details.get("note"))]
        assert len(sent) == here.record(number).times_sent - 1 == 3


class TestSticks:
    def stick(self, steps: Steps, number: int, by: str = "pad") -> list[AuditEntry]:
        return steps.handle(OperatorOrder(number, STICK, by, serial="A"))

    def test_a_stream_is_its_beginning_and_its_end(self, steps: Steps) -> None:
        steps.connect(1)
        for number in range(1, 101):
            steps.hear(1, core(), extended())
            self.stick(steps, number)
            steps.pass_s(0.1)
        steps.hear(1, core(), extended())
        steps.pass_s(2.5)
        sticks = [e for e in steps.entries if e.kind.startswith("sticks.") and e.by == "pad"]
        assert kinds(sticks) == ["sticks.began", "sticks.ended"]
        assert sticks[0].details["body"]["velocity_x_mps"] == 1.0
        assert sticks[1].details["count"] == 100
        assert sticks[1].details["refused"] == 0
        assert 9.0 < sticks[1].details["seconds"] < 11.0

    def test_a_refused_stream_is_written_once(self, steps: Steps) -> None:
        steps.connect(1, is_flying=0)
        for number in range(1, 51):
            self.stick(steps, number)
            steps.pass_s(0.1)
        steps.pass_s(3.0)
        assert kinds(steps.entries).count("order.refused_by_station") == 1
        (ended,) = [e for e in steps.entries if e.kind == "sticks.ended"]
        assert (ended.details["count"], ended.details["refused"]) == (50, 50)

    def test_two_givers_are_two_streams(self, steps: Steps) -> None:
        steps.connect(1)
        began = self.stick(steps, 1, "one") + self.stick(steps, 2, "two")
        assert [e.by for e in began if e.kind == "sticks.began"] == ["one", "two"]


class TestLinks:
    def test_a_link_opens_reports_its_serial_and_closes(self, steps: Steps) -> None:
        scene = steps.connect(1)
        assert kinds(scene)[:2] == ["link.opened", "link.identified"]
        assert scene[0].details["address"] == "10.0.0.1:5"
        closed = steps.handle(LinkClosed(1, "the app closed the connection"))
        assert kinds(closed) == ["link.closed", "vehicle.position"]
        assert closed[0].serial == "A"
        assert "the app closed the connection" in closed[0].text

    def test_a_conflict_begins_and_ends(self, steps: Steps) -> None:
        steps.connect(1)
        steps.connect(2)
        assert "link.conflict" in kinds(steps.hear(1, core()))
        assert "link.conflict_ended" in kinds(steps.handle(LinkClosed(2, "gone")))

    def test_a_reconnect_is_written_as_the_same_vehicle(self, steps: Steps) -> None:
        steps.connect(1)
        steps.handle(LinkClosed(1, "gone"))
        (identified,) = [e for e in steps.connect(2) if e.kind == "link.identified"]
        assert identified.details["link_id"] == 2

    def test_a_flood_of_connections_is_counted(self, steps: Steps) -> None:
        for number in range(1, 1001):
            steps.handle(LinkOpened(number, "10.0.0.9:5"), LinkClosed(number, "gone"))
        assert len(steps.entries) == MAX_IN_A_WINDOW
        steps.pass_s(61.0)
        (many,) = [e for e in steps.entries if e.kind == "link.many"]
        assert many.details["count"] == 2000 - MAX_IN_A_WINDOW


class TestFlights:
    def test_takeoff_and_landing_are_written_with_their_position(self) -> None:
        here = world(1, airborne=Airborne.NONE)
        audited = Audited(here)
        here.run_for(3.0)
        mission = from_the_ground(here.vehicle("SIM-1"), square_mission())
        here.order("SIM-1", FlyMission(mission), takeoff=True)
        here.run_for(40.0)
        here.order("SIM-1", LandNow())
        here.run_for(60.0)
        flight = [k for k in audited.kinds("vehicle.") if k != "vehicle.position"]
        assert flight == ["vehicle.took_off", "vehicle.home_set", "vehicle.landed"]
        assert audited.of("vehicle.home_set")[0].text.startswith(
            "SIM-1: home set at takeoff: 41.89"
        )
        home = audited.of("vehicle.took_off")[0].details["takeoff_point"]
        true = here.app("SIM-1").settings.home
        assert home["latitude_deg"] == pytest.approx(true.latitude_deg, abs=3e-5)
        assert home["longitude_deg"] == pytest.approx(true.longitude_deg, abs=3e-5)

    def test_a_vehicle_in_the_air_is_written_down_every_five_seconds(self) -> None:
        here = world(1)
        audited = Audited(here)
        here.run_for(60.0)
        assert audited.kinds("vehicle.")[0] == "vehicle.flying"
        assert 11 <= len(audited.of("vehicle.position")) <= 13

    def test_a_vehicle_on_the_ground_every_minute(self) -> None:
        here = world(1, airborne=Airborne.NONE)
        audited = Audited(here)
        here.run_for(170.0)
        assert len(audited.of("vehicle.position")) == 3


class TestAlarms:
    def test_raised_seen_and_ended(self, steps: Steps) -> None:
        steps.connect(1)
        raised = [e for e in steps.pass_s(4.0) if e.kind == "alarm.raised"]
        lost = next(e for e in raised if e.details["rule"] == "link_lost")
        assert lost.details["severity"] == "critical"
        (seen,) = steps.handle(AlarmAcknowledged(lost.details["id"], "Ms Smith"))
        assert (seen.kind, seen.by) == ("alarm.acknowledged", "Ms Smith")
        steps.now_ns += 6 * NS_PER_S
        steps.hear(1, core(), extended())
        ended = [e for e in steps.pass_s(0.05) if e.kind == "alarm.ended"]
        assert lost.details["id"] in [e.details["id"] for e in ended]

    def test_a_flapping_alarm_is_written_every_five_seconds_at_most(self, steps: Steps) -> None:
        steps.connect(1)
        before = len(steps.entries)
        for _ in range(100):
            steps.hear(1, extended(), core())
            steps.pass_s(0.1)
            steps.handle(AuditFailed("full"), Tick(), AuditFailed(None), Tick())
        about_it = [
            e
            for e in steps.entries[before:]
            if e.kind.startswith("alarm.") and e.details["rule"] == "audit"
        ]
        assert 1 <= len(about_it) <= 5

    def test_seeing_an_alarm_that_is_not_there_is_no_entry(self, steps: Steps) -> None:
        assert steps.handle(AlarmAcknowledged(99, "x")) == []


class TestWords:
    def test_who_takes_a_vehicle_over(self, steps: Steps) -> None:
        steps.connect(1)
        (taken,) = steps.handle(AuthorityTaken("A", AuthorityHolder.PILOT, "Ms Smith"))
        assert (taken.kind, taken.by, taken.serial) == ("authority.taken", "Ms Smith", "A")
        assert (taken.details["from"], taken.details["holder"]) == ("operator", "pilot")
        assert steps.handle(AuthorityTaken("A", AuthorityHolder.PILOT, "Ms Smith")) == []

    def test_a_refused_command_is_written_with_the_reason(self, steps: Steps) -> None:
        steps.connect(1)
        scene = steps.handle(
            AuthorityTaken("Z", AuthorityHolder.OPERATOR, "Ms Smith"),
            PreflightOverridden("A", "Ms Smith", ""),
        )
        assert [(e.kind, e.by, e.serial) for e in scene] == [
            ("authority.refused", "Ms Smith", "Z"),
            ("preflight.refused", "Ms Smith", "A"),
        ]
        assert all(e.details["reason"] for e in scene)

    def test_an_override_is_written_with_its_reason(self, steps: Steps) -> None:
        steps.connect(1)
        (scene,) = steps.handle(PreflightOverridden("A", "Ms Smith", "home point was checked"))
        assert (scene.kind, scene.by) == ("preflight.overridden", "Ms Smith")
        assert scene.details["reason"] == "home point was checked"

    def test_operator_commands_are_written_with_their_name(self, steps: Steps) -> None:
        scene = steps.handle(
            HazardDismissed("A", "one"),
            SeparationHoldSwitched(False, "two"),
            AuditFailed("no space"),
            LinkLimitReached("places", "256 apps are connected"),
        )
        words = [e for e in scene if not e.kind.startswith("vehicle.")]
        assert [(e.kind, e.by) for e in words] == [
            ("hazard.dismissed", "one"),
            ("separation_hold.switched", "two"),
            ("audit.trouble", "station"),
            ("link.limit", "station"),
        ]
        assert words[1].details == {"is_on": False}


class TestNothing:
    def test_telemetry_alone_makes_no_entries(self) -> None:
        """A minute of 4 vehicles is 48 positions, not 2,880 packets."""
        here = world(4)
        here.run_for(5.0)
        audited = Audited(here)
        here.run_for(60.0)
        assert set(audited.kinds()) <= {"vehicle.position", "vehicle.flying"}
        assert len(audited.entries) <= 56

    def test_the_same_steps_give_the_same_entries(self) -> None:
        def run() -> list[tuple[int, AuditEntry]]:
            here = world(2, wanders=True, seed=3)
            audited = Audited(here)
            here.run_for(3.0)
            here.order("SIM-1", Hover())
            here.run_for(5.0)
            return audited.entries

        assert run() == run()


def test_a_flight_home_is_on_record_with_what_is_asked_of_it() -> None:
    one = world(1)
    audited = Audited(one)
    one.run_for(2.0)
    one.order("SIM-1", ReturnHome())
    one.run_for(6.0)
    (entry,) = audited.of("vehicle.goes_home")
    assert entry.text == "SIM-1: goes home at 40 m asked, 0 m away"
