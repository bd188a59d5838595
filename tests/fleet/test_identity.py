"""Which link is which vehicle: how apps in the field behave."""

from tests.fleet.reports import S, Story, core, extended

from recon.fleet.settings import FleetSettings
from recon.fleet.state import Fleet
from recon.fleet.step import SIMULATOR_GREETING
from recon.model.event import PacketReceived, Tick
from recon.model.geo import LatLon
from recon.model.report import MessageReport, MessageSeverity
from recon.model.vehicle import FlightMode

GREETING = MessageReport(MessageSeverity.INFO, SIMULATOR_GREETING)


def two_links() -> Story:
    """Link 1 is vehicle A and flies; at 10 s link 2 brings the same serial."""
    story = Story().opens(1).receives(1, core(), extended())
    return story.at(9.9).receives(1, core()).at(10.0).opens(2).receives(2, core(), extended())


class TestASerialIsTheIdentity:
    def test_a_link_has_no_identity_until_its_serial_arrives(self) -> None:
        story = Story().opens(1).receives(1, core())
        assert story.fleet.vehicles == {}
        assert [link.id for link in story.fleet.unbound_links()] == [1]
        assert story.fleet.links[1].own_state.position.is_known()

    def test_earlier_reports_become_the_vehicles(self) -> None:
        story = Story().opens(1).receives(1, core(height_m=12.0)).at(0.2).receives(1, extended())
        assert story.vehicle().height_above_takeoff_m.value == 12.0
        assert story.vehicle().height_above_takeoff_m.received_at_ns == 0
        assert story.fleet.unbound_links() == ()

    def test_links_that_say_the_placeholder_are_never_merged(self) -> None:
        story = Story()
        for link_id in (1, 2):
            story.opens(link_id).receives(link_id, extended(None), core())
        assert story.fleet.vehicles == {}
        assert [link.id for link in story.fleet.unbound_links()] == [1, 2]

    def test_a_placeholder_later_on_takes_no_identity_away(self) -> None:
        story = Story().opens(1).receives(1, extended("A"), extended(None), core())
        assert story.vehicle().link_id == 1
        assert story.vehicle().is_flying.value is True

    def test_a_serial_change_on_one_link_carries_nothing_over(self) -> None:
        story = (
            Story().opens(1).receives(1, core(), extended("A")).at(1.0).receives(1, extended("B"))
        )
        assert story.vehicle("A").link_id is None
        assert story.vehicle("B").link_id == 1
        assert not story.vehicle("B").position.is_known()
        assert not story.vehicle("B").is_flying.is_known()

    def test_a_rival_that_changes_its_serial_carries_nothing_over(self) -> None:
        story = two_links().receives(2, core(position=LatLon(1.0, 2.0)), extended("B"))
        assert story.vehicle("A").rival_link_ids == ()
        assert story.vehicle("B").link_id == 2
        assert not story.vehicle("B").position.is_known()

    def test_reports_on_a_closed_link_are_ignored(self) -> None:
        story = Story().opens(1).closes(1).receives(1, extended("A"), core())
        assert story.fleet.vehicles == {}
        story = (
            Story()
            .opens(1)
            .receives(1, core(), extended("A"))
            .at(1.0)
            .closes(1)
            .receives(1, core())
        )
        assert story.vehicle().core_received_at_ns == 0

    def test_a_link_that_is_open_is_not_opened_again(self) -> None:
        story = Story().opens(1).receives(1, core(), extended("A")).opens(1)
        assert story.fleet.links[1].claimed_serial == "A"


