"""Started, finished, pilot takeover, failsafe: distinguished by telemetry; one end per order."""

import pytest
from tests.safety.cases import STICK, mission, waypoint
from tests.station.commanded import CommandedStation
from tests.station.flown import (
    GPS,
    NORTHWARD,
    WAYPOINT,
    at,
    at_the_end,
    flies,
    hovering,
    ordered,
    to_land,
    under_way,
)

from recon.model.command import Body, Hover, LandNow, Phase, ReturnHome
from recon.model.control import AuthorityHolder, Commanded
from recon.model.event import AuthorityTaken
from recon.model.vehicle import FlightMode

HOME, LANDING, SPORT = FlightMode.GO_HOME, FlightMode.AUTO_LANDING, FlightMode.GPS_SPORT


def holder(scene: CommandedStation) -> AuthorityHolder:
    return scene.station.control("A").authority.holder


def commanded(scene: CommandedStation) -> Commanded:
    return scene.station.control("A").intent.commanded


def ended_as(scene: CommandedStation, order: int, phase: Phase) -> None:
    """The order has ended so, once, and stays so."""
    assert scene.phase(order) is phase, scene.record(order).history
    scene.passes(5.0)
    assert {p for p in scene.phases(order) if p.is_final} == {phase}


class TestAMission:
    def test_it_starts_and_is_done_at_its_end(self) -> None:
        scene, order = at_the_end()
        assert scene.phase(order) is Phase.STARTED
        scene.keeps_receiving(1, *at(50.0, GPS)).passes(0.2)
        ended_as(scene, order, Phase.DONE)
        assert commanded(scene) is Commanded.HOLD
        assert holder(scene) is AuthorityHolder.OPERATOR
        assert scene.alarms() == set()

    @pytest.mark.parametrize(("north_m", "phase"), [(45.2, Phase.DONE), (44.8, Phase.SUPERSEDED)])
    def test_5_m_from_its_end_lie_between_its_end_and_the_pilot(
        self, north_m: float, phase: Phase
    ) -> None:
        scene, order = at_the_end()
        scene.keeps_receiving(1, *at(north_m, GPS)).passes(1.5)
        ended_as(scene, order, phase)

    def test_leaving_it_elsewhere_without_go_home_or_landing_is_the_pilot(self) -> None:
        scene, order = under_way()
        scene.keeps_receiving(1, *at(25.0, GPS)).passes(0.9)
        assert scene.phase(order) is Phase.STARTED
        scene.passes(0.4)
        ended_as(scene, order, Phase.SUPERSEDED)
        assert "the pilot has taken over: left its mission" in scene.record(order).note
        assert holder(scene) is AuthorityHolder.PILOT
        assert commanded(scene) is Commanded.NOTHING

    def test_position_mode_on_the_way_to_go_home_is_not_the_pilot(self) -> None:
        scene, order = under_way()
        scene.keeps_receiving(1, *at(25.0, GPS)).passes(0.5)
        scene.keeps_receiving(1, *at(25.0, HOME)).passes(1.5)
        ended_as(scene, order, Phase.FAILED)
        assert "failsafe, or the pilot's return button" in scene.record(order).note
        assert holder(scene) is AuthorityHolder.OPERATOR
        assert scene.alarms() == {"failsafe"}

    @pytest.mark.parametrize("mode", [LANDING, FlightMode.CONFIRM_LANDING, HOME])
    @pytest.mark.parametrize("north_m", [25.0, 50.0])
    def test_a_landing_or_return_without_an_order_is_a_failsafe(
        self, mode: FlightMode, north_m: float
    ) -> None:
        scene, order = at_the_end()
        for passed_m in (40.0, 32.0) if north_m < 50.0 else ():  # no faster than an aircraft
            scene.keeps_receiving(1, *at(passed_m, WAYPOINT)).passes(0.1)
        scene.keeps_receiving(1, *at(north_m, mode)).passes(1.3)
        ended_as(scene, order, Phase.FAILED)
        assert "failsafe" in scene.alarms()
        assert commanded(scene) is Commanded.NOTHING

    def test_the_alarm_of_a_failsafe_ends_with_the_landing_or_a_new_order(self) -> None:
        scene, _ = under_way()
        scene.keeps_receiving(1, *at(25.0, HOME)).passes(1.5)
        assert "failsafe" in scene.alarms()
        scene.order(Hover())
        assert "failsafe" not in scene.passes(0.2).alarms()
        scene, _ = under_way()
        scene.keeps_receiving(1, *at(25.0, HOME)).passes(1.5)
        scene.lands(1, *at(0.0, GPS, flying=False)).passes(0.3)
        assert scene.alarms() == set()

    @pytest.mark.parametrize("mode", [SPORT, FlightMode.MANUAL, FlightMode.ATTI])
    def test_a_mode_of_the_pilots_own_counts_at_once(self, mode: FlightMode) -> None:
        scene, order = under_way()
        scene.receives(1, *at(25.0, mode)).passes(0.1)
        ended_as(scene, order, Phase.SUPERSEDED)
        assert holder(scene) is AuthorityHolder.PILOT

    def test_atti_without_gnss_is_nobodys_doing_and_ends_it_only_when_it_lasts(self) -> None:
        scene, order = under_way()
        scene.keeps_receiving(1, *at(25.0, FlightMode.ATTI, gnss_level=1)).passes(25.0)
        assert scene.phase(order) is Phase.STARTED
        scene.passes(7.0)
        ended_as(scene, order, Phase.FAILED)
        assert holder(scene) is AuthorityHolder.OPERATOR

    def test_it_goes_on_when_such_a_mode_passes(self) -> None:
        scene, order = under_way()
        scene.keeps_receiving(1, *at(25.0, FlightMode.OTHER)).passes(10.0)
        flies(scene, 30.0, 40.0, 50.0).keeps_receiving(1, *at(50.0, GPS)).passes(0.2)
        ended_as(scene, order, Phase.DONE)

    def test_on_the_ground_it_has_failed_when_it_was_not_to_land(self) -> None:
        scene, order = at_the_end()
        scene.lands(1, *at(50.0, GPS, flying=False)).passes(1.3)
        ended_as(scene, order, Phase.FAILED)

    def test_a_newer_order_supersedes_it(self) -> None:
        scene, order = under_way()
        scene.order(Hover())
        ended_as(scene, order, Phase.SUPERSEDED)

    def test_a_newer_mission_takes_its_place_without_leaving_mode_10(self) -> None:
        scene, order = under_way()
        newer = scene.order(mission())
        scene.keeps_receiving(1, *at(25.0, WAYPOINT, velocity=(-5.0, 0.0, 0.0))).passes(0.3)
        assert scene.phase(order) is Phase.SUPERSEDED
        assert scene.phase(newer) is Phase.STARTED

    def test_without_telemetry_its_outcome_is_unknown_in_the_end(self) -> None:
        scene, order = under_way()
        scene.talk.clear()
        scene.passes(590.0)
        assert scene.phase(order) is Phase.STARTED
        scene.passes(20.0)
        assert scene.phase(order) is Phase.FAILED
        assert scene.record(order).note == "telemetry lost: outcome unknown"

    def test_finished_in_a_gap_of_telemetry_it_is_done_by_the_newest_place(self) -> None:
        scene, order = under_way()
        scene.talk.clear()
        scene.passes(12.0).keeps_receiving(1, *at(50.0, GPS)).passes(0.3)
        ended_as(scene, order, Phase.DONE)

    def test_a_place_older_than_the_mode_decides_nothing(self) -> None:
        scene, order = at_the_end()
        scene.keeps_receiving(1, at(50.0, GPS)[1]).passes(3.0)
        assert scene.phase(order) is Phase.STARTED

    def test_a_round_trip_that_is_left_at_its_beginning_was_not_finished(self) -> None:
        """The end lies 3 m from the beginning and counts only after the other waypoints."""
        scene, order = ordered(
            mission(waypoint(0.0), waypoint(50.0), waypoint(100.0), waypoint(3.0))
        )
        flies(scene, 0.0).keeps_receiving(1, *at(2.0, GPS)).passes(1.5)
        ended_as(scene, order, Phase.SUPERSEDED)

    def test_carried_out_late_it_is_still_followed_to_its_end(self) -> None:
        scene, order = ordered(mission())
        scene.passes(9.0)
        assert scene.alarms() == {"mission_ignored"}
        flies(scene, 0.0, 10.0)
        assert scene.alarms() == set()
        assert commanded(scene) is Commanded.MISSION
        ended_as(scene, order, Phase.TIMED_OUT)


