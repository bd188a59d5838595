"""A restart in flight: what was known is restored, and nothing is sent."""

import json
from collections.abc import Iterator
from dataclasses import replace
from typing import Any

import msgspec
import pytest
from hypothesis import given
from hypothesis import strategies as st
from tests.fleet.reports import PLACE, core, extended
from tests.station.audited import UTC_NS, Audited
from tests.station.commanded import CommandedStation
from tests.station.recovery.restarts import restart, restart_world, restored_from, saved
from tests.station.station_world import World, from_the_ground, square_mission, world

from recon.model.command import FlyMission, Hover, LandNow, Phase
from recon.model.control import AuthorityHolder, ControlAuthority
from recon.model.event import AuthorityTaken, HazardDismissed, OperatorOrder
from recon.model.report import CoreReport
from recon.model.units import NS_PER_S
from recon.sim.fleet import Airborne
from recon.station.api_views.vehicle_views import hazard_view
from recon.station.recovery.restart import INTERRUPTED, LastRun, restart_entries, restored
from recon.station.recovery.snapshot import (
    MAX_ID,
    MAX_ORDERS,
    MAX_UNIDENTIFIED,
    MAX_VEHICLES,
    AuthoritySnapshot,
    OrderSnapshot,
    RecoverySnapshot,
    decode_snapshot,
    encode_snapshot,
    take_snapshot,
    vehicle_snapshot,
)
from recon.station.state.station import Station
from recon.station.state.vehicle_control import VehicleSnapshot
from recon.station.traffic.known_traffic import LOST_KEPT

HOUR_NS = 3_600 * NS_PER_S


@pytest.fixture
def flown() -> World:
    """Two vehicles, one of which has taken off with a mission, thirty seconds ago."""
    here = world(2, airborne=Airborne.NONE)
    here.run_for(3.0)
    mission = from_the_ground(here.vehicle("SIM-1"), square_mission())
    here.order("SIM-1", FlyMission(mission), takeoff=True)
    here.run_for(30.0)
    return here


def snapshot_of(here: World) -> RecoverySnapshot:
    return saved(here.driver.station, here.driver.now_ns)


class TestIds:
    def test_no_id_is_used_twice(self, flown: World) -> None:
        for _ in range(5):
            flown.order("SIM-1", Hover())
        snapshot = snapshot_of(flown)
        assert snapshot.last_order_id == 6
        first, own = LastRun(snapshot).first_ids
        assert first == 2001
        flown.driver.station = replace(flown.driver.station, next_own_id=-7)
        own = LastRun(snapshot_of(flown)).first_ids[1]
        assert own < -7
        assert restart(flown).next_own_id == own

    def test_without_a_last_run_they_begin_at_one(self) -> None:
        assert LastRun().first_ids == (1, -1)
        assert LastRun(RecoverySnapshot(taken_at_ns=1)).first_ids == (1, -1)

    def test_a_run_without_orders_keeps_the_ids_of_the_runs_before(self) -> None:
        assert take_snapshot(Station(), 1, last_order_id=2_000).last_order_id == 2_000

    def test_without_a_readable_snapshot_no_id_of_the_runs_before_is_used(self) -> None:
        first, own = LastRun(None, ("damaged",), runs_before=3).first_ids
        assert (first, own) == (3_000_000_001, -3_000_000_001)
        assert restored(Station(), LastRun(None, (), 3), 1).next_own_id == own

    @given(st.integers(1, MAX_ID))
    def test_they_continue_above_any_id(self, last_id: int) -> None:
        first, _ = LastRun(RecoverySnapshot(taken_at_ns=1, last_order_id=last_id)).first_ids
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
    def test_a_pilot_keeps_it_and_guidance_does_not(
        self, flown: World, before: AuthorityHolder, after: AuthorityHolder
    ) -> None:
        held = ControlAuthority(before, "Ann", 1, "a reason")
        flown.driver.station = flown.driver.station.with_control("SIM-1", authority=held)
        flown.run_for(6.0)
        authority = restart(flown).control("SIM-1").authority
        assert authority.holder is after
        assert "restarted" in authority.reason

    def test_a_vehicle_on_the_ground_keeps_its_pilot(self, flown: World) -> None:
        flown.driver.handle(AuthorityTaken("SIM-2", AuthorityHolder.PILOT, "p"))
        authority = restart(flown).control("SIM-2").authority
        assert (authority.holder, authority.holder_name) == (AuthorityHolder.PILOT, "p")


