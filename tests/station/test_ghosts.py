"""What is not heard stays in the air, until telemetry or a person takes it out."""

from dataclasses import replace

import pytest
from tests.fleet.said import PLACE, core, extended
from tests.station.commanded import Told

from recon.fleet.settings import FleetSettings
from recon.geo.distance import moved_m
from recon.model.command import GoTo, Hover, Phase
from recon.model.event import AlarmAcknowledged, GhostDismissed
from recon.station.api_views.hazard_view import ghost_view
from recon.station.traffic.known_traffic import ghost, in_the_air, is_hazard_unseen

NORTH_100 = moved_m(PLACE, 100.0, 0.0)


def stale(seconds: float = 60.0, **said: object) -> Told:
    """A took off 100 m south of where it flies, and has not been heard since."""
    told = Told().opens(1, core(flying=False), extended()).says(1, core())
    moving = core(position=NORTH_100, velocity=(3.0, 0.0, 0.0), **said)  # type: ignore[arg-type]
    return told.says(1, moving).passes(seconds)


def in_air(told: Told) -> list[str]:
    return [state.display_name for state, _ in in_the_air(told.station)]


class TestGhost:
    def test_it_grows_at_its_last_speed_up_to_150_m_and_has_a_way_home(self) -> None:
        told = stale(4.0)
        view = ghost_view(told.station, told.station.fleet.vehicles["A"], told.now_ns)
        assert view is not None
        assert abs(view.radius_m - 12.0) < 0.5
        assert (view.growth_mps, view.largest_radius_m, view.dismissed_as) == (3.0, 150.0, "A")
        assert (view.longitude_deg, view.latitude_deg) == view.corridor[0]
        assert view.corridor[1] == (PLACE.longitude_deg, PLACE.latitude_deg)
        later = stale(600.0)
        grown = ghost_view(later.station, later.station.fleet.vehicles["A"], later.now_ns)
        assert grown is not None
        assert grown.radius_m == 150.0

    def test_one_that_is_heard_or_on_the_ground_has_none(self) -> None:
        for told in (stale(2.9), stale(60.0, flying=False), Told().opens(1, extended()).passes(5)):
            vehicle = told.station.fleet.vehicles["A"]
            assert ghost(told.station, vehicle, told.now_ns) is None
            assert ghost_view(told.station, vehicle, told.now_ns) is None
            assert not is_hazard_unseen(told.station, "A", told.now_ns)

    def test_nobody_knows_the_home_of_one_seen_first_in_the_air(self) -> None:
        told = Told().opens(1, core(), extended("Z")).passes(60.0)
        view = ghost_view(told.station, told.station.fleet.vehicles["Z"], told.now_ns)
        assert view is not None
        assert view.corridor == []


class TestDismissal:
    def test_a_persons_word_takes_it_out_until_it_is_heard_again(self) -> None:
        told = stale()
        assert in_air(told) == ["A"]
        told.happens(GhostDismissed("A", "Ann"))
        assert in_air(told) == []
        assert ghost(told.station, told.station.fleet.vehicles["A"], told.now_ns) is None
        assert not is_hazard_unseen(told.station, "A", told.now_ns)
        told.passes(600.0)
        assert in_air(told) == []
        told.says(1, core())
        assert in_air(told) == ["A"]

    def test_its_alarm_ends_with_it_and_comes_back_only_after_it_was_heard_again(self) -> None:
        told = stale()
        assert told.alarms() == {"link_lost"}
        told.happens(GhostDismissed("A", "Ann")).passes(60.0)
        assert told.alarms() == set()
        told.says(1, core()).passes(4.0)
        assert "link_lost" in told.alarms()

    def test_nothing_else_does(self) -> None:
        told = stale().closes(1).passes(600.0)
        assert in_air(told) == ["A"]

    def test_what_is_no_ghost_cannot_be_dismissed(self) -> None:
        told = stale(1.0)
        told.happens(GhostDismissed("A", "Ann")).happens(GhostDismissed("nobody", "Ann"))
        assert in_air(told) == ["A"]
        assert told.station.watch.dismissed == {}

    def test_one_that_never_told_where_it_is_can_be_dismissed_too(self) -> None:
        told = Told().opens(1, core(position=None), extended()).passes(1.0)
        assert is_hazard_unseen(told.station, "A", told.now_ns)
        told.happens(GhostDismissed("A", "Ann"))
        assert in_air(told) == []
        assert not is_hazard_unseen(told.station, "A", told.now_ns)


