"""A start after the station ended in flight: what was known is known again, nothing is ordered."""

import json
from collections.abc import Iterable
from dataclasses import replace
from typing import Any

import msgspec
import pytest
from hypothesis import given
from hypothesis import strategies as st
from tests.fleet.said import PLACE, core, extended
from tests.station.audited import UTC_NS, Audited
from tests.station.commanded import CommandedStation
from tests.station.station_world import World, from_the_ground, square_mission, world

from recon.model.authority import AuthorityHolder, ControlAuthority
from recon.model.command import FlyMission, Hover, LandNow, Phase
from recon.model.event import AuthorityTaken, Event, HazardDismissed, OperatorOrder
from recon.model.units import NS_PER_S
from recon.record.audit import AuditEntry, AuditLine, Stamped, decode_line, encode_line
from recon.sim.fleet import Airborne
from recon.station.api_views.hazard_view import hazard_view
from recon.station.audit.entries import Auditing, audit
from recon.station.audit.unidentified_snapshots import UNIDENTIFIED_KIND
from recon.station.audit.vehicle_snapshots import sighting_of
from recon.station.recovery.last_run import (
    LARGEST_ID,
    MOST_NAMELESS,
    MOST_ORDERS,
    MOST_VEHICLES,
    LastRun,
)
from recon.station.recovery.restart import INTERRUPTED, first_ids, restart_entries, restored
from recon.station.state.station import Station
from recon.station.traffic.known_traffic import LOST_KEPT

HOUR_NS = 3_600 * NS_PER_S


def last_run(lines: Iterable[AuditLine]) -> LastRun:
    last = LastRun()
    for line in lines:
        last.take(line)
    return last


def restart(here: World, audited: Audited) -> Station:
    """The station as it is when another run begins now; the old one's links are gone."""
    old = here.driver.station
    fresh = replace(Station(settings=old.settings), airspace=old.airspace)
    fresh = replace(fresh, fleet=replace(fresh.fleet, profiles=old.fleet.profiles))
    return restored(fresh, last_run(audited.lines()), here.driver.now_ns)


def restart_world(here: World, audited: Audited, gone_s: float = 2.0) -> None:
    """End the station without a word, start another one, and let the apps come back.

    The driver's log then holds the new run's events alone.
    """
    apps = [connected.app for connected in here.connected.values()]
    for connected in tuple(here.connected.values()):
        here.driver.disconnect(connected.link_id)
        connected.app.disconnected()
    here.run_for(gone_s)
    here.driver.station = restart(here, audited)
    here.driver.log.clear()
    for app in apps:
        here.connect(app)


@pytest.fixture
def flown() -> tuple[World, Audited]:
    """Two vehicles, one of which has taken off with a mission, thirty seconds ago."""
    here = world(2, airborne=Airborne.NONE)
    audited = Audited(here)
    here.run_for(3.0)
    mission = from_the_ground(here.vehicle("SIM-1"), square_mission())
    here.order("SIM-1", FlyMission(mission), takeoff=True)
    here.run_for(30.0)
    return here, audited


class TestNumbers:
    def test_no_number_is_used_twice(self, flown: tuple[World, Audited]) -> None:
        here, audited = flown
        for _ in range(5):
            here.order("SIM-1", Hover())
        last = last_run(audited.lines())
        assert last.last_id == 6
        first, own = first_ids(last)
        assert first == 2001
        assert own < here.driver.station.next_own_id

    def test_without_a_last_run_they_begin_at_one(self) -> None:
        assert first_ids(LastRun()) == (1, -1)

    @given(st.integers(1, LARGEST_ID))
    def test_they_go_on_beyond_any_number(self, last_id: int) -> None:
        first, _ = first_ids(LastRun(last_id=last_id))
        assert first > last_id + 1_000 - 1


class TestAuthority:
    @pytest.mark.parametrize(
        ("before", "after"),
        [
            (AuthorityHolder.PILOT, AuthorityHolder.PILOT),
            (AuthorityHolder.OPERATOR, AuthorityHolder.OPERATOR),
            (AuthorityHolder.GUIDANCE, AuthorityHolder.OPERATOR),
        ],
    )
    def test_a_pilot_stays_and_guidance_does_not(
        self, flown: tuple[World, Audited], before: AuthorityHolder, after: AuthorityHolder
    ) -> None:
        here, audited = flown
        authorities = {"SIM-1": ControlAuthority(before, "somebody", 1, "said so")}
        here.driver.station = replace(here.driver.station, authorities=authorities)
        here.run_for(6.0)
        authority = restart(here, audited).authorities["SIM-1"]
        assert authority.holder is after
        assert "restarted" in authority.reason


