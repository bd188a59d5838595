"""Surveys and fleet returns when temporary zones are drawn and end in flight."""

import numpy as np
import pytest
from tests.flown_once import flown_once
from tests.station.returning_world import ReturningWorld, returning_world
from tests.station.surveyed_world import SURVEY_ID, SurveyedWorld, asked, field, surveyed_world

from recon.geo import Polygon, point_from_enu
from recon.model.airspace import Region
from recon.model.command import Hover
from recon.model.control import AuthorityHolder
from recon.model.event import ZoneDrawn, ZoneEnded
from recon.model.geo import LatLon
from recon.model.survey import SurveyPhase, WhenDone
from recon.model.temporary_zone import Circle, DrawnZone, TemporaryZoneKind
from recon.station.state.fleet_return_record import Stage

MIDDLE_M = 100.0, 40.0
RADIUS_M = 15.0


def person(
    world: SurveyedWorld, middle_m: tuple[float, float] = MIDDLE_M, radius_m: float = RADIUS_M
) -> ZoneDrawn:
    frame = world.driver.station.airspace.airspace.frame
    assert frame is not None
    place = point_from_enu(frame, (*middle_m, 0.0))
    circle = Circle(LatLon(place.latitude_deg, place.longitude_deg), radius_m)
    return ZoneDrawn(DrawnZone(TemporaryZoneKind.PERSON, circle, "sprinkler"), "Ann")


@flown_once
def surveying(count: int = 1) -> SurveyedWorld:
    """A field of 200 m by 80 m, some rows of which have been flown."""
    world = surveyed_world(count, pads=((0.0, -40.0), (200.0, -40.0)))
    world.asks(asked(field(200.0, 80.0), when_done=WhenDone.HOVER))
    world.starts(*(f"SIM-{number + 1}" for number in range(count)))
    world.runs(25.0)
    assert world.phase() is SurveyPhase.RUNNING
    return world


def nearest_m(world: SurveyedWorld, since: int = 0) -> float:
    """How near the flown paths came to the middle, from a mission's number on."""
    paths = [path for (_, number), path in world.record().flown.items() if number > since]
    points_m = np.array([point for path in paths for point in path])
    return float(np.hypot(*(points_m - MIDDLE_M).T).min())


def clear_of_all_rows(world: SurveyedWorld) -> bool:
    gap_m = [
        Polygon(Region(np.array([*ends, (ends[1][0], ends[1][1] + 0.01)]))).distance_to_edge_m(
            [MIDDLE_M]
        )
        for ends in world.state().plan.rows_m
    ]
    return bool(np.abs(gap_m).min() >= RADIUS_M + 5.0)


class TestDrawnOnItsRows:
    @pytest.mark.flight
    def test_the_survey_goes_round_it_and_stays_the_surveys(self) -> None:
        world = surveying()
        rows = len(world.state().plan.pieces)
        before = world.state().missions
        world.driver.handle(person(world))
        world.runs(0.3)
        (hold,) = [
            each
            for each in world.driver.station.orders.records.values()
            if isinstance(each.command.body, Hover)
        ]
        assert hold.command.role is AuthorityHolder.GUIDANCE
        assert "its rows lead through person 1 (temporary)" in hold.command.issued_by
        world.runs(3.0)
        assert world.holder("SIM-1") is AuthorityHolder.GUIDANCE
        assert len(world.state().plan.pieces) > rows
        assert clear_of_all_rows(world)
        assert world.runs_until(SurveyPhase.DONE, 500.0), world.record()
        assert nearest_m(world, before) > RADIUS_M
        seen = world.figures()
        assert seen.reached_m2 < 0.97 * seen.region_m2
        assert seen.not_yet_m2 <= seen.region_m2 - seen.reached_m2 + 0.01 * seen.region_m2

    def test_the_round_is_not_lost(self) -> None:
        world = surveying()
        world.driver.handle(person(world))
        world.runs(5.0)
        assert world.state().round == 1
        assert world.state().flights

    def test_one_whose_rows_are_clear_of_it_flies_on(self) -> None:
        world = surveying(2)
        numbers = {serial: flight.number for serial, flight in world.state().flights.items()}
        world.driver.handle(person(world, (100.0, 75.0), 5.0))
        world.runs(3.0)
        later = {serial: flight.number for serial, flight in world.state().flights.items()}
        assert len(set(numbers.items()) & set(later.items())) == 1

    def test_rows_that_are_free_again_are_flown_in_a_later_round(self) -> None:
        world = surveying()
        world.driver.handle(person(world))
        world.runs(20.0)
        world.driver.handle(ZoneEnded(1, "Ann"))
        world.runs(2.0)
        assert world.figures().reached_m2 == pytest.approx(world.figures().region_m2)
        assert world.runs_until(SurveyPhase.DONE, 600.0), world.record()
        assert world.figures().not_yet_m2 < 0.02 * world.figures().region_m2

    def test_without_a_row_left_it_pauses_with_an_alarm(self) -> None:
        world = surveying()
        world.driver.handle(person(world, (100.0, 40.0), 300.0))
        world.runs(4.0)
        assert world.phase() is SurveyPhase.PAUSED
        assert "keep-out zones" in world.state().reason
        texts = [a.condition.text for a in world.driver.station.alarms.alarms.values()]
        assert any("has paused automatically" in text for text in texts)
        world.driver.handle(ZoneEnded(1, "Ann"))
        world.runs(2.0)
        assert world.phase() is SurveyPhase.PAUSED
        world.starts("SIM-1")
        world.runs(5.0)
        assert world.state().flights

    def test_one_that_has_not_begun_is_planned_anew_too(self) -> None:
        world = surveyed_world()
        world.asks(asked(field(200.0, 80.0)))
        world.driver.handle(person(world))
        world.runs(1.0)
        assert clear_of_all_rows(world)
        assert world.phase() is SurveyPhase.CREATED
        assert world.driver.station.surveys.records[SURVEY_ID].zone_changes == 1


