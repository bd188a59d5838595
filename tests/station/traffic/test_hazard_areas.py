"""A lost vehicle stays in the air until telemetry or an operator takes it out."""

from dataclasses import replace

import pytest
from tests.fleet.reports import PLACE, core, extended
from tests.station.commanded import CommandedStation

from recon.fleet.settings import FleetSettings
from recon.geo.distance import moved_m
from recon.model.command import GoTo, Hover, Phase
from recon.model.control import AuthorityHolder
from recon.model.event import AlarmAcknowledged, AuthorityTaken, HazardDismissed
from recon.station.api_views.vehicle_views import hazard_view
from recon.station.traffic.known_traffic import hazard, in_the_air, is_dismissible

NORTH_100 = moved_m(PLACE, 100.0, 0.0)


def stale(seconds: float = 60.0, **reported: object) -> CommandedStation:
    """A took off 100 m south of its last position; its telemetry is lost."""
    scene = CommandedStation().opens(1, core(flying=False), extended()).receives(1, core())
    moving = core(position=NORTH_100, velocity=(3.0, 0.0, 0.0), **reported)  # type: ignore[arg-type]
    scene = scene.passes(4.0).receives(1, moving)
    if reported.get("flying") is False:
        scene.lands(1, moving, extended()).talk.clear()
    return scene.passes(seconds)


def in_air(scene: CommandedStation) -> list[str]:
    return [state.display_name for state, _ in in_the_air(scene.station)]


class TestHazard:
    def test_it_grows_at_its_last_speed_up_to_150_m_and_has_a_route_home(self) -> None:
        scene = stale(4.0)
        view = hazard_view(scene.station, scene.station.fleet.vehicles["A"], scene.now_ns)
        assert view is not None
        assert abs(view.radius_m - 12.0) < 0.5
        assert (view.growth_mps, view.largest_radius_m, view.dismissal_name) == (3.0, 150.0, "A")
        assert (view.longitude_deg, view.latitude_deg) == view.corridor[0]
        assert view.corridor[1] == (PLACE.longitude_deg, PLACE.latitude_deg)
        later = stale(600.0)
        grown = hazard_view(later.station, later.station.fleet.vehicles["A"], later.now_ns)
        assert grown is not None
        assert grown.radius_m == 150.0

    def test_with_telemetry_or_on_the_ground_there_is_no_hazard_area(self) -> None:
        for scene in (
            stale(2.9),
            stale(60.0, flying=False),
            CommandedStation().opens(1, extended()).passes(5),
        ):
            vehicle = scene.station.fleet.vehicles["A"]
            assert hazard(scene.station, vehicle, scene.now_ns) is None
            assert hazard_view(scene.station, vehicle, scene.now_ns) is None
            assert not is_dismissible(scene.station, "A", scene.now_ns)

    def test_the_home_of_one_first_connected_in_the_air_is_unknown(self) -> None:
        scene = CommandedStation().opens(1, core(), extended("Z")).passes(60.0)
        view = hazard_view(scene.station, scene.station.fleet.vehicles["Z"], scene.now_ns)
        assert view is not None
        assert view.corridor == []


class TestDismissal:
    def test_a_dismissal_lasts_until_new_telemetry(self) -> None:
        scene = stale()
        assert in_air(scene) == ["A"]
        scene.happens(HazardDismissed("A", "Ann"))
        assert in_air(scene) == []
        assert hazard(scene.station, scene.station.fleet.vehicles["A"], scene.now_ns) is None
        assert not is_dismissible(scene.station, "A", scene.now_ns)
        scene.passes(600.0)
        assert in_air(scene) == []
        scene.receives(1, core())
        assert in_air(scene) == ["A"]

    def test_its_alarm_ends_with_it_and_returns_only_after_new_telemetry(self) -> None:
        scene = stale()
        assert scene.alarms() == {"link_lost"}
        scene.happens(HazardDismissed("A", "Ann")).passes(60.0)
        assert scene.alarms() == set()
        scene.receives(1, core()).passes(4.0)
        assert "link_lost" in scene.alarms()

    def test_nothing_else_dismisses_it(self) -> None:
        scene = stale().closes(1).passes(600.0)
        assert in_air(scene) == ["A"]

    def test_a_vehicle_without_a_hazard_area_cannot_be_dismissed(self) -> None:
        scene = stale(1.0)
        scene.happens(HazardDismissed("A", "Ann")).happens(HazardDismissed("unknown", "Ann"))
        assert in_air(scene) == ["A"]
        assert scene.station.watchdog_state.dismissed == {}

    def test_one_without_any_position_can_be_dismissed(self) -> None:
        scene = CommandedStation().opens(1, core(position=None), extended()).passes(1.0)
        assert is_dismissible(scene.station, "A", scene.now_ns)
        scene.happens(HazardDismissed("A", "Ann"))
        assert in_air(scene) == []
        assert not is_dismissible(scene.station, "A", scene.now_ns)