class TestVehicles:
    def test_a_vehicle_in_flight_is_lost_until_its_telemetry_returns(self, flown: World) -> None:
        flown.run_for(6.0)
        station = restart(flown)
        assert set(station.fleet.vehicles) == {"SIM-1"}
        lost = station.fleet.vehicles["SIM-1"]
        assert lost.link_id is None
        assert lost.is_flying.value is True
        assert lost.position.value is not None
        assert lost.takeoff_point == flown.vehicle("SIM-1").takeoff_point
        age_s = lost.position.age_s(flown.driver.now_ns)
        assert age_s is not None
        assert 0.0 <= age_s <= 0.5

    def test_it_comes_back_with_its_takeoff_point(self, flown: World) -> None:
        home = flown.vehicle("SIM-1").takeoff_point
        audited = Audited(flown)
        restart_world(flown)
        flown.run_for(3.0)
        vehicle = flown.vehicle("SIM-1")
        assert vehicle.link_id is not None
        assert vehicle.takeoff_point == home is not None
        assert all(c.restored is None for c in flown.driver.station.controls.values())
        assert not [e for e in audited.of("alarm.raised") if e.details["rule"] == "restarted"]

    def test_nothing_is_sent(self, flown: World) -> None:
        restart_world(flown)
        flown.run_for(20.0)
        names = {type(event).__name__ for event in flown.driver.log}
        assert "PacketReceived" in names
        assert not names & {"CommandSent", "CommandDropped", "CommandAnswered"}

    def test_a_hold_works_afterwards(self, flown: World) -> None:
        restart_world(flown)
        flown.run_for(3.0)
        flown.driver.handle(OperatorOrder(1001, Hover(), "test", serial="SIM-1"))
        flown.run_for(10.0)
        assert flown.record(1001).phase is Phase.DONE

    def test_a_vehicle_that_landed_meanwhile_is_on_the_ground(self, flown: World) -> None:
        flown.order("SIM-1", LandNow())
        flown.run_for(1.0)
        restart_world(flown, gone_s=90.0)
        flown.run_for(3.0)
        assert flown.vehicle("SIM-1").is_flying.value is False
        assert flown.vehicle("SIM-1").takeoff_point is None

    def test_a_dismissed_vehicle_does_not_come_back(self, flown: World) -> None:
        for connected in tuple(flown.connected.values()):
            flown.driver.disconnect(connected.link_id)
        flown.connected.clear()
        flown.run_for(4.0)
        assert set(restart(flown).fleet.vehicles) == {"SIM-1"}
        flown.driver.handle(HazardDismissed("SIM-1", "Ms Smith"))
        assert restart(flown).fleet.vehicles == {}

    def test_after_an_hour_and_a_half_nothing_flies(self, flown: World) -> None:
        later = flown.driver.now_ns + 2 * HOUR_NS
        station = restored_from(snapshot_of(flown), later)
        assert station.fleet.vehicles == {}
        assert station.controls == {}

    def test_a_clock_that_was_set_back_restores_no_flight(self, flown: World) -> None:
        assert restored_from(snapshot_of(flown), 0).fleet.vehicles == {}

    def test_a_second_crash_before_any_telemetry_loses_nothing(self, flown: World) -> None:
        flown.driver.handle(AuthorityTaken("SIM-1", AuthorityHolder.PILOT, "p"))
        first = restart(flown)
        second = restored_from(saved(first, flown.driver.now_ns), flown.driver.now_ns)
        last = first.control("SIM-1").restored
        assert last is not None
        assert second.control("SIM-1").restored == last
        assert second.fleet.vehicles["SIM-1"].takeoff_point is not None
        assert second.control("SIM-1").authority.holder is AuthorityHolder.PILOT

    def test_the_audit_shows_what_was_restored(self, flown: World) -> None:
        flown.driver.handle(AuthorityTaken("SIM-1", AuthorityHolder.PILOT, "p"))
        flown.order("SIM-1", LandNow())
        entries = {entry.kind: entry for entry in restart_entries(restart(flown))}
        assert set(entries) == {"vehicle.restored", "authority.taken", "order.failed"}
        assert entries["vehicle.restored"].serial == "SIM-1"
        assert entries["authority.taken"].details["holder"] == "pilot"
        assert INTERRUPTED in entries["order.failed"].text