class TestVehicles:
    def test_what_flew_is_lost_until_it_is_heard(self, flown: tuple[World, Audited]) -> None:
        here, audited = flown
        here.run_for(6.0)
        station = restart(here, audited)
        assert set(station.fleet.vehicles) == {"SIM-1"}
        hazard = station.fleet.vehicles["SIM-1"]
        assert hazard.link_id is None
        assert hazard.is_flying.value is True
        assert hazard.position.value is not None
        assert hazard.takeoff_point == here.vehicle("SIM-1").takeoff_point
        age_s = hazard.position.age_s(here.driver.now_ns)
        assert age_s is not None
        assert 0.0 <= age_s <= 5.5

    def test_it_is_readopted_with_its_home(self, flown: tuple[World, Audited]) -> None:
        here, audited = flown
        home = here.vehicle("SIM-1").takeoff_point
        restart_world(here, audited)
        here.run_for(3.0)
        vehicle = here.vehicle("SIM-1")
        assert vehicle.link_id is not None
        assert vehicle.takeoff_point == home is not None
        assert here.driver.station.restored_flights == {}
        assert not [e for e in audited.of("alarm.raised") if e.details["rule"] == "restarted"]

    def test_nothing_is_ordered(self, flown: tuple[World, Audited]) -> None:
        here, audited = flown
        restart_world(here, audited)
        here.run_for(20.0)
        names = {type(event).__name__ for event in here.driver.log}
        assert "PacketReceived" in names
        assert not names & {"CommandSent", "CommandDropped", "CommandAnswered"}

    def test_a_hold_works_afterwards(self, flown: tuple[World, Audited]) -> None:
        here, audited = flown
        restart_world(here, audited)
        here.run_for(3.0)
        here.driver.handle(OperatorOrder(1001, Hover(), "test", serial="SIM-1"))
        here.run_for(10.0)
        assert here.record(1001).phase is Phase.DONE

    def test_one_that_landed_meanwhile_is_on_the_ground(self, flown: tuple[World, Audited]) -> None:
        here, audited = flown
        here.order("SIM-1", LandNow())
        here.run_for(1.0)
        restart_world(here, audited, gone_s=90.0)
        here.run_for(3.0)
        assert here.vehicle("SIM-1").is_flying.value is False
        assert here.vehicle("SIM-1").takeoff_point is None

    def test_a_dismissed_one_does_not_come_back(self, flown: tuple[World, Audited]) -> None:
        here, audited = flown
        here.driver.handle(HazardDismissed("SIM-1", "Ms Smith"))
        assert restart(here, audited).fleet.vehicles == {}

    def test_after_an_hour_and_a_half_nothing_flies_any_more(
        self, flown: tuple[World, Audited]
    ) -> None:
        here, audited = flown
        later = here.driver.now_ns + 2 * HOUR_NS
        station = restored(Station(), last_run(audited.lines()), later)
        assert station.fleet.vehicles == {}
        assert station.authorities == {}

    def test_a_clock_that_went_back_restores_no_flight(self, flown: tuple[World, Audited]) -> None:
        _, audited = flown
        station = restored(Station(), last_run(audited.lines()), 0)
        assert station.fleet.vehicles == {}

    def test_a_second_crash_before_anything_is_heard_loses_nothing(
        self, flown: tuple[World, Audited]
    ) -> None:
        here, audited = flown
        here.driver.handle(AuthorityTaken("SIM-1", AuthorityHolder.PILOT, "p"))
        first = restart(here, audited)
        lines = [
            decode_line(encode_line(Stamped(n, UTC_NS, here.driver.now_ns, entry), "0" * 64))
            for n, entry in enumerate(restart_entries(first), start=1)
        ]
        second = restored(Station(), last_run(lines), here.driver.now_ns)
        (once,), (twice,) = first.restored_flights.values(), second.restored_flights.values()
        assert (twice.heard_ns, twice.place, twice.home) == (once.heard_ns, once.place, once.home)
        assert second.fleet.vehicles["SIM-1"].takeoff_point is not None
        assert second.authorities["SIM-1"].holder is AuthorityHolder.PILOT