class TestTakeover:
    def test_the_second_link_takes_over_when_the_old_one_is_silent_for_1_s(self) -> None:
        story = two_links().at(10.999).ticks()
        assert story.vehicle().link_id == 1
        assert story.vehicle().rival_link_ids == (2,)
        story.at(11.0).ticks()
        assert story.vehicle().link_id == 2
        assert story.vehicle().rival_link_ids == ()
        assert [closing.link_id for closing in story.closing] == [1]

    def test_silence_counts_from_the_rivals_serial_not_from_before(self) -> None:
        story = (
            Story()
            .opens(1)
            .receives(1, core(), extended())
            .at(60.0)
            .opens(2)
            .receives(2, extended())
        )
        assert story.ticks().vehicle().link_id == 1
        assert story.at(61.0).ticks().vehicle().link_id == 2

    def test_one_packet_of_the_old_link_makes_it_a_conflict(self) -> None:
        story = two_links().at(10.9).receives(1, core())
        assert story.vehicle().in_conflict
        assert story.at(11.5).ticks().vehicle().link_id == 1
        assert story.closing == []

    def test_reports_of_a_rival_never_move_the_vehicle(self) -> None:
        elsewhere = LatLon(42.0001, -93.6)
        story = two_links().at(10.5).receives(2, core(position=elsewhere))
        assert story.vehicle().position.value != elsewhere
        assert story.fleet.links[2].own_state.position.value == elsewhere

    def test_conflict_ends_when_the_old_link_falls_silent_for_longer(self) -> None:
        story = two_links().at(10.5).receives(1, core()).at(13.4).ticks()
        assert story.vehicle().in_conflict
        story.at(13.5).ticks()
        assert story.vehicle().link_id == 2
        assert not story.vehicle().in_conflict

    def test_conflict_ends_when_the_rival_closes(self) -> None:
        story = two_links().receives(1, core()).closes(2)
        assert not story.vehicle().in_conflict
        assert story.vehicle().link_id == 1
        assert story.vehicle().rival_link_ids == ()

    def test_conflict_ends_when_the_old_link_closes(self) -> None:
        story = two_links().receives(1, core()).closes(1)
        assert not story.vehicle().in_conflict
        assert story.vehicle().link_id == 2

    def test_of_three_links_the_rest_begin_anew_when_the_first_closes(self) -> None:
        story = two_links().opens(3).receives(3, extended()).receives(1, core())
        assert story.vehicle().in_conflict
        story.at(12.0).closes(1)
        assert story.vehicle().link_id == 2
        assert story.vehicle().rival_link_ids == (3,)
        assert not story.vehicle().in_conflict
        assert story.at(12.9).ticks().vehicle().link_id == 2
        assert story.at(13.0).ticks().vehicle().link_id == 3

    def test_two_links_may_close_in_any_order(self) -> None:
        for order in ((1, 2), (2, 1)):
            story = two_links()
            for link_id in order:
                story.closes(link_id)
            assert story.vehicle().link_id is None
            assert story.vehicle().rival_link_ids == ()
            assert story.fleet.link_ids_claiming("A") == ()
            assert story.opens(7).receives(7, extended()).vehicle().link_id == 7


