"""An app that the list does not admit: watched as traffic, stopped, and never moved."""

from dataclasses import replace
from ipaddress import ip_network

from tests.fleet.reports import PLACE, core, extended
from tests.safety.cases import STICK, mission
from tests.station.commanded import CommandedStation

from recon.fleet.admission import Admission, AllowedApp
from recon.model.command import Hover, LandNow
from recon.model.event import (
    AppAdmitted,
    AppListFailed,
    AppRefused,
    Event,
    HazardDismissed,
    LinkOpened,
)
from recon.model.geo import LatLon
from recon.model.vehicle import FlightMode
from recon.record.audit.audit import AuditEntry
from recon.station.alarms import app_conditions
from recon.station.audit.entries import Auditing, audit
from recon.station.traffic.known_traffic import in_the_air

A_IS_AT_ONE = AllowedApp("A", ip_network("10.0.0.1/32"))
HOVERING = (core(), extended(mode=FlightMode.GPS_ATTI))
FAR = LatLon(PLACE.latitude_deg + 0.002, PLACE.longitude_deg)


def listed(*entries: AllowedApp) -> CommandedStation:
    scene = CommandedStation()
    fleet = replace(scene.station.fleet, admission=Admission(entries))
    scene.station = replace(scene.station, fleet=fleet)
    return scene


def hovering() -> CommandedStation:
    """A is admitted, connected and hovers."""
    scene = listed(A_IS_AT_ONE).opens(1, *HOVERING).keeps_receiving(1, *HOVERING)
    return scene.passes(0.5)


def audited(scene: CommandedStation, event: Event) -> tuple[AuditEntry, ...]:
    before = scene.station
    scene.happens(event)
    return audit(Auditing(), before, event, scene.station, scene.now_ns)[1]


def alarm_text(scene: CommandedStation, rule: str) -> str:
    alarms = scene.station.alarms.alarms.values()
    return next(a.condition.text for a in alarms if a.condition.rule == rule and a.is_active)


class TestAnUnlistedApp:
    def test_it_is_traffic_and_an_alarm(self) -> None:
        other = (core(position=FAR), extended("X"))
        scene = hovering().opens(2, *other).keeps_receiving(2, *other).passes(0.5)
        assert [state.link_id for state, _ in in_the_air(scene.station)] == [1, 2]
        assert scene.station.fleet.vehicles.keys() == {"A"}
        text = alarm_text(scene, "app_waits")
        assert "app from 10.0.0.2 with serial X, in flight" in text
        assert "not on the list" in text

    def test_it_holds_back_what_would_come_near_it(self) -> None:
        near = LatLon(PLACE.latitude_deg + 0.0002, PLACE.longitude_deg)
        other = (core(position=near), extended("X"))
        scene = hovering().opens(2, *other).keeps_receiving(2, *other).passes(0.5)
        assert scene.refusal_rule(scene.order(mission())) == "separation"

    def test_stops_by_its_link_are_sent_and_motion_is_refused(self) -> None:
        other = (core(position=FAR), extended("X"))
        scene = hovering().opens(2, *other).keeps_receiving(2, *other).passes(0.5)
        for body in (Hover(), LandNow()):
            assert scene.times_s(scene.order(body, None, link=2))
        assert scene.refusal_rule(scene.order(STICK, None, link=2)) == "identified"

    def test_an_order_to_its_serial_states_what_to_do(self) -> None:
        scene = hovering().opens(2, core(position=FAR), extended("X")).passes(0.1)
        order = scene.order(LandNow(), "X")
        assert scene.refusal_rule(order) == "reachable"
        assert "waits to be admitted (link 2)" in scene.record(order).note

    def test_when_it_is_lost_in_flight_a_hazard_stays(self) -> None:
        scene = hovering().opens(2, core(position=FAR), extended("X")).passes(0.1).closes(2)
        assert list(scene.station.watchdog_state.lost) == ["link-2"]