class TestWithoutASerial:
    def lost(self) -> CommandedStation:
        return (
            CommandedStation().opens(7, core(), extended(None)).passes(1.0).closes(7).passes(10.0)
        )

    def test_it_stays_in_the_air_when_its_link_ends(self) -> None:
        scene = self.lost()
        assert in_air(scene) == ["unidentified link 7"]
        view = hazard_view(scene.station, scene.station.watchdog_state.lost["link-7"], scene.now_ns)
        assert view is not None
        assert view.dismissal_name == "link-7"

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
    def test_a_second_connection_of_an_identified_phone_leaves_no_lost_vehicle(
        self, changes: dict[str, object], is_kept: bool
    ) -> None:
        scene = CommandedStation().opens(1, extended("A"), core(height_m=40.0))
        scene.opens(2, core(**{"height_m": 40.0, **changes}))  # type: ignore[arg-type]
        scene.closes(2)
        assert bool(scene.station.watchdog_state.lost) is is_kept

    def test_without_current_telemetry_of_the_identified_one_it_is_kept(self) -> None:
        scene = CommandedStation().opens(1, extended("A"), core(height_m=40.0)).passes(1.5)
        scene.opens(2, core(height_m=40.0)).closes(2)
        assert set(scene.station.watchdog_state.lost) == {"link-2"}

    def test_an_operator_dismisses_it(self) -> None:
        scene = self.lost()
        assert is_dismissible(scene.station, "link-7", scene.now_ns)
        scene.happens(HazardDismissed("link-7", "Ann"))
        assert in_air(scene) == []
        again = self.lost().happens(HazardDismissed("unidentified link 7", "Ann"))
        assert in_air(again) == []

    def test_its_alarm_stays_until_then_even_if_acknowledged(self) -> None:
        scene = self.lost()
        (alarm,) = (a for a in scene.station.alarms.alarms.values() if a.is_active)
        assert alarm.condition.rule == "unidentified_lost"
        assert "dismiss link-7" in alarm.condition.text
        scene.happens(AlarmAcknowledged(alarm.id, "Ann")).passes(60.0)
        assert scene.alarms() == {"unidentified_lost"}
        scene.happens(HazardDismissed("link-7", "Ann")).passes(0.1)
        assert scene.alarms() == set()

    def test_one_on_the_ground_is_not_kept(self) -> None:
        scene = (
            CommandedStation().opens(7, core(flying=False), extended(None)).passes(1.0).closes(7)
        )
        assert in_air(scene) == []

    def test_too_many_lost_vehicles_block_all_motion_until_dismissed(self) -> None:
        scene = (
            CommandedStation()
            .opens(99, core(), extended("A"))
            .keeps_receiving(99, core(), extended("A"))
        )
        for link_id in range(1, 30):
            scene.opens(
                link_id, core(position=moved_m(PLACE, 5_000.0, 0.0)), extended(None)
            ).closes(link_id)
        scene.passes(0.5)
        assert [*scene.station.watchdog_state.lost] == [
            *(f"link-{i}" for i in range(1, 17)),
            "many-lost",
        ]
        texts = [a.condition.text for a in scene.station.alarms.alarms.values()]
        assert sum("many-lost is dismissed" in text for text in texts) == 1
        refused = scene.record(scene.order(GoTo(moved_m(PLACE, 30.0, 0.0), 40.0, 5.0)))
        assert refused.phase is Phase.REFUSED_BY_STATION
        assert "one of many lost vehicles may be in the air" in refused.note
        assert scene.phase(scene.order(Hover())) is Phase.SENT
        scene.happens(HazardDismissed("many-lost", "Ann")).passes(0.1)
        assert scene.phase(scene.order(GoTo(moved_m(PLACE, 30.0, 0.0), 40.0, 5.0))) is Phase.SENT

    def test_while_its_link_is_open_its_own_telemetry_counts(self) -> None:
        scene = CommandedStation().opens(7, core(), extended(None)).passes(1.0)
        assert in_air(scene) == ["unidentified link 7"]
        scene.lands(7, core(flying=False), extended(None))
        assert in_air(scene) == []