class TestFleetReturn:
    def called(self, seconds: float) -> ReturningWorld:
        """Two vehicles returning home, and a zone on the first one's, so long after the call."""
        world = returning_world([(0, 120, 30), (60, 120, 40)], [(0, -20), (60, -20)])
        driver = world.world.driver
        world.call("SIM-1", "SIM-2")
        world.runs(seconds)
        frame = driver.station.airspace.airspace.frame
        assert frame is not None
        place = point_from_enu(frame, (0.0, 50.0, 0.0))
        circle = Circle(LatLon(place.latitude_deg, place.longitude_deg), 15.0)
        drawn = DrawnZone(TemporaryZoneKind.CREWED_AIRCRAFT, circle, "medical helicopter")
        driver.handle(ZoneDrawn(drawn, "Ann"))
        assert world.runs_until_over(300.0)
        assert world.member("SIM-2").stage is Stage.LANDED
        return world

    @pytest.mark.parametrize("seconds", [0.05, 0.6])
    def test_what_waits_is_planned_round_it(self, seconds: float) -> None:
        world = self.called(seconds)
        member = world.member("SIM-1")
        assert member.stage is Stage.LANDED, member.reason
        assert member.flight is not None
        assert len(member.flight.path_m) > 2

    def test_what_flies_into_it_is_held_and_left_out_with_a_reason(self) -> None:
        world = self.called(9.0)
        assert world.member("SIM-1").stage is Stage.EXCLUDED
        assert "station: zone_ahead" in world.member("SIM-1").reason
        assert ("fleet_return", "SIM-1") in world.alarms()


def by_itself(world: SurveyedWorld) -> list[str]:
    found = world.driver.station.alarms.alarms.values()
    return [
        each.condition.text for each in found if each.condition.rule == "survey" and each.is_active
    ]


class TestOverTheWholeField:
    def test_the_survey_pauses_and_the_alarm_outlives_the_zone(self) -> None:
        """An operator starts it again when the zone has ended."""
        world = surveying()
        world.driver.handle(person(world, radius_m=300.0))
        world.runs(4.0)
        assert world.phase() is SurveyPhase.PAUSED
        assert world.holder("SIM-1") is AuthorityHolder.OPERATOR
        world.driver.handle(ZoneEnded(1, "Ann"))
        world.runs(3.0)
        (text,) = by_itself(world)
        assert "has paused automatically: no row" in text
        assert text.endswith("Start it again, or abort it")
        world.starts("SIM-1")
        world.runs(3.0)
        assert by_itself(world) == []

    def test_a_pause_that_was_commanded_is_none_by_itself(self) -> None:
        world = surveying()
        world.pauses()
        world.runs(3.0)
        world.driver.handle(person(world, radius_m=300.0))
        world.runs(4.0)
        assert by_itself(world) == []
