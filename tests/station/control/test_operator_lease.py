"""One person operates a vehicle at a time; taking over is explicit and seen by both."""

import pytest
from tests.fleet.reports import core, extended
from tests.safety.cases import STICK, mission
from tests.station.commanded import CommandedStation
from tests.station.recovery.restarts import restored_from, saved
from tests.station.steered_world import HEIGHT_M, OWNER, SERIAL, Steered, steered
from tests.station.surveyed_world import SURVEY_ID, surveyed_world

from recon.model.command import (
    Body,
    GoTo,
    Hover,
    LandNow,
    Phase,
    ReturnHome,
    StickFrame,
    VirtualStick,
)
from recon.model.control import AuthorityHolder
from recon.model.event import (
    AuthorityTaken,
    Event,
    FleetReturnOrdered,
    OwnerConnected,
    PersonConnected,
    PersonDisconnected,
    SurveyStarted,
    SurveyStopped,
)
from recon.model.survey import SurveyPhase
from recon.model.vehicle import FlightMode
from recon.record.audit.audit import AuditEntry
from recon.station.audit.entries import Auditing, audit
from recon.station.control import handover, operator_lease
from recon.station.state.station import Station

HOVERING = (core(), extended(mode=FlightMode.GPS_ATTI))
OPERATOR, PILOT, GUIDANCE = (
    AuthorityHolder.OPERATOR,
    AuthorityHolder.PILOT,
    AuthorityHolder.GUIDANCE,
)


def takes(
    person: str, holder: AuthorityHolder = OPERATOR, *, over: bool = False, serial: str = "A"
) -> AuthorityTaken:
    return AuthorityTaken(serial, holder, f"{person} (10.0.0.2)", person, over)


def operator_of(station: Station, serial: str = "A") -> str | None:
    lease = station.control(serial).lease
    return None if lease is None else lease.person


@pytest.fixture
def scene() -> CommandedStation:
    """One vehicle that hovers; anna has a stream of states, bob too."""
    made = CommandedStation().opens(1, *HOVERING).keeps_receiving(1, *HOVERING).passes(0.5)
    return made.happens(PersonConnected("anna")).happens(PersonConnected("bob"))


def operated(scene: CommandedStation) -> CommandedStation:
    """Anna operates the vehicle, by an order to move it."""
    assert scene.phase(scene.order(mission(), person="anna")) is Phase.SENT
    assert operator_of(scene.station) == "anna"
    return scene


class TestTakingIt:
    def test_the_first_order_to_move_takes_it(self, scene: CommandedStation) -> None:
        assert operator_of(scene.station) is None
        operated(scene)

    def test_a_refused_order_does_not(self, scene: CommandedStation) -> None:
        scene.happens(takes("anna", PILOT))
        assert scene.refusal_rule(scene.order(mission(), person="bob")) == "authority"
        assert operator_of(scene.station) is None

    @pytest.mark.parametrize("body", [Hover(), LandNow(), ReturnHome()])
    def test_a_stop_does_not(self, scene: CommandedStation, body: Body) -> None:
        scene.order(body, person="bob")
        assert operator_of(scene.station) is None

    def test_orders_of_the_station_do_not(self, scene: CommandedStation) -> None:
        scene.order(mission())
        assert operator_of(scene.station) is None

    def test_taking_control_does(self, scene: CommandedStation) -> None:
        assert operator_of(scene.happens(takes("bob")).station) == "bob"

    def test_one_person_alone_is_never_refused(self, scene: CommandedStation) -> None:
        for body in (mission(), STICK, mission()):
            assert scene.phase(scene.order(body, person="anna")) is Phase.SENT