class TestAnotherFlight:
    """A takeoff point is kept only while telemetry agrees that it is the same flight."""

    def reconnected_after(self, here: World, **changes: Any) -> Station:
        values = msgspec.to_builtins(snapshot_of(here))
        values["vehicles"]["SIM-1"] |= changes
        apps = [connected.app for connected in here.connected.values()]
        for connected in tuple(here.connected.values()):
            here.driver.disconnect(connected.link_id)
        here.run_for(1.0)
        snapshot = decode_snapshot(msgspec.json.encode(values))
        here.driver.station = restored_from(snapshot, here.driver.now_ns)
        for app in apps:
            here.connect(app)
        here.run_for(3.0)
        return here.driver.station

    def test_the_same_values_are_the_same_flight(self, flown: World) -> None:
        station = self.reconnected_after(flown)
        assert station.fleet.vehicles["SIM-1"].takeoff_point is not None

    @pytest.mark.parametrize(
        ("changes", "reason"),
        [
            ({"battery_fraction": 0.5}, "battery replaced"),
            ({"battery_fraction": None}, "battery unknown"),
            ({"altitude_offset_m": 0.0}, "another takeoff point"),
            ({"height_above_takeoff_m": 400.0}, "height changed from 400 m"),
            ({"height_above_takeoff_m": None}, "height unknown"),
            ({"position": {"latitude_deg": 41.95, "longitude_deg": -93.6}}, "moved 5603 m"),
            ({"position": None}, "position unknown"),
        ],
    )
    def test_a_mismatch_drops_the_takeoff_point_with_an_alarm(
        self, flown: World, changes: dict[str, Any], reason: str
    ) -> None:
        station = self.reconnected_after(flown, **changes)
        vehicle = station.fleet.vehicles["SIM-1"]
        assert vehicle.link_id is not None
        assert vehicle.takeoff_point is None
        (alarm,) = [
            a.condition
            for a in station.alarms.alarms.values()
            if a.condition.rule == "restarted" and "takeoff point" in a.condition.text
        ]
        assert reason in alarm.text
        assert alarm.text.startswith("SIM-1")


class TestOrders:
    def test_an_open_order_is_shown_as_failed(self, flown: World) -> None:
        number = flown.order("SIM-1", LandNow())
        station = restart(flown)
        record = station.orders.records[number]
        assert record.phase is Phase.FAILED
        assert record.note == INTERRUPTED
        assert record.command.issued_by == "test"
        assert not record.is_tracked
        (alarm,) = station.alarms.alarms.values()
        assert INTERRUPTED in alarm.condition.text

    def test_a_mission_in_flight_keeps_its_waypoints(self, flown: World) -> None:
        record = restart(flown).orders.records[1]
        assert record.phase is Phase.FAILED
        assert record.command.body == flown.record(1).command.body

    def test_an_order_that_had_ended_is_left_alone(self, flown: World) -> None:
        number = flown.order("SIM-1", Hover())
        flown.run_for(15.0)
        assert flown.record(number).phase is Phase.DONE
        assert number not in restart(flown).orders.records

    def test_a_second_restart_does_not_report_them_again(self, flown: World) -> None:
        flown.order("SIM-1", LandNow())
        first = restart(flown)
        assert first.orders.records
        assert saved(first, flown.driver.now_ns).orders == []


class TestTroubles:
    def test_a_damaged_snapshot_is_one_alarm_with_what_to_do(self) -> None:
        last_run = LastRun(None, ("snapshot A not used: damaged", "snapshot B not used: damaged"))
        station = restored(Station(), last_run, 1)
        (alarm,) = station.alarms.alarms.values()
        assert alarm.condition.rule == "restarted"
        assert "snapshot A not used: damaged; snapshot B" in alarm.condition.text
        assert "Confirm with the pilots" in alarm.condition.text
        assert station.fleet.vehicles == {}

    def test_the_previous_snapshot_is_restored_with_the_alarm(self, flown: World) -> None:
        last_run = LastRun(snapshot_of(flown), ("current snapshot not used: damaged",))
        station = restored(Station(), last_run, flown.driver.now_ns)
        assert set(station.fleet.vehicles) == {"SIM-1"}
        assert any(
            "current snapshot" in alarm.condition.text for alarm in station.alarms.alarms.values()
        )