class TestAMissionThatLands:
    def test_it_is_done_on_the_ground_at_its_end(self) -> None:
        scene, order = at_the_end(to_land(mission()))
        scene.keeps_receiving(1, *at(50.0, LANDING, height_m=10.0)).passes(3.0)
        assert scene.phase(order) is Phase.STARTED
        scene.lands(1, *at(50.0, GPS, flying=False)).passes(0.2)
        ended_as(scene, order, Phase.DONE)
        assert commanded(scene) is Commanded.NOTHING

    def test_landing_elsewhere_is_a_failsafe(self) -> None:
        scene, order = under_way(to_land(mission()))
        scene.keeps_receiving(1, *at(25.0, LANDING)).passes(1.3)
        ended_as(scene, order, Phase.FAILED)

    def test_hovering_at_its_end_is_the_pilot_who_stopped_the_landing(self) -> None:
        scene, order = at_the_end(to_land(mission()))
        scene.keeps_receiving(1, *at(50.0, GPS)).passes(1.3)
        ended_as(scene, order, Phase.SUPERSEDED)


class TestOtherOrders:
    def test_a_return_is_confirmed_then_done_on_the_ground(self) -> None:
        scene = hovering()
        order = scene.order(ReturnHome())
        assert "go-home height, 40 m" in scene.record(order).history[0].note
        scene.keeps_receiving(1, *at(0.0, HOME)).passes(1.0)
        assert scene.phase(order) is Phase.CONFIRMED
        scene.keeps_receiving(1, *at(0.0, LANDING)).passes(5.0)
        assert scene.phase(order) is Phase.CONFIRMED
        scene.lands(1, *at(0.0, GPS, flying=False)).passes(0.2)
        ended_as(scene, order, Phase.DONE)
        assert commanded(scene) is Commanded.NOTHING

    @pytest.mark.parametrize(
        ("body", "mode"), [(ReturnHome(), HOME), (LandNow(), LANDING)], ids=["return", "land"]
    )
    def test_hovering_instead_is_the_pilot(self, body: Body, mode: FlightMode) -> None:
        scene = hovering()
        order = scene.order(body)
        scene.keeps_receiving(1, *at(0.0, mode)).passes(1.0)
        scene.keeps_receiving(1, *at(0.0, GPS)).passes(1.3)
        ended_as(scene, order, Phase.SUPERSEDED)
        assert holder(scene) is AuthorityHolder.PILOT

    def test_a_hold_is_confirmed_and_done_when_it_stands(self) -> None:
        scene, _ = under_way()
        order = scene.order(Hover())
        scene.keeps_receiving(1, *at(30.0, GPS, velocity=NORTHWARD)).passes(1.0)
        assert scene.phase(order) is Phase.SENT
        scene.keeps_receiving(1, *at(33.0, GPS)).passes(0.2)
        assert scene.phases(order)[-2:] == [Phase.CONFIRMED, Phase.DONE]
        assert commanded(scene) is Commanded.HOLD
        assert holder(scene.passes(30.0)) is AuthorityHolder.OPERATOR

    @pytest.mark.parametrize(
        ("mode", "north_m"),
        [(FlightMode.JOYSTICK, 0.0), (WAYPOINT, 0.0), (GPS, 8.0), (SPORT, 0.0)],
    )
    def test_a_holding_vehicle_flown_by_hand_is_the_pilots(
        self, mode: FlightMode, north_m: float
    ) -> None:
        scene = hovering()
        scene.order(Hover())
        scene.passes(1.0).keeps_receiving(1, *at(north_m, mode)).passes(1.3)
        assert holder(scene) is AuthorityHolder.PILOT
        assert commanded(scene) is Commanded.NOTHING

    def test_an_order_between_the_pilots_mode_and_the_next_place_is_refused(self) -> None:
        scene = hovering()
        scene.order(Hover())
        scene.passes(1.0).keeps_receiving(1, *at(0.0, GPS)).passes(1.0)
        core, extended = at(0.0, SPORT)
        scene.keeps_receiving(1).passes(0.08).receives(1, extended)
        order = scene.order(mission())
        assert scene.phase(order) is Phase.REFUSED_BY_STATION
        scene.keeps_receiving(1, core, extended).passes(0.5)
        assert holder(scene) is AuthorityHolder.PILOT
        assert commanded(scene) is Commanded.NOTHING

    def test_an_order_against_a_pilots_mode_that_is_known_is_no_new_takeover(self) -> None:
        scene = hovering()
        scene.keeps_receiving(1, *at(0.0, SPORT)).passes(1.0)
        assert holder(scene) is AuthorityHolder.PILOT
        scene.happens(AuthorityTaken("A", AuthorityHolder.OPERATOR, "test"))
        scene.order(mission())
        scene.passes(0.5)
        assert holder(scene) is AuthorityHolder.OPERATOR

    def test_a_place_that_wanders_without_gnss_does_not_blame_the_pilot(self) -> None:
        scene = hovering()
        scene.order(Hover())
        scene.passes(1.0).keeps_receiving(1, *at(8.0, GPS, gnss_level=1)).passes(5.0)
        assert holder(scene) is AuthorityHolder.OPERATOR

    def test_a_stick_is_confirmed_then_done_when_its_time_is_over(self) -> None:
        scene = hovering()
        order = scene.order(STICK)
        scene.keeps_receiving(1, *at(0.0, FlightMode.JOYSTICK)).passes(0.5)
        assert scene.phase(order) is Phase.CONFIRMED
        scene.passes(1.6).keeps_receiving(1, *at(0.0, GPS))
        ended_as(scene, order, Phase.DONE)
        assert commanded(scene) is Commanded.HOLD

    def test_after_a_stick_the_app_may_fall_back_to_position_mode(self) -> None:
        scene = hovering()
        scene.order(STICK)
        scene.keeps_receiving(1, *at(0.0, FlightMode.JOYSTICK)).passes(3.0)
        scene.keeps_receiving(1, *at(3.0, GPS)).passes(10.0)
        assert holder(scene) is AuthorityHolder.OPERATOR