class TestAnotherFlight:
    """A home is believed only while telemetry agrees that it is the same flight."""

    def heard_after(self, flown: tuple[World, Audited], **changes: Any) -> Station:
        here, audited = flown
        lines = audited.lines()
        sightings = [n for n, line in enumerate(lines) if line.kind.startswith("vehicle.")]
        for number in sightings:
            line = lines[number]
            if line.serial == "SIM-1":
                details = {**line.details, **changes}
                entry = AuditEntry(line.kind, line.text, "x", line.serial, "", details)
                stamped = Stamped(line.n, UTC_NS, line.t_ns, entry)
                lines[number] = decode_line(encode_line(stamped, "0" * 64))
        audited.entries.clear()
        apps = [connected.app for connected in here.connected.values()]
        for connected in tuple(here.connected.values()):
            here.driver.disconnect(connected.link_id)
        here.run_for(1.0)
        here.driver.station = restored(Station(), last_run(lines), here.driver.now_ns)
        for app in apps:
            here.connect(app)
        here.run_for(3.0)
        return here.driver.station

    def test_the_same_values_are_the_same_flight(self, flown: tuple[World, Audited]) -> None:
        station = self.heard_after(flown)
        assert station.fleet.vehicles["SIM-1"].takeoff_point is not None

    @pytest.mark.parametrize(
        ("changes", "says"),
        [
            ({"battery_fraction": 0.5}, "battery was changed"),
            ({"battery_fraction": None}, "battery is unknown"),
            ({"altitude_offset_m": 0.0}, "another takeoff point"),
            ({"height_above_takeoff_m": 400.0}, "it is at"),
            ({"height_above_takeoff_m": None}, "height is unknown"),
            ({"place": {"latitude_deg": 41.95, "longitude_deg": -93.6}}, "m from where"),
            ({"place": None}, "place is unknown"),
        ],
    )
    def test_what_does_not_agree_forgets_the_home_and_says_so(
        self, flown: tuple[World, Audited], changes: dict[str, Any], says: str
    ) -> None:
        station = self.heard_after(flown, **changes)
        vehicle = station.fleet.vehicles["SIM-1"]
        assert vehicle.link_id is not None
        assert vehicle.takeoff_point is None
        (alarm,) = [
            a.condition
            for a in station.alarms.alarms.values()
            if a.condition.rule == "restarted" and "takeoff point" in a.condition.text
        ]
        assert says in alarm.text
        assert alarm.text.startswith("SIM-1")


class TestOrders:
    def test_what_was_under_way_is_shown_as_failed(self, flown: tuple[World, Audited]) -> None:
        here, audited = flown
        number = here.order("SIM-1", LandNow())
        station = restart(here, audited)
        record = station.orders.records[number]
        assert record.phase is Phase.FAILED
        assert record.note == INTERRUPTED
        assert record.command.issued_by == "test"
        assert not record.is_tracked
        (alarm,) = station.alarms.alarms.values()
        assert INTERRUPTED in alarm.condition.text

    def test_what_had_ended_is_left_alone(self, flown: tuple[World, Audited]) -> None:
        here, audited = flown
        number = here.order("SIM-1", Hover())
        here.run_for(15.0)
        assert here.record(number).phase is Phase.DONE
        assert number not in restart(here, audited).orders.records

    def test_a_second_restart_does_not_tell_them_again(self, flown: tuple[World, Audited]) -> None:
        here, audited = flown
        here.order("SIM-1", LandNow())
        last = last_run(audited.lines())
        first = restored(Station(), last, here.driver.now_ns)
        for n, entry in enumerate(restart_entries(first), start=1):
            stamped = Stamped(n, UTC_NS, here.driver.now_ns, entry)
            last.take(decode_line(encode_line(stamped, "0" * 64)))
        assert last.orders == {}


def line(kind: str, details: Any, serial: str | None = "A", n: int = 1) -> AuditLine:
    entry = AuditEntry(kind, "x", "y", serial, "Z", details)
    return decode_line(encode_line(Stamped(n, UTC_NS, n, entry), "0" * 64))


KINDS = st.sampled_from(
    [
        "order.queued",
        "order.sent",
        "vehicle.seen",
        "vehicle.took_off",
        "vehicle.unidentified",
        "vehicle.unidentified_gone",
        "authority.taken",
        "sticks.began",
        "fleet_return.ordered",
        "hazard.dismissed",
        "station.started",
        "?",
    ]
)
KEYS = st.sampled_from(
    [
        "id",
        "name",
        "phase",
        "order",
        "body",
        "takeoff",
        "holder",
        "holder_name",
        "heard_ns",
        "place",
        "home",
        "is_flying",
        "battery_fraction",
        "first_id",
        "count",
        "last_command_id",
        "next_own_id",
    ]
)
VALUES = st.one_of(
    st.none(),
    st.booleans(),
    st.integers(-(2**62), 2**62),
    st.floats(allow_nan=False, allow_infinity=False),
    st.sampled_from(["mission", "hover", "queued", "sent", "pilot", ""]),
    st.dictionaries(st.sampled_from(["latitude_deg", "mission", "waypoints"]), st.integers()),
)