class TestAnotherPerson:
    def test_is_refused_what_moves_it_and_told_who_operates(self, scene: CommandedStation) -> None:
        order = operated(scene).order(mission(), person="bob")
        assert scene.refusal_rule(order) == "operator_lease"
        assert "operated by anna" in scene.record(order).note
        assert operator_of(scene.station) == "anna"

    @pytest.mark.parametrize("body", [Hover(), LandNow(), ReturnHome()])
    def test_may_stop_it_and_the_lease_stays(self, scene: CommandedStation, body: Body) -> None:
        order = operated(scene).order(body, person="bob")
        assert scene.phase(order) is Phase.SENT
        assert operator_of(scene.station) == "anna"

    def test_cannot_take_control_by_the_way(self, scene: CommandedStation) -> None:
        operated(scene)
        for holder in (OPERATOR, GUIDANCE):
            refused = handover.refusal(scene.station, takes("bob", holder), scene.now_ns)
            assert refused is not None
            assert refused.rule == "operator_lease"
            assert operator_of(scene.happens(takes("bob", holder)).station) == "anna"

    def test_cannot_call_it_home_in_layers(self, scene: CommandedStation) -> None:
        operated(scene).happens(FleetReturnOrdered(80, ("A",), "bob", None, "bob"))
        assert scene.refusal_rule(80) == "operator_lease"

    def test_may_give_it_to_its_pilot_which_ends_the_lease_with_an_alarm(
        self, scene: CommandedStation
    ) -> None:
        operated(scene).happens(takes("bob", PILOT)).passes(0.1)
        assert scene.station.control("A").authority.holder is PILOT
        assert operator_of(scene.station) is None
        assert "lease_ended" in scene.alarms(active=False)


class TestTakingOver:
    def test_is_explicit_and_both_see_it(self, scene: CommandedStation) -> None:
        operated(scene).happens(takes("bob", over=True)).passes(0.1)
        assert operator_of(scene.station) == "bob"
        (alarm,) = (
            a for a in scene.station.alarms.alarms.values() if a.condition.rule == "lease_ended"
        )
        assert alarm.condition.text == "A: taken over by bob from anna"
        assert alarm.acknowledged_by is None
        assert scene.refusal_rule(scene.order(mission(), person="anna")) == "operator_lease"
        assert scene.phase(scene.order(mission(), person="bob")) is Phase.SENT

    def test_what_waited_unsent_is_withdrawn(self, scene: CommandedStation) -> None:
        scene.is_stuck = True
        order = scene.order(mission(), person="anna")
        scene.happens(takes("bob", over=True))
        assert scene.phase(order) is Phase.SUPERSEDED
        assert "taken over by bob" in scene.record(order).note

    def test_of_a_free_vehicle_raises_no_alarm(self, scene: CommandedStation) -> None:
        scene.happens(takes("bob", over=True)).passes(0.1)
        assert operator_of(scene.station) == "bob"
        assert "lease_ended" not in scene.alarms(active=False)


class TestItsEnd:
    def test_released_to_its_pilot(self, scene: CommandedStation) -> None:
        operated(scene).happens(takes("anna", PILOT)).passes(0.1)
        assert operator_of(scene.station) is None
        assert "lease_ended" not in scene.alarms(active=False)

    def test_its_person_is_gone_for_a_minute(self, scene: CommandedStation) -> None:
        operated(scene).passes(5.0).happens(PersonDisconnected("anna")).passes(59.0)
        assert operator_of(scene.station) == "anna"
        assert operator_of(scene.passes(2.0).station) is None
        assert scene.phase(scene.order(mission(), person="bob")) is Phase.SENT

    def test_one_of_two_streams_is_enough(self, scene: CommandedStation) -> None:
        operated(scene).happens(PersonConnected("anna")).happens(PersonDisconnected("anna"))
        assert operator_of(scene.passes(100.0).station) == "anna"

    def test_a_person_who_returns_in_time_keeps_it(self, scene: CommandedStation) -> None:
        operated(scene).happens(PersonDisconnected("anna")).passes(50.0)
        assert operator_of(scene.happens(PersonConnected("anna")).passes(100.0).station) == "anna"

    def test_without_any_stream_it_lasts_a_minute_from_the_last_order(
        self, scene: CommandedStation
    ) -> None:
        scene.order(STICK, person="carl")
        scene.passes(40.0).order(STICK, person="carl")
        assert operator_of(scene.passes(40.0).station) == "carl"
        assert operator_of(scene.passes(21.0).station) is None

    def test_a_restart_leaves_it_free(self, scene: CommandedStation) -> None:
        snapshot = saved(operated(scene).station, scene.now_ns)
        assert operator_of(restored_from(snapshot, scene.now_ns)) is None