def order(number: int, **changes: Any) -> OrderSnapshot:
    values: dict[str, Any] = {
        "id": number,
        "order": "hover",
        "body": {},
        "phase": Phase.QUEUED,
        "issued_by": "y",
        "issued_at_ns": 1,
        "serial": "A",
        "vehicle_name": "Z",
        "takeoff": False,
    }
    return OrderSnapshot(**{**values, **changes})


def flight() -> VehicleSnapshot:
    scene = CommandedStation().opens(1, core(), extended("A"))
    return vehicle_snapshot(scene.station.fleet.vehicles["A"])


WHOLE = RecoverySnapshot(
    taken_at_ns=UTC_NS,
    last_order_id=4,
    next_own_id=-5,
    authorities={"A": AuthoritySnapshot(AuthorityHolder.PILOT, "p")},
    vehicles={"A": flight()},
    unidentified={"link-7": flight()},
    orders=[order(3), order(4, order="mission", body={"mission": {"waypoints": []}})],
)
VALUES = st.one_of(
    st.none(),
    st.booleans(),
    st.integers(-(2**70), 2**70),
    st.floats(),
    st.sampled_from(["mission", "hover", "queued", "done", "pilot", "", "\x1b[2J"]),
    st.dictionaries(st.sampled_from(["latitude_deg", "mission", "waypoints"]), st.integers()),
    st.lists(st.integers(), max_size=3),
)


def paths(value: Any, path: tuple[Any, ...] = ()) -> Iterator[tuple[Any, ...]]:
    """Every place in a JSON value that a hostile file can replace."""
    if path:
        yield path
    if isinstance(value, dict | list):
        for key, item in value.items() if isinstance(value, dict) else enumerate(value):
            yield from paths(item, (*path, key))


PATHS = tuple(paths(msgspec.to_builtins(WHOLE)))


class TestHostile:
    @given(st.lists(st.tuples(st.sampled_from(PATHS), VALUES), min_size=1, max_size=4))
    def test_no_made_up_value_breaks_a_start_or_commands_anything(
        self, changes: list[tuple[tuple[Any, ...], Any]]
    ) -> None:
        values = msgspec.to_builtins(WHOLE)
        for path, value in changes:
            parent = values
            for key in path[:-1]:
                parent = parent[key] if _has(parent, key) else {}
            if isinstance(parent, dict) or _has(parent, path[-1]):
                parent[path[-1]] = value
        try:
            snapshot = decode_snapshot(msgspec.json.encode(values))
        except ValueError:
            return
        station = restored_from(snapshot, UTC_NS)
        assert all(not record.is_tracked for record in station.orders.records.values())
        assert station.neutral_pending == ()
        assert station.next_own_id < 0
        assert LastRun(snapshot).first_ids[0] >= 1
        json.dumps([entry.text for entry in restart_entries(station)])

    @pytest.mark.parametrize(
        ("field", "items"),
        [
            ("authorities", {f"S{n}": {"holder": "pilot"} for n in range(MAX_VEHICLES + 1)}),
            ("vehicles", dict.fromkeys((f"S{n}" for n in range(MAX_VEHICLES + 1)), flight())),
            ("unidentified", dict.fromkeys(map(str, range(MAX_UNIDENTIFIED + 1)), flight())),
            ("orders", [order(n) for n in range(MAX_ORDERS + 1)]),
        ],
    )
    def test_more_items_than_the_limit_are_rejected(self, field: str, items: Any) -> None:
        with pytest.raises(ValueError, match=field):
            decode_snapshot(msgspec.json.encode({"taken_at_ns": 1, field: items}))

    def test_ids_that_the_console_cannot_count_are_rejected(self) -> None:
        with pytest.raises(ValueError, match="last_order_id"):
            decode_snapshot(
                encode_snapshot(RecoverySnapshot(taken_at_ns=1, last_order_id=MAX_ID + 1))
            )

    @pytest.mark.parametrize("latitude", [91.0, -91.0, 1e300])
    def test_positions_off_the_globe_are_rejected(self, latitude: float) -> None:
        values = msgspec.to_builtins(WHOLE)
        values["vehicles"]["A"]["position"] = {"latitude_deg": latitude, "longitude_deg": 0.0}
        with pytest.raises(ValueError, match="latitude_deg"):
            decode_snapshot(msgspec.json.encode(values))

    @pytest.mark.parametrize("body", [{"mission": 1}, {}])
    def test_a_body_of_another_type_leaves_out_that_order_only(self, body: dict[str, Any]) -> None:
        orders = [order(1, order="mission", body=body), order(2, order="dance"), order(3)]
        snapshot = RecoverySnapshot(taken_at_ns=1, orders=orders)
        station = restored_from(decode_snapshot(encode_snapshot(snapshot)), 1)
        assert [*station.orders.records] == [3]