class TestToldNothing:
    def test_a_pilot_who_flies_in_a_mode_of_their_own_leads(self) -> None:
        scene = hovering()
        scene.keeps_receiving(1, *at(0.0, SPORT)).passes(0.2)
        assert holder(scene) is AuthorityHolder.PILOT

    def test_what_was_so_from_the_beginning_is_no_takeover(self) -> None:
        reports = at(0.0, SPORT)
        scene = CommandedStation().opens(1, *reports).keeps_receiving(1, *reports).passes(10.0)
        assert holder(scene) is AuthorityHolder.OPERATOR

    @pytest.mark.parametrize("mode", [HOME, LANDING, WAYPOINT, GPS])
    def test_whatever_else_it_does_is_its_pilots_matter(self, mode: FlightMode) -> None:
        scene = hovering()
        scene.keeps_receiving(1, *at(0.0, mode)).passes(10.0)
        assert holder(scene) is AuthorityHolder.OPERATOR
        assert scene.alarms() == set()


class TestReconnecting:
    def test_one_that_comes_back_flying_on_is_followed_on(self) -> None:
        scene, order = under_way()
        scene.closes(1).passes(1.0)
        reports = at(30.0, WAYPOINT, velocity=NORTHWARD)
        scene.opens(2, *reports).keeps_receiving(2, *reports).passes(1.0)
        assert scene.phase(order) is Phase.STARTED
        assert commanded(scene) is Commanded.MISSION

    def test_reconnecting_in_an_ambiguous_mode_leaves_nothing_commanded(self) -> None:
        scene, order = under_way()
        scene.closes(1).passes(1.0)
        reports = at(30.0, FlightMode.OTHER)
        scene.opens(2, *reports).keeps_receiving(2, *reports).passes(1.0)
        ended_as(scene, order, Phase.FAILED)
        assert commanded(scene) is Commanded.NOTHING

    def test_nothing_is_sent_to_it(self) -> None:
        scene, _ = under_way()
        before = len(scene.handed)
        scene.closes(1).passes(1.0)
        scene.opens(2, *at(30.0, GPS)).keeps_receiving(2, *at(30.0, GPS)).passes(30.0)
        assert len(scene.handed) == before