class TestWithoutASerial:
    def lost(self) -> Told:
        return Told().opens(7, core(), extended(None)).passes(1.0).closes(7).passes(10.0)

    def test_it_stays_in_the_air_when_its_link_ends(self) -> None:
        told = self.lost()
        assert in_air(told) == ["unidentified link 7"]
        view = ghost_view(told.station, told.station.watch.lost["link-7"], told.now_ns)
        assert view is not None
        assert view.dismissed_as == "link-7"

    @pytest.mark.parametrize(
        ("changes", "is_kept"),
        [
            ({}, False),
            ({"position": moved_m(PLACE, 4.0, 0.0)}, False),
            ({"position": moved_m(PLACE, 8.0, 0.0)}, True),
            ({"position": None}, True),
            ({"height_m": 43.0}, True),
            ({"height_m": None}, True),
        ],
    )
    def test_a_second_connection_of_a_phone_that_is_heard_leaves_nothing_behind(
        self, changes: dict[str, object], is_kept: bool
    ) -> None:
        told = Told().opens(1, extended("A"), core(height_m=40.0))
        told.opens(2, core(**{"height_m": 40.0, **changes}))  # type: ignore[arg-type]
        told.closes(2)
        assert bool(told.station.watch.lost) is is_kept

    def test_nor_is_one_forgotten_that_tells_of_what_is_not_heard_now(self) -> None:
        told = Told().opens(1, extended("A"), core(height_m=40.0)).passes(1.5)
        told.opens(2, core(height_m=40.0)).closes(2)
        assert set(told.station.watch.lost) == {"link-2"}

    def test_a_person_takes_it_out(self) -> None:
        told = self.lost()
        assert is_hazard_unseen(told.station, "link-7", told.now_ns)
        told.happens(GhostDismissed("link-7", "Ann"))
        assert in_air(told) == []
        again = self.lost().happens(GhostDismissed("unidentified link 7", "Ann"))
        assert in_air(again) == []

    def test_its_alarm_stays_until_then_whoever_has_seen_it(self) -> None:
        told = self.lost()
        (alarm,) = (a for a in told.station.alarms.alarms.values() if a.is_active)
        assert alarm.condition.rule == "unidentified_lost"
        assert "dismiss link-7" in alarm.condition.text
        told.happens(AlarmAcknowledged(alarm.id, "Ann")).passes(60.0)
        assert told.alarms() == {"unidentified_lost"}
        told.happens(GhostDismissed("link-7", "Ann")).passes(0.1)
        assert told.alarms() == set()

    def test_one_on_the_ground_is_gone(self) -> None:
        told = Told().opens(7, core(flying=False), extended(None)).passes(1.0).closes(7)
        assert in_air(told) == []

    def test_of_too_many_none_is_forgotten_and_nothing_moves_until_a_person_knows(self) -> None:
        told = Told().opens(99, core(), extended("A")).keeps_saying(99, core(), extended("A"))
        for link_id in range(1, 30):
            told.opens(link_id, core(position=moved_m(PLACE, 5_000.0, 0.0)), extended(None)).closes(
                link_id
            )
        told.passes(0.5)
        assert [*told.station.watch.lost] == [*(f"link-{i}" for i in range(1, 17)), "many-lost"]
        texts = [a.condition.text for a in told.station.alarms.alarms.values()]
        assert sum("dismiss many-lost" in text for text in texts) == 1
        refused = told.record(told.order(GoTo(moved_m(PLACE, 30.0, 0.0), 40.0, 5.0)))
        assert refused.phase is Phase.REFUSED_BY_STATION
        assert "one of many lost vehicles may be in the air" in refused.note
        assert told.phase(told.order(Hover())) is Phase.SENT
        told.happens(GhostDismissed("many-lost", "Ann")).passes(0.1)
        assert told.phase(told.order(GoTo(moved_m(PLACE, 30.0, 0.0), 40.0, 5.0))) is Phase.SENT

    def test_while_its_link_is_open_it_is_in_the_air_by_its_own_word(self) -> None:
        told = Told().opens(7, core(), extended(None)).passes(1.0)
        assert in_air(told) == ["unidentified link 7"]
        told.says(7, core(flying=False))
        assert in_air(told) == []


class TestNoRoom:
    def full(self) -> Told:
        """As many ghosts as are kept, and one more that comes."""
        told = Told()
        fleet = replace(told.station.fleet, settings=FleetSettings(vehicles_kept=3))
        settings = replace(told.station.settings, fleet=fleet.settings)
        told.station = replace(told.station, fleet=fleet, settings=settings)
        for n, serial in enumerate(("X", "Y", "Z"), start=1):
            told.opens(n, core(), extended(serial)).closes(n)
        told.passes(5.0)
        return told.opens(9, core(), extended("NEW")).passes(0.2)

    def test_a_newcomer_is_a_hazard_without_a_name_and_an_alarm(self) -> None:
        told = self.full()
        assert in_air(told) == ["X", "Y", "Z", "unidentified link 9"]
        (alarm,) = (
            a.condition
            for a in told.station.alarms.alarms.values()
            if a.condition.rule == "no_room"
        )
        assert "says it is NEW, but 3 vehicles that may fly are not heard" in alarm.text
        told.says(9, extended("NEWER"), extended("NEWEST")).passes(0.2)
        assert told.alarms() >= {"no_room", "link_lost"}
        assert sum(a.condition.rule == "no_room" for a in told.station.alarms.alarms.values()) == 1

    def test_it_can_be_stopped_and_stays_in_the_air_when_its_link_ends(self) -> None:
        told = self.full()
        assert told.phase(told.order(Hover(), None, link=9)) is Phase.SENT
        told.closes(9)
        assert in_air(told) == ["X", "Y", "Z", "unidentified link 9"]

    def test_a_persons_word_makes_room(self) -> None:
        told = self.full().happens(GhostDismissed("Y", "Ann"))
        told.says(9, core(), extended("NEW")).passes(0.2)
        assert in_air(told) == ["X", "Z", "NEW"]
        assert "no_room" not in told.alarms()
        assert told.station.watch.dismissed == {}
