"""An optional list of apps: who is admitted, who waits, and what an operator decides."""

from dataclasses import replace
from ipaddress import ip_network

import pytest
from tests.fleet.reports import S, Story, core, extended

from recon.fleet.admission import (
    MAX_ENTRIES,
    Admission,
    AllowedApp,
    address_of,
    host_of,
    network_text,
)
from recon.fleet.pairing import refusal_to_admit, refusal_to_refuse
from recon.fleet.settings import FleetSettings
from recon.fleet.state import Fleet
from recon.model.event import AppAdmitted, AppRefused, LinkClosed, LinkOpened, Tick

HERE, THERE = "10.0.0.5:40000", "10.0.0.9:40001"
A_HERE = AllowedApp("A", ip_network("10.0.0.5/32"))


def story(*entries: AllowedApp, settings: FleetSettings | None = None) -> Story:
    """A fleet whose list has these entries."""
    told = Story()
    told.fleet = Fleet(settings=settings or FleetSettings(), admission=Admission(entries))
    return told


def opens(told: Story, link_id: int, address: str) -> Story:
    return told.happens(LinkOpened(link_id, address))


class TestWithoutAList:
    def test_every_app_is_admitted(self) -> None:
        told = opens(Story(), 1, THERE).receives(1, core(), extended("Z"))
        assert told.fleet.vehicles["Z"].link_id == 1
        assert not told.fleet.links[1].is_waiting


class TestTheList:
    def test_a_listed_serial_from_its_address_is_the_vehicle(self) -> None:
        told = opens(story(A_HERE), 1, HERE).receives(1, core(), extended("A"))
        assert told.vehicle().link_id == 1

    def test_a_serial_that_is_not_listed_waits_and_is_no_vehicle(self) -> None:
        told = opens(story(A_HERE), 1, HERE).receives(1, core(), extended("B"))
        assert told.fleet.vehicles == {}
        assert told.fleet.links[1].waiting_serial == "B"
        assert told.fleet.links[1].own_state.is_flying.value is True

    def test_a_listed_serial_from_another_address_waits_and_takes_nothing(self) -> None:
        told = opens(story(A_HERE), 1, HERE).receives(1, core(), extended("A"))
        opens(told, 2, THERE).receives(2, core(), extended("A")).receives(1, core())
        assert told.vehicle().link_id == 1
        assert told.vehicle().rival_link_ids == ()
        assert not told.vehicle().in_conflict
        assert told.fleet.link_ids_waiting("A") == (2,)

    def test_an_address_from_which_nothing_is_admitted_waits_before_its_serial(self) -> None:
        told = opens(story(A_HERE), 1, THERE)
        assert told.fleet.links[1].is_waiting
        assert told.fleet.links[1].waiting_serial is None

    def test_a_serial_without_address_is_admitted_from_anywhere(self) -> None:
        told = opens(story(AllowedApp("A")), 1, THERE).receives(1, extended("A"))
        assert told.vehicle().link_id == 1

    def test_a_network_admits_any_serial_but_one_that_is_bound_elsewhere(self) -> None:
        listed = story(A_HERE, AllowedApp(None, ip_network("10.0.0.0/24")))
        told = opens(listed, 1, THERE).receives(1, extended("B"))
        opens(told, 2, THERE).receives(2, extended("A"))
        assert set(told.fleet.vehicles) == {"B"}
        assert told.fleet.links[2].waiting_serial == "A"

    def test_an_identified_link_that_reports_an_unlisted_serial_leaves_its_vehicle(self) -> None:
        told = opens(story(A_HERE), 1, HERE).receives(1, core(), extended("A"), extended("B"))
        assert told.vehicle().link_id is None
        assert told.fleet.links[1].waiting_serial == "B"
        assert not told.fleet.links[1].own_state.position.is_known()

    def test_an_empty_list_admits_nothing(self) -> None:
        told = opens(story(), 1, HERE).receives(1, extended("A"))
        assert told.fleet.vehicles == {}

    @pytest.mark.parametrize(
        ("remote", "shown"),
        [
            ("10.0.0.5:1", "10.0.0.5"),
            ("[fe80::1%eth0]:1", "fe80::1"),
            ("[::ffff:10.0.0.5]:1", "10.0.0.5"),
            ("virtual:1", "None"),
        ],
    )
    def test_addresses_of_sockets(self, remote: str, shown: str) -> None:
        assert str(address_of(remote)) == shown

    def test_hosts_and_networks_are_shown_as_written(self) -> None:
        assert host_of("[fe80::1]:5") == "fe80::1"
        assert network_text(ip_network("10.0.0.5/32")) == "10.0.0.5"
        assert network_text(ip_network("10.0.0.0/24")) == "10.0.0.0/24"

    def test_an_unknown_address_is_in_no_network(self) -> None:
        assert not A_HERE.takes_address(None)
        assert AllowedApp("A").takes_address(None)