class TestNoRoom:
    def full(self) -> CommandedStation:
        """As many hazard areas as are kept, and one more that comes."""
        scene = CommandedStation()
        fleet = replace(scene.station.fleet, settings=FleetSettings(vehicles_kept=3))
        settings = replace(scene.station.settings, fleet=fleet.settings)
        scene.station = replace(scene.station, fleet=fleet, settings=settings)
        for n, serial in enumerate(("X", "Y", "Z"), start=1):
            scene.opens(n, core(), extended(serial)).closes(n)
        scene.passes(5.0)
        return scene.opens(9, core(), extended("NEW")).passes(0.2)

    def test_another_vehicle_is_an_unidentified_hazard_and_an_alarm(self) -> None:
        scene = self.full()
        assert in_air(scene) == ["X", "Y", "Z", "unidentified link 9"]
        (alarm,) = (
            a.condition
            for a in scene.station.alarms.alarms.values()
            if a.condition.rule == "no_room"
        )
        assert "serial NEW not accepted: 3 lost vehicles" in alarm.text
        scene.receives(9, extended("NEWER"), extended("NEWEST")).passes(0.2)
        assert scene.alarms() >= {"no_room", "link_lost"}
        assert sum(a.condition.rule == "no_room" for a in scene.station.alarms.alarms.values()) == 1

    def test_it_can_be_stopped_and_stays_in_the_air_when_its_link_ends(self) -> None:
        scene = self.full()
        assert scene.phase(scene.order(Hover(), None, link=9)) is Phase.SENT
        scene.closes(9)
        assert in_air(scene) == ["X", "Y", "Z", "unidentified link 9"]

    def test_a_dismissal_makes_room(self) -> None:
        scene = self.full().happens(HazardDismissed("Y", "Ann"))
        scene.receives(9, core(), extended("NEW")).passes(0.2)
        assert in_air(scene) == ["X", "Z", "NEW"]
        assert "no_room" not in scene.alarms()
        assert scene.station.watchdog_state.dismissed == {}

    def test_a_vehicle_that_made_room_returns_as_new(self) -> None:
        """Without its old intent, tracking and authority; the others keep theirs."""
        scene = self.full()
        for serial in ("X", "Y"):
            scene.happens(AuthorityTaken(serial, AuthorityHolder.PILOT, "Ann"))
        scene.happens(HazardDismissed("Y", "Ann"))
        assert scene.station.control("X").authority.holder is AuthorityHolder.PILOT
        assert "Y" not in scene.station.controls
        scene.opens(10, core(), extended("Y")).passes(0.2)
        control = scene.station.control("Y")
        assert control.authority.holder is AuthorityHolder.OPERATOR
        assert control.tracking is not None
        assert control.tracking.is_unbidden

    def test_a_vehicle_beyond_the_limit_is_forgotten_with_its_control_state(self) -> None:
        scene = CommandedStation()
        settings = FleetSettings(vehicles_kept=1)
        scene.station = replace(
            scene.station, fleet=replace(scene.station.fleet, settings=settings)
        )
        scene.opens(1, core(flying=False), extended("OLD"))
        scene.happens(AuthorityTaken("OLD", AuthorityHolder.PILOT, "Ann")).closes(1)
        scene.opens(2, core(flying=False), extended("NEW"))
        assert set(scene.station.fleet.vehicles) == {"NEW"}
        assert "OLD" not in scene.station.controls
