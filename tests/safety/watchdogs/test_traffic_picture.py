"""What the watchdogs look at: who is in it, in which plane, and who may be held."""

from dataclasses import replace

import pytest
from tests.safety.traffic import AIR, FRAME, NOW, S, aircraft, at, flies, route
from tests.safety.watchdogs.looks import held, in_context, picture

from recon.model.airspace import Airspace
from recon.model.control import AuthorityHolder
from recon.model.failsafe_matrix import FailsafeCondition
from recon.model.geo import LatLon
from recon.model.vehicle import Failsafe
from recon.safety import PreparedAirspace
from recon.safety.prediction_settings import PredictionSettings
from recon.safety.settings import EnergySettings, GoHomeSettings, SafetySettings, WatchdogSettings
from recon.safety.watchdogs import (
    CommandedHold,
    WatchedVehicle,
    build_traffic_picture,
    hold_outcome,
    plane_of,
)

NOWHERE = PreparedAirspace(Airspace())


def test_it_has_the_settings_it_was_built_with() -> None:
    settings = replace(
        SafetySettings(),
        watchdogs=WatchdogSettings(horizon_s=5.0),
        prediction=PredictionSettings(stale_s=1.0, hazard_least_speed_mps=4.0),
        energy=EnergySettings(landing_fraction=0.2),
        go_home=GoHomeSettings(near_home_m=30.0),
    )
    vehicles, since_ns = [aircraft("A"), aircraft("B", age_s=2.0)], {"a": NOW - 2 * S}
    for is_hold_on in (True, False):
        built = build_traffic_picture(
            map(in_context, vehicles), AIR, settings, NOW, since_ns, is_hold_on=is_hold_on
        )
        assert built.settings is settings.watchdogs
        assert built.prediction is settings.prediction
        assert (built.energy, built.go_home) == (settings.energy, settings.go_home)
        assert (built.airspace, built.is_hold_on) == (AIR, is_hold_on)
        assert [one.name for one in built.flying] == ["A"]
        assert build_traffic_picture([], AIR, settings, NOW, since_ns).is_hold_on
        hazard = built.watched[1].hazard
        assert hazard is not None
        assert hazard.growth_mps == 4.0
        assert (built.lasted_s("a"), built.lasted_s("b")) == (2.0, 0.0)


def test_who_flies_in_contact_who_may_continue_a_mission_and_who_is_only_watched() -> None:
    mission = flies(route((0.0, 0.0), (900.0, 0.0)), 1)
    built = picture(
        aircraft("flies"),
        aircraft("grounded", flying=False),
        aircraft("unplaced", None),
        in_context(aircraft("lost", age_s=9.0, failsafe=Failsafe.HOVER), intent=mission),
        aircraft("hazard", age_s=9.0),
    )
    assert [one.name for one in built.flying] == ["flies"]
    assert [one.name for one in built.lost] == ["lost"]
    assert [one.name for one in built.predicted] == ["flies", "lost"]
    assert len(built.watched) == 5


def test_a_lost_mission_is_flown_on_anywhere_within_a_tenth_of_what_time_has_made_of_it() -> None:
    mission = flies(route((0.0, 0.0), (0.0, 900.0), (900.0, 900.0)), 1)
    state = aircraft(velocity=(0.0, 5.0, 0.0), age_s=100.0, failsafe=Failsafe.HOVER)
    ahead = picture(in_context(state, intent=mission)).ahead.as_it_flies
    assert ahead.east_m[0] == pytest.approx([500.0 + 1.25 * number for number in range(41)], 0.01)
    assert ahead.radius_m[0] == pytest.approx([50.0] * 41)


class TestThePlane:
    def test_is_at_the_sites_origin(self) -> None:
        plane = plane_of(AIR, [aircraft(place=(300.0, 40.0))])
        assert plane.east_north_m(FRAME.origin) == (0.0, 0.0)
        assert plane.east_north_m(at(300.0, 40.0)) == pytest.approx((40.0, 300.0), abs=0.1)

    def test_is_at_the_first_place_without_a_site(self) -> None:
        states = [aircraft("A", None), aircraft("B", (300.0, 40.0)), aircraft("C")]
        plane = plane_of(NOWHERE, states)
        assert plane.east_north_m(at(300.0, 40.0)) == (0.0, 0.0)
        built = picture(*states, airspace=NOWHERE)
        assert [(one.motion.east_m, one.motion.north_m) for one in built.flying if one.motion] == [
            (0.0, 0.0),
            pytest.approx((-40.0, -300.0), abs=0.1),
        ]

    def test_is_at_no_latitude_and_longitude_when_none_has_a_place(self) -> None:
        assert plane_of(NOWHERE, [aircraft("A", None)]).east_north_m(LatLon(0.0, 0.0)) == (0.0, 0.0)


class TestHolding:
    @pytest.mark.parametrize(
        ("hold", "refused", "outcome"),
        [
            (None, "", ""),
            (CommandedHold(0, 0.0), "", "was ordered to hold"),
            (CommandedHold(0, 0.0), "no link", "could not be held (no link)"),
            (None, "no link", "could not be held (no link)"),
        ],
    )
    def test_what_became_of_it(
        self, hold: CommandedHold | None, refused: str, outcome: str
    ) -> None:
        assert hold_outcome(hold, refused) == outcome
        watched = in_context(aircraft(), held=hold, hold_refused=refused)
        assert watched.hold_outcome == outcome

    def test_is_the_stations_to_give_unless_something_forbids_it(self) -> None:
        condition = FailsafeCondition.GEOFENCE
        (free,) = picture(aircraft()).flying
        assert free.may_be_held_for(condition)
        assert free.may_be_held_for(None)
        doubted = replace(
            free.state,
            is_flying=replace(free.state.is_flying, value=None),
            reported_is_flying=replace(free.state.is_flying, value=False),
        )
        assert free._replace(state=doubted).is_flying_in_contact
        changed: list[WatchedVehicle] = [
            free._replace(motion=None),
            free._replace(state=doubted),
            free._replace(state=replace(free.state, serial=None)),
            free._replace(holder=AuthorityHolder.PILOT),
            free._replace(hold_refused="no link"),
        ]
        for one in changed:
            assert not one.may_be_held_for(condition)
            assert not one.may_be_held_for(None)
        left = free._replace(alarm_only=frozenset({condition}))
        assert not left.may_be_held_for(condition)
        assert left.may_be_held_for(FailsafeCondition.SEPARATION)
        assert left.may_be_held_for(None)

    def test_was_within_so_many_seconds_until_they_are_over(self) -> None:
        for since_s, is_recent in ((0.0, True), (4.9, True), (5.0, False), (5.1, False)):
            watched = in_context(aircraft(), held=held(since_s))
            assert watched.was_held_within_s(NOW, 5.0) is is_recent
        assert not in_context(aircraft()).was_held_within_s(NOW, 5.0)