class TestAListedSerialFromElsewhere:
    def elsewhere(self) -> CommandedStation:
        """A second app reports serial A, from an address that is not its own."""
        scene = hovering().opens(2, *HOVERING).keeps_receiving(2, *HOVERING)
        return scene.passes(0.5)

    def test_the_vehicle_stays_commandable(self) -> None:
        scene = self.elsewhere()
        assert scene.refusal_rule(scene.order(mission())) is None
        assert {link for _, link, _ in scene.sent} == {1}

    def test_it_is_an_alarm_that_names_the_expected_address(self) -> None:
        text = alarm_text(self.elsewhere(), "app_waits")
        assert "serial A" in text
        assert "expected from 10.0.0.1" in text

    def test_a_stop_goes_to_both(self) -> None:
        scene = self.elsewhere()
        order = scene.order(Hover())
        assert {link for _, link, number in scene.sent if number == order} == {1, 2}

    def test_a_stop_reaches_it_when_the_other_connection_is_gone(self) -> None:
        scene = self.elsewhere().closes(1).passes(0.5)
        order = scene.order(Hover())
        assert {link for _, link, number in scene.sent if number == order} == {2}
        moved = scene.order(mission())
        assert scene.refusal_rule(moved) == "reachable"
        assert "admit it first" in scene.record(moved).note

    def test_admitted_for_this_run_it_is_the_vehicle_again(self) -> None:
        scene = self.elsewhere().closes(1).passes(0.5)
        scene.happens(AppAdmitted(2, "A", "anna", is_for_good=False)).passes(0.5)
        assert scene.station.fleet.vehicles["A"].link_id == 2
        assert scene.refusal_rule(scene.order(mission())) is None
        assert "app_waits" not in scene.alarms()


class TestRefusing:
    def test_what_it_reported_in_flight_stays_one_hazard_until_it_is_dismissed(self) -> None:
        other = (core(position=FAR), extended("X"))
        scene = hovering().opens(2, *other).happens(AppRefused(2, "anna"))
        assert list(scene.station.watchdog_state.lost) == ["link-2"]
        scene.closes(2).happens(HazardDismissed("link-2", "anna"))
        for link_id in range(3, 30):
            scene.happens(LinkOpened(link_id, "10.0.0.2:7"))
            scene.receives(link_id, *other).passes(0.1).closes(link_id)
        assert scene.station.watchdog_state.lost == {}

    def test_refusing_an_app_that_does_not_wait_changes_nothing(self) -> None:
        scene = hovering()
        before = scene.station
        assert scene.happens(AppRefused(1, "anna")).station.fleet == before.fleet


class TestAlarms:
    def test_many_hosts_share_one_alarm(self) -> None:
        scene = hovering()
        for link_id in range(2, 2 + app_conditions.MAX_HOSTS + 3):
            scene.opens(link_id, extended(f"X{link_id}"))
        scene.passes(0.1)
        waiting = [
            a.condition
            for a in scene.station.alarms.alarms.values()
            if a.condition.rule == "app_waits"
        ]
        assert len(waiting) == app_conditions.MAX_HOSTS + 1
        assert "3 more hosts" in waiting[-1].text

    def test_several_apps_of_one_host_are_one_alarm(self) -> None:
        scene = hovering()
        for link_id in (2, 3):
            scene.happens(LinkOpened(link_id, "10.0.0.9:7")).receives(link_id, extended("X"))
        assert "(link 2 and 1 more)" in alarm_text(scene.passes(0.1), "app_waits")

    def test_without_a_serial_it_has_a_moment_to_report_one(self) -> None:
        scene = hovering().opens(2).passes(1.0)
        assert "app_waits" not in scene.alarms()
        assert "app_waits" in scene.passes(2.0).alarms()

    def test_a_list_that_cannot_be_written_is_one_until_it_can(self) -> None:
        scene = hovering().happens(AppListFailed("disk full")).passes(0.1)
        assert "this run only" in alarm_text(scene, "app_list")
        assert "app_list" not in scene.happens(AppListFailed(None)).passes(0.1).alarms()


def test_the_audit_names_the_person_and_what_was_decided() -> None:
    scene = hovering()
    events = [
        (LinkOpened(2, "10.0.0.2:7"), "link.opened"),
        (AppAdmitted(2, "X", "anna"), "app.not_changed"),
    ]
    for event, kind in events:
        (entry,) = audited(scene, event)
        assert entry.kind == kind
    scene.receives(2, extended("X"))
    kinds = [e.kind for e in audited(scene, AppAdmitted(2, "X", "anna", any_address=True))]
    assert kinds == ["app.admitted", "link.identified"]
    scene.happens(LinkOpened(3, "10.0.0.3:7")).receives(3, extended("Y"))
    (entry,) = audited(scene, AppRefused(3, "bob"))
    assert (entry.kind, entry.by, entry.serial) == ("app.refused", "bob", "Y")
    (entry,) = audited(scene, AppListFailed("disk full"))
    assert entry.text == "disk full"