class TestHostile:
    @given(st.lists(st.tuples(KINDS, st.dictionaries(KEYS, VALUES)), max_size=12))
    def test_nothing_made_up_breaks_a_start_or_orders_anything(
        self, made_up: list[tuple[str, dict[str, Any]]]
    ) -> None:
        last = last_run(line(kind, details, n=n) for n, (kind, details) in enumerate(made_up))
        station = restored(Station(), last, UTC_NS)
        assert all(not record.is_tracked for record in station.orders.records.values())
        assert station.sticks == {}
        assert station.next_own_id < 0
        assert first_ids(last)[0] >= 1
        json.dumps([entry.text for entry in restart_entries(station)])

    def test_a_million_vehicles_and_orders_take_no_more_than_the_limits(self) -> None:
        last = LastRun()
        for n in range(MOST_VEHICLES + 50):
            last.take(line("authority.taken", {"holder": "pilot"}, serial=f"S{n}"))
        order = {"phase": "queued", "order": "hover", "body": {}}
        for n in range(MOST_ORDERS + 50):
            last.take(line("order.queued", {"id": n, **order}))
        assert len(last.authorities) == MOST_VEHICLES
        assert len(last.orders) == MOST_ORDERS

    def test_numbers_beyond_what_the_console_can_count_are_left_out(self) -> None:
        last = LastRun()
        last.take(line("order.queued", {"id": LARGEST_ID + 1, "phase": "queued"}))
        assert last.last_id == 0

    @pytest.mark.parametrize("latitude", [91.0, -91.0, 1e300])
    def test_places_off_the_globe_are_left_out(
        self, flown: tuple[World, Audited], latitude: float
    ) -> None:
        _, audited = flown
        last = last_run(audited.lines())
        details = {
            **next(e for e in audited.of("vehicle.seen") if e.serial == "SIM-1").details,
            "place": {"latitude_deg": latitude, "longitude_deg": 0.0},
        }
        place_before = last.sightings["SIM-1"].place
        last.take(line("vehicle.seen", details, serial="SIM-1"))
        assert last.sightings["SIM-1"].place == place_before


def heard_again(
    scene: CommandedStation, lines: list[AuditLine], after_s: float
) -> CommandedStation:
    """A new run, that begins some seconds later with what the last one's audit tells."""
    now_ns = scene.now_ns + round(after_s * NS_PER_S)
    again = CommandedStation()
    again.now_ns = now_ns
    again.station = restored(again.station, last_run(lines), now_ns)
    return again


class Heard(CommandedStation):
    """What happens goes through the audit."""

    def __init__(self) -> None:
        super().__init__()
        self.memory = Auditing()
        self.entries: list[tuple[int, AuditEntry]] = []

    def happens(self, event: Event) -> CommandedStation:
        before = self.station
        super().happens(event)
        self.memory, entries = audit(self.memory, before, event, self.station, self.now_ns)
        self.entries += [(self.now_ns, entry) for entry in entries]
        return self

    def lines(self) -> list[AuditLine]:
        return as_lines(self.entries)


def as_lines(entries: Iterable[tuple[int, AuditEntry]]) -> list[AuditLine]:
    return [
        decode_line(encode_line(Stamped(n, UTC_NS, at_ns, entry), "0" * 64))
        for n, (at_ns, entry) in enumerate(entries, start=1)
    ]