class TestHistory:
    def test_the_track_goes_on_over_a_reconnect(self) -> None:
        story = Story().opens(1).receives(1, extended(), core())
        story.at(10.0).receives(1, core(position=LatLon(42.001, -93.6))).closes(1)
        story.at(20.0).opens(2).receives(2, core(position=LatLon(42.002, -93.6)), extended())
        assert [p.latitude_deg for p in story.vehicle().track] == [42.0, 42.001, 42.002]

    def test_an_old_value_keeps_its_age_over_a_reconnect(self) -> None:
        story = Story().opens(1).receives(1, extended(), core()).closes(1)
        story.at(30.0).opens(2).receives(2, extended(mode=FlightMode.GO_HOME))
        assert story.vehicle().position.age_s(30_000_000_000) == 30.0
        assert story.vehicle().core_received_at_ns == 0
        assert story.vehicle().flight_mode.age_s(30_000_000_000) == 0.0

    def test_a_value_become_unknown_does_not_come_back_from_the_old_link(self) -> None:
        story = Story().opens(1).receives(1, extended(), core()).closes(1)
        story.at(5.0).opens(2).receives(2, core(position=None), extended())
        assert story.vehicle().position.value is None

    def test_an_app_that_names_ever_new_serials_fills_no_memory(self) -> None:
        story = Story(Fleet(settings=FleetSettings(vehicles_kept=4))).opens(1)
        for number in range(50):
            story.at(number).receives(1, extended(f"S{number}"))
        assert len(story.fleet.vehicles) == 4
        assert story.vehicle("S49").link_id == 1

    def test_what_was_last_known_to_fly_is_not_forgotten_for_it(self) -> None:
        story = Story(Fleet(settings=FleetSettings(vehicles_kept=4)))
        story.at(0.0).opens(9).receives(9, core(), extended("GONE")).closes(9).opens(1)
        for number in range(50):
            story.at(number).receives(1, extended(f"S{number}"))
        assert len(story.fleet.vehicles) == 4
        assert story.vehicle("GONE").is_flying.value is True

    def full(self) -> Story:
        """Four vehicles that flew when their links ended."""
        story = Story(Fleet(settings=FleetSettings(vehicles_kept=4)))
        for n, flying in enumerate((True, True, None, True), start=10):
            story.at(n).opens(n).receives(n, core(flying=flying), extended(f"G{n}")).closes(n)
        return story

    def test_vehicles_that_may_fly_are_kept_and_new_serials_rejected(self) -> None:
        story = self.full().at(30.0).opens(1)
        for number in range(50):
            story.receives(1, core(), extended(f"S{number}"))
        assert sorted(story.fleet.vehicles) == ["G10", "G11", "G12", "G13"]
        link = story.fleet.links[1]
        assert (link.claimed_serial, link.rejected_serial) == (None, "S49")
        assert story.fleet.unbound_links() == (link,)
        assert link.own_state.is_flying.value is True

    def test_one_that_is_known_finds_its_place_and_makes_room(self) -> None:
        story = self.full().at(30.0).opens(1).opens(2).receives(1, core(), extended("NEW"))
        story.receives(2, extended("G10")).receives(1, extended("NEW"))
        assert story.vehicle("G10").link_id == 2
        assert story.vehicle("NEW").link_id == 1
        assert story.vehicle("NEW").is_flying.value is True
        assert story.fleet.links[1].rejected_serial is None

    def test_a_link_that_names_another_then_is_neither(self) -> None:
        story = self.full().at(30.0).opens(2).receives(2, extended("G10"), core())
        story.opens(3).receives(3, core(), extended("LAST")).closes(3)
        story.receives(2, extended("OTHER"), core(height_m=7.0))
        assert "OTHER" not in story.fleet.vehicles
        assert story.vehicle("G10").link_id is None
        assert story.vehicle("G10").height_above_takeoff_m.value == 40.0
        link = story.fleet.links[2]
        assert (link.claimed_serial, link.rejected_serial) == (None, "OTHER")
        assert link.own_state.height_above_takeoff_m.value == 7.0

    def test_sixty_four_connected_vehicles_do_not_block_another(self) -> None:
        story = Story()
        for n in range(1, 66):
            story.opens(n).receives(n, core(), extended(f"S{n}"))
        assert len(story.fleet.vehicles) == 65

    def test_closed_links_are_kept_up_to_a_limit(self) -> None:
        story = Story(Fleet(settings=FleetSettings(closed_links_kept=3)))
        for link_id in range(1, 11):
            story.at(link_id).opens(link_id).closes(link_id)
        assert sorted(story.fleet.links) == [8, 9, 10]


class TestSimulated:
    def test_the_greeting_and_the_prefix_both_say_so(self) -> None:
        assert Story().opens(1).receives(1, GREETING, extended("A")).vehicle().is_simulated
        assert Story().opens(1).receives(1, extended("A"), GREETING).vehicle().is_simulated
        assert Story().opens(1).receives(1, extended("SIM-1")).vehicle("SIM-1").is_simulated
        assert not Story().opens(1).receives(1, extended("A")).vehicle().is_simulated

    def test_the_greeting_holds_for_the_links_next_serial(self) -> None:
        story = Story().opens(1).receives(1, GREETING, extended("A"), extended("B"))
        assert story.vehicle("B").is_simulated

    def test_a_real_app_that_later_uses_the_serial_is_real(self) -> None:
        story = Story().opens(1).receives(1, GREETING, extended("A")).closes(1)
        assert story.vehicle().is_simulated
        assert not story.opens(2).receives(2, core(), extended("A")).vehicle().is_simulated


class TestWithheldPackets:
    """A packet that damaged bytes withheld is as old as its bytes."""

    def test_one_from_before_the_rival_is_no_conflict(self) -> None:
        story = two_links().at(10.5).happens(PacketReceived(1, core(), round(9.95 * S)))
        assert not story.vehicle().in_conflict
        assert story.at(10.6).receives(1, core()).vehicle().in_conflict

    def test_it_does_not_replace_newer_telemetry_of_another_link(self) -> None:
        story = two_links().at(11.5).happens(Tick())
        assert story.vehicle().link_id == 2
        newest = story.vehicle()
        story.at(12.0).happens(PacketReceived(2, core(height_m=7.0), round(9.5 * S)))
        assert story.vehicle().height_above_takeoff_m == newest.height_above_takeoff_m

    def test_one_from_the_future_is_from_now(self) -> None:
        story = Story().opens(1).receives(1, extended()).at(1.0)
        story.happens(PacketReceived(1, core(), 5 * S))
        assert story.vehicle().core_received_at_ns == S