class TestAdmitting:
    def waiting(self) -> Story:
        return opens(story(A_HERE), 1, THERE).receives(1, core(height_m=12.0), extended("B"))

    def test_for_good_with_its_address(self) -> None:
        told = self.waiting().happens(AppAdmitted(1, "B", "anna"))
        assert told.fleet.vehicles["B"].link_id == 1
        assert told.fleet.vehicles["B"].height_above_takeoff_m.value == 12.0
        assert told.fleet.admission.listed == (
            A_HERE,
            AllowedApp("B", ip_network("10.0.0.9/32")),
        )
        opens(told, 2, HERE).receives(2, extended("B"))
        assert told.fleet.links[2].waiting_serial == "B"

    def test_for_good_from_any_address_replaces_the_serials_entries(self) -> None:
        told = opens(story(A_HERE), 1, THERE).receives(1, extended("A"))
        told.happens(AppAdmitted(1, "A", "anna", any_address=True))
        assert told.fleet.admission.listed == (AllowedApp("A"),)
        assert told.vehicle().link_id == 1

    def test_for_this_run_leaves_the_list_alone(self) -> None:
        told = self.waiting().happens(AppAdmitted(1, "B", "anna", is_for_good=False))
        assert told.fleet.admission.listed == (A_HERE,)
        assert told.fleet.vehicles["B"].link_id == 1

    def test_another_serial_than_the_person_saw_is_refused(self) -> None:
        told = self.waiting()
        event = AppAdmitted(1, "C", "anna")
        refusal = refusal_to_admit(told.fleet, event)
        assert refusal is not None
        assert "reports serial B" in refusal.reason
        assert told.happens(event).fleet.vehicles == {}

    def test_without_a_serial_or_without_a_waiting_link_it_is_refused(self) -> None:
        told = opens(story(A_HERE), 1, THERE)
        silent = refusal_to_admit(told.fleet, AppAdmitted(1, "B", "anna"))
        assert silent is not None
        assert "not reported a serial" in silent.reason
        gone = refusal_to_admit(told.fleet, AppAdmitted(7, "B", "anna"))
        assert gone is not None
        assert "does not wait" in gone.reason

    def test_a_full_list_takes_no_more(self) -> None:
        full = tuple(AllowedApp(f"S{number}") for number in range(MAX_ENTRIES))
        told = opens(story(*full), 1, THERE).receives(1, extended("B"))
        refusal = refusal_to_admit(told.fleet, AppAdmitted(1, "B", "anna"))
        assert refusal is not None
        assert "limit" in refusal.reason

    def test_without_an_ip_address_only_the_serial_can_be_admitted(self) -> None:
        told = opens(story(A_HERE), 1, "virtual:1").receives(1, extended("B"))
        assert refusal_to_admit(told.fleet, AppAdmitted(1, "B", "anna")) is not None
        told.happens(AppAdmitted(1, "B", "anna", any_address=True))
        assert told.fleet.vehicles["B"].link_id == 1


class TestRefusing:
    def refused(self) -> Story:
        told = opens(story(A_HERE), 1, THERE).receives(1, extended("B"))
        return told.happens(AppRefused(1, "anna"))

    def test_it_is_closed(self) -> None:
        assert [closed.link_id for closed in self.refused().closing] == [1]

    def test_it_is_closed_again_while_the_refusal_lasts(self) -> None:
        told = self.refused().happens(LinkClosed(1, "refused"))
        told.closing.clear()
        opens(told.at(10.0), 2, THERE).receives(2, extended("B")).happens(Tick())
        assert [closed.link_id for closed in told.closing] == [2]

    def test_another_serial_of_that_host_is_not(self) -> None:
        told = self.refused().happens(LinkClosed(1, "refused"))
        told.closing.clear()
        opens(told.at(10.0), 2, THERE).receives(2, extended("C")).happens(Tick())
        assert told.closing == []

    def test_without_a_serial_it_has_time_to_report_one(self) -> None:
        told = opens(story(A_HERE), 1, THERE).happens(AppRefused(1, "anna"))
        told.happens(LinkClosed(1, "refused")).closing.clear()
        opens(told.at(10.0), 2, THERE).happens(Tick())
        assert told.closing == []
        told.at(12.0).happens(Tick())
        assert [closed.link_id for closed in told.closing] == [2]

    def test_a_refusal_ends(self) -> None:
        told = self.refused().happens(LinkClosed(1, "refused"))
        told.closing.clear()
        opens(told.at(301.0), 2, THERE).receives(2, extended("B")).happens(Tick())
        assert told.closing == []
        assert told.fleet.admission.refused_until_ns == {}

    def test_refusals_kept_are_bounded(self) -> None:
        told = story(A_HERE, settings=FleetSettings(refusals_kept=2))
        for number in range(1, 6):
            opens(told, number, f"10.0.1.{number}:1").receives(number, extended(f"S{number}"))
            told.happens(AppRefused(number, "anna"))
        assert list(told.fleet.admission.refused_until_ns) == [
            ("10.0.1.4", "S4"),
            ("10.0.1.5", "S5"),
        ]

    def test_only_a_waiting_app_is_refused(self) -> None:
        told = opens(story(A_HERE), 1, HERE).receives(1, extended("A"))
        assert refusal_to_refuse(told.fleet, AppRefused(1, "anna")) is not None
        assert told.happens(AppRefused(1, "anna")).closing == []


class TestManyWaitingApps:
    def test_beyond_the_limit_the_newest_that_does_not_fly_is_closed(self) -> None:
        told = story(A_HERE, settings=FleetSettings(waiting_links_kept=2))
        for number in (1, 2):
            opens(told, number, THERE).receives(number, extended(f"S{number}"))
        opens(told, 3, THERE).receives(3, core(), extended("S3")).happens(Tick())
        assert [closed.link_id for closed in told.closing] == [2]

    def test_ticks_change_nothing_without_a_list(self) -> None:
        told = opens(Story(), 1, THERE)
        before = told.fleet
        assert told.happens(Tick()).fleet is before


def test_times_are_of_the_station() -> None:
    told = opens(story(A_HERE).at(3.0), 1, THERE).at(5.0).receives(1, extended("B"))
    assert told.fleet.links[1].waits_since_ns == 3 * S
    assert replace(told.fleet.links[1], closed_at_ns=0).is_waiting is False