class TestWithoutASerial:
    """What flew and never said who it is stays in the air over a restart."""

    def flew(self, seconds: float = 4.0) -> Heard:
        scene = Heard()
        scene.opens(7, core(), extended(None))
        scene.keeps_saying(7, core(), extended(None)).passes(seconds)
        return scene

    def test_it_is_a_ghost_and_an_alarm_again_under_a_name_of_its_own(self) -> None:
        scene = self.flew()
        again = heard_again(scene, scene.lines(), 60.0).passes(0.2)
        (state,) = again.station.watchdog_state.lost.values()
        assert [*again.station.watchdog_state.lost] == ["lost-1"]
        assert state.position.value == PLACE
        assert again.alarms() == {"unidentified_lost"}
        view = hazard_view(again.station, state, again.now_ns)
        assert view is not None
        assert (view.dismissed_as, view.radius_m) == ("lost-1", 124.2)
        again.happens(HazardDismissed("lost-1", "Ann")).passes(0.2)
        assert again.alarms() == set()
        assert again.station.watchdog_state.lost == {}

    def test_one_whose_link_had_ended_is_too_at_once(self) -> None:
        scene = Heard()
        scene.opens(7, core(), extended(None)).closes(7)
        assert [*heard_again(scene, scene.lines(), 5.0).station.watchdog_state.lost] == ["lost-1"]

    @pytest.mark.parametrize("name", ["link-7", "unidentified link 7"])
    def test_a_dismissed_one_does_not_come_back(self, name: str) -> None:
        scene = self.flew()
        scene.closes(7).passes(5.0).happens(HazardDismissed(name, "Ann"))
        assert heard_again(scene, scene.lines(), 5.0).station.watchdog_state.lost == {}

    def test_one_that_landed_or_said_its_serial_does_not_either(self) -> None:
        for last in (core(flying=False), extended("A")):
            scene = self.flew()
            scene.says(7, last).closes(7)
            assert heard_again(scene, scene.lines(), 5.0).station.watchdog_state.lost == {}

    def test_a_second_crash_before_anything_is_heard_loses_none(self) -> None:
        scene = self.flew()
        once = heard_again(scene, scene.lines(), 5.0)
        entries = [(once.now_ns, entry) for entry in restart_entries(once.station)]
        twice = heard_again(once, as_lines(entries), 5.0)
        assert [*twice.station.watchdog_state.lost] == ["lost-1"]
        (state,) = twice.station.watchdog_state.lost.values()
        assert state.core_received_at_ns == round(2.1 * NS_PER_S)

    def test_it_is_written_down_every_five_seconds_and_once_it_had_time_to_say_who_it_is(
        self,
    ) -> None:
        scene = self.flew(14.0)
        times_s = [at_ns / NS_PER_S for at_ns, e in scene.entries if e.kind == UNIDENTIFIED_KIND]
        assert [round(at_s) for at_s in times_s] == [2, 7, 12]
        assert not [e for _, e in self.flew(1.0).entries if e.kind == UNIDENTIFIED_KIND]

    def test_for_some_seconds_nobody_is_held_for_it(self) -> None:
        scene = self.flew()
        again = heard_again(scene, scene.lines(), 60.0)
        again.opens(1, core(), extended("A")).keeps_saying(1, core(), extended("A")).passes(9.8)
        assert again.alarms() == {"unidentified_lost"}
        again.passes(1.0)
        assert again.alarms() == {"unidentified_lost", "separation"}

    def test_too_many_to_tell_apart_are_one_that_is_everywhere(self) -> None:
        last = LastRun()
        flies = {**details_of_a_flight(), "heard_ns": NS_PER_S}
        for n in range(MOST_VEHICLES + 1):
            last.take(line("vehicle.seen", flies, serial=f"S{n}"))
        assert [*last.unidentified] == ["many-lost"]
        station = restored(Station(), last, NS_PER_S)
        assert [*station.watchdog_state.lost] == ["many-lost"]
        assert station.watchdog_state.lost["many-lost"].position.value is None

    def test_what_stands_on_the_ground_makes_room_for_what_flies(self) -> None:
        last = LastRun()
        stands = {**details_of_a_flight(), "is_flying": False}
        for n in range(MOST_VEHICLES + 10):
            last.take(line("vehicle.seen", stands, serial=f"S{n}"))
        last.take(line("vehicle.seen", details_of_a_flight(), serial="FLIES"))
        assert "FLIES" in last.sightings
        assert len(last.sightings) == MOST_VEHICLES
        assert last.unidentified == {}

    def test_a_made_up_million_takes_no_more_than_the_limit(self) -> None:
        last = LastRun()
        for n in range(MOST_NAMELESS + 50):
            last.take(
                line(UNIDENTIFIED_KIND, {**details_of_a_flight(), "name": f"n{n}"}, serial=None)
            )
        assert len(last.unidentified) == MOST_NAMELESS + 1
        station = restored(Station(), last, NS_PER_S)
        assert len(station.watchdog_state.lost) == LOST_KEPT + 1


def details_of_a_flight() -> dict[str, Any]:
    scene = CommandedStation().opens(1, core(), extended("A"))
    vehicle = scene.station.fleet.vehicles["A"]
    details: dict[str, Any] = msgspec.to_builtins(sighting_of(scene.station, vehicle))
    return details