class TestTaking:
    """Whatever the station holds, the snapshot that it writes can be read back."""

    @given(
        st.floats(),
        st.floats(),
        st.one_of(st.none(), st.floats()),
        st.text(max_size=300),
    )
    def test_values_out_of_range_are_excluded(
        self, height_m: float, offset_m: float, battery: float | None, name: str
    ) -> None:
        scene = CommandedStation().opens(1, core(height_m=height_m), extended("A"))
        vehicle = scene.station.fleet.vehicles["A"]
        vehicle = replace(
            vehicle,
            altitude_offset_m=replace(vehicle.altitude_offset_m, value=offset_m),
            battery_fraction=replace(vehicle.battery_fraction, value=battery),
        )
        fleet = replace(scene.station.fleet, vehicles={"A": vehicle})
        authority = ControlAuthority(AuthorityHolder.PILOT, name, 1, "x")
        station = replace(scene.station, fleet=fleet).with_control("A", authority=authority)
        snapshot = saved(station, 1)
        assert set(snapshot.vehicles) == set(snapshot.authorities) == {"A"}

    def test_too_many_vehicles_in_flight_are_one_that_may_be_anywhere(self) -> None:
        station = many_vehicles(MAX_VEHICLES + 1, flying=True)
        snapshot = saved(station, NS_PER_S)
        assert len(snapshot.vehicles) == MAX_VEHICLES
        assert [*snapshot.unidentified] == ["many-lost"]
        again = restored_from(snapshot, NS_PER_S)
        assert [*again.watchdog_state.lost] == ["many-lost"]
        assert again.watchdog_state.lost["many-lost"].position.value is None

    def test_vehicles_on_the_ground_take_no_room(self) -> None:
        station = many_vehicles(MAX_VEHICLES + 10, flying=False)
        snapshot = saved(station, NS_PER_S)
        assert snapshot.vehicles == snapshot.unidentified == {}

    def test_a_pilot_is_kept_when_there_are_too_many_vehicles(self) -> None:
        station, operator = Station(), ControlAuthority(holder_name="o")
        for serial in map(str, range(MAX_VEHICLES + 9)):
            station = station.with_control(serial, authority=operator)
        pilot = ControlAuthority(AuthorityHolder.PILOT, "p", 1, "x")
        snapshot = saved(station.with_control("P", authority=pilot), 1)
        assert len(snapshot.authorities) == MAX_VEHICLES
        assert "P" in snapshot.authorities

    def test_too_many_lost_without_a_serial_are_one_more(self) -> None:
        scene = CommandedStation().opens(1, core(), extended("A"))
        state = scene.station.fleet.vehicles["A"]
        lost = {f"n{n}": state for n in range(MAX_UNIDENTIFIED + 50)}
        watchdogs = replace(scene.station.watchdog_state, lost=lost)
        snapshot = saved(replace(scene.station, watchdog_state=watchdogs), NS_PER_S)
        assert len(snapshot.unidentified) == MAX_UNIDENTIFIED
        station = restored_from(snapshot, NS_PER_S)
        assert len(station.watchdog_state.lost) == LOST_KEPT + 1