class TestSteering:
    def steered_by_anna(self) -> tuple[Steered, int]:
        s = steered()
        for event in (PersonConnected("anna"), OwnerConnected(OWNER)):
            s.w.driver.handle(event)
        order = s.order(GoTo(s.there(200.0), 40.0, 8.0), OWNER, "anna")
        s.run_for(6.0)
        assert operator_of(s.w.driver.station, SERIAL) == "anna"
        return s, order

    def test_a_takeover_ends_it_with_a_neutral_setpoint_and_a_hold(self) -> None:
        s, order = self.steered_by_anna()
        s.w.driver.handle(takes("bob", over=True, serial=SERIAL))
        taken_s = s.now_s
        s.run_for(8.0)
        assert s.phase(order) is Phase.FAILED
        assert "taken over by bob" in s.note(order)
        assert s.moving_sticks(taken_s + 0.15) == []
        assert len(s.zeros(taken_s - 0.01)) == 1
        assert s.hovers(taken_s)
        assert s.aircraft.motion.ground_speed_mps < 0.1

    def test_a_stop_by_another_person_ends_it_and_the_lease_stays(self) -> None:
        s, order = self.steered_by_anna()
        s.order(Hover(), person="bob")
        s.run_for(8.0)
        assert s.phase(order) is Phase.SUPERSEDED
        assert s.aircraft.motion.ground_speed_mps < 0.1
        assert operator_of(s.w.driver.station, SERIAL) == "anna"

    def test_the_next_setpoint_of_a_single_stick_is_not_refused_after_a_takeover(self) -> None:
        s = steered()
        s.order(VirtualStick(StickFrame.GROUND, 0.0, 0.0, 3.0, HEIGHT_M, 1.0), person="anna")
        s.run_for(0.6)
        s.w.driver.handle(takes("bob", over=True, serial=SERIAL))
        taken_s = s.now_s
        s.run_for(3.0)
        assert s.zeros(taken_s)


class TestOperations:
    def test_a_survey_counts_for_the_person_who_started_it(self) -> None:
        w = surveyed_world(2)
        w.asks()
        serials = ("SIM-1", "SIM-2")
        w.driver.handle(SurveyStarted(SURVEY_ID, serials, "anna", person="anna"))
        assert {operator_of(w.driver.station, serial) for serial in serials} == {"anna"}
        w.runs(2.0)
        w.driver.handle(SurveyStopped(SURVEY_ID, "bob", is_aborted=False))
        assert w.phase() is SurveyPhase.PAUSED  # a pause is a stop
        w.driver.handle(SurveyStarted(SURVEY_ID, serials, "bob", person="bob"))
        assert w.phase() is SurveyPhase.PAUSED
        w.driver.handle(SurveyStarted(SURVEY_ID, serials, "anna", person="anna"))
        assert w.phase() is SurveyPhase.RUNNING

    def test_a_fleet_return_too(self, scene: CommandedStation) -> None:
        scene.happens(FleetReturnOrdered(80, ("A",), "anna", None, "anna"))
        assert operator_of(scene.station) == "anna"


def test_persons_kept_are_bounded(scene: CommandedStation, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(operator_lease, "PERSONS_KEPT", 4)
    for number in range(20):
        scene.happens(PersonConnected(f"p{number}")).happens(PersonDisconnected(f"p{number}"))
    assert len(scene.station.persons) <= 4
    assert {"anna", "bob"} <= scene.station.persons.keys()


def test_a_stream_that_was_never_counted_closes_without_harm(scene: CommandedStation) -> None:
    scene.happens(PersonDisconnected("carl"))
    assert scene.station.persons["carl"].streams == 0


def test_the_audit_has_each_change_of_person(scene: CommandedStation) -> None:
    def entries(event: Event) -> list[AuditEntry]:
        before = scene.station
        scene.happens(event)
        made = audit(Auditing(), before, event, scene.station, scene.now_ns)[1]
        return [entry for entry in made if entry.kind.startswith(("lease", "authority.refused"))]

    assert [e.text for e in entries(takes("anna"))] == ["A: operated by anna"]
    (refused,) = entries(takes("bob"))
    assert (refused.kind, refused.by) == ("authority.refused", "bob (10.0.0.2)")
    (over,) = entries(takes("bob", over=True))
    assert (over.kind, over.text) == ("lease.taken_over", "A: taken over by bob from anna")
    (ended,) = entries(takes("bob", PILOT))
    assert (ended.kind, ended.details["from"]) == ("lease.ended", "bob")