def many_vehicles(count: int, *, flying: bool) -> Station:
    scene = CommandedStation().opens(1, core(flying=flying), extended("A"))
    vehicle = scene.station.fleet.vehicles["A"]
    fleet = replace(scene.station.fleet, vehicles={f"S{n}": vehicle for n in range(count)})
    return replace(scene.station, fleet=fleet)


class TestWithoutASerial:
    """A vehicle that flew and never reported its serial stays in the air over a restart."""

    def flew(self, seconds: float = 4.0) -> CommandedStation:
        scene = CommandedStation()
        scene.opens(7, core(), extended(None))
        return scene.keeps_receiving(7, core(), extended(None)).passes(seconds)

    def restarted(self, scene: CommandedStation, after_s: float) -> CommandedStation:
        """A new run that begins some seconds later with the snapshot of the last one."""
        snapshot = saved(scene.station, scene.now_ns)
        again = CommandedStation()
        again.now_ns = scene.now_ns + round(after_s * NS_PER_S)
        again.station = restored_from(snapshot, again.now_ns, again.station)
        return again

    def test_it_is_a_hazard_area_and_an_alarm_again_under_a_new_name(self) -> None:
        again = self.restarted(self.flew(), 60.0).passes(0.2)
        (state,) = again.station.watchdog_state.lost.values()
        assert [*again.station.watchdog_state.lost] == ["lost-1"]
        assert state.position.value == PLACE
        assert again.alarms() == {"unidentified_lost"}
        view = hazard_view(again.station, state, again.now_ns)
        assert view is not None
        assert (view.dismissal_name, view.radius_m) == ("lost-1", 120.4)
        again.happens(HazardDismissed("lost-1", "Ann")).passes(0.2)
        assert again.alarms() == set()
        assert again.station.watchdog_state.lost == {}

    def test_one_whose_link_had_closed_is_restored_without_a_grace(self) -> None:
        scene = CommandedStation()
        scene.opens(7, core(), extended(None)).closes(7)
        assert [*self.restarted(scene, 5.0).station.watchdog_state.lost] == ["lost-1"]

    @pytest.mark.parametrize("name", ["link-7", "unidentified link 7"])
    def test_a_dismissed_one_does_not_come_back(self, name: str) -> None:
        scene = self.flew()
        scene.closes(7).passes(5.0).happens(HazardDismissed(name, "Ann"))
        assert self.restarted(scene, 5.0).station.watchdog_state.lost == {}

    @pytest.mark.parametrize("last", [core(flying=False), extended("A")])
    def test_one_that_landed_or_reported_its_serial_does_not_either(self, last: Any) -> None:
        scene = self.flew()
        if isinstance(last, CoreReport):
            scene.lands(7, last, extended(None))
        scene.receives(7, last).closes(7)
        assert self.restarted(scene, 5.0).station.watchdog_state.lost == {}

    def test_a_second_crash_before_any_telemetry_loses_none(self) -> None:
        scene = self.flew()
        once = self.restarted(scene, 5.0)
        twice = self.restarted(once, 5.0)
        assert [*twice.station.watchdog_state.lost] == ["lost-1"]
        (state,) = twice.station.watchdog_state.lost.values()
        assert state.core_received_at_ns == scene.now_ns

    def test_within_its_grace_for_reporting_a_serial_it_is_not_stored(self) -> None:
        def stored(seconds: float) -> list[str]:
            scene = self.flew(seconds)
            return [*saved(scene.station, scene.now_ns).unidentified]

        assert stored(1.0) == []
        assert stored(2.5) == ["link-7"]

    def test_for_some_seconds_no_vehicle_is_held_for_it(self) -> None:
        again = self.restarted(self.flew(), 60.0)
        again.opens(1, core(), extended("A")).keeps_receiving(1, core(), extended("A")).passes(9.8)
        assert again.alarms() == {"unidentified_lost"}
        again.passes(1.0)
        assert again.alarms() == {"unidentified_lost", "separation"}


def _has(parent: Any, key: Any) -> bool:
    if isinstance(parent, dict):
        return key in parent
    return isinstance(parent, list) and isinstance(key, int) and key < len(parent)
