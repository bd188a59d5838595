"""Station, sessions, bytes and simulated apps in virtual time, without a socket."""

import random
import time

import pytest
from tests.station.station_world import World, square_mission, world

from recon.fleet.state import staleness
from recon.model.command import FlyMission, Hover, LandNow, Phase, ReturnHome
from recon.model.event import Event, LinkClosed, PacketReceived
from recon.model.report import CoreReport
from recon.model.units import NS_PER_S
from recon.model.vehicle import AltitudeReference, FlightMode, Staleness
from recon.sim.fake_link import FakeLink
from recon.sim.fleet import Airborne


def lived(seed: int) -> World:
    """A minute with orders and restarts, over links that delay and damage bytes."""

    def damage(chunk: bytes, rng: random.Random) -> bytes:
        if rng.random() < 0.05:
            place = rng.randrange(len(chunk))
            return chunk[:place] + bytes([chunk[place] ^ 0x10]) + chunk[place + 1 :]
        return chunk if rng.random() > 0.02 else b""

    w = world(
        3,
        seed=seed,
        faults=("restart:1:12:2", "second-link:2:15:6", "half-open:3:20:20"),
        make_link=lambda: FakeLink(jitter_s=0.05, damage=damage, seed=seed),
    )
    w.run_for(3.0)
    w.order("SIM-1", FlyMission(square_mission()))
    w.order("SIM-2", LandNow())
    w.run_for(30.0)
    w.order("SIM-3", ReturnHome())
    w.run_for(20.0)
    return w


def written(events: list[Event]) -> list[str]:
    return [repr(event) for event in events]


class TestSameAgain:
    def test_the_same_seed_gives_the_same_run_to_the_bit(self) -> None:
        first, second = lived(3), lived(3)
        assert written(first.driver.log) == written(second.driver.log)
        assert repr(first.driver.station) == repr(second.driver.station)
        assert len(first.driver.log) > 2000

    @pytest.mark.flight
    def test_another_seed_gives_another_run(self) -> None:
        assert written(lived(3).driver.log) != written(lived(4).driver.log)

    @pytest.mark.flight
    def test_five_minutes_of_four_vehicles_take_seconds(self) -> None:
        w = world(4, wanders=True, keeps_log=False)
        before_s = time.process_time()
        w.driver.run_for(300.0)
        assert time.process_time() - before_s < 30.0
        assert w.driver.log == []
        assert {staleness(w.vehicle(f"SIM-{n}"), w.driver.now_ns) for n in (1, 2, 3, 4)} == {
            Staleness.LIVE
        }


class TestBadLinks:
    def test_telemetry_arrives_at_its_rate(self) -> None:
        w = world()
        w.run_for(30.0)
        cores = [
            e
            for e in w.driver.log
            if isinstance(e, PacketReceived) and isinstance(e.report, CoreReport)
        ]
        assert 298 <= len(cores) <= 301

    def test_delay_keeps_the_order(self) -> None:
        seen: list[float] = []
        w = world(make_link=lambda: FakeLink(delay_s=0.1, jitter_s=0.4, seed=5), wanders=True)
        w.run_for(1.0)
        for _ in range(1900):
            w.run_for(0.01)
            received_at_ns = w.vehicle("SIM-1").core_received_at_ns
            assert received_at_ns is not None
            seen.append(received_at_ns)
        assert seen == sorted(seen)
        assert len(set(seen)) > 20

    @pytest.mark.parametrize("cut", ["flip", "lose", "cut"])
    def test_damage_costs_packets_and_never_the_link(self, cut: str) -> None:
        def damage(chunk: bytes, rng: random.Random) -> bytes:
            if rng.random() > 0.3:
                return chunk
            place = rng.randrange(len(chunk))
            match cut:
                case "flip":
                    return chunk[:place] + bytes([chunk[place] ^ 0x41]) + chunk[place + 1 :]
                case "lose":
                    return b""
            return chunk[:place]

        w = world(make_link=lambda: FakeLink(damage=damage, seed=2))
        w.run_for(60.0)
        received = sum(isinstance(e, PacketReceived) for e in w.driver.log)
        sent = 60 * 12 + 1
        assert 0.35 * sent < received < 0.9 * sent
        assert staleness(w.vehicle("SIM-1"), w.driver.now_ns) in (Staleness.LIVE, Staleness.LATE)
        position = w.vehicle("SIM-1").position.value
        assert position is not None
        assert position.latitude_deg == pytest.approx(41.9, abs=1e-3)

    def test_a_dead_link_is_silent_then_lost_and_the_vehicle_comes_back(self) -> None:
        link = FakeLink()
        w = world(make_link=lambda: link)
        w.run_for(5.0)
        link.is_dead = True
        tiers = []
        for _ in range(12):
            w.run_for(1.0)
            tiers.append(staleness(w.vehicle("SIM-1"), w.driver.now_ns))
        assert tiers[1] is Staleness.LATE
        assert tiers[4] is Staleness.LOST
        assert tiers[-1] is Staleness.SILENT
        link.is_dead = False
        w.run_for(1.0)
        assert staleness(w.vehicle("SIM-1"), w.driver.now_ns) is Staleness.LIVE

    def test_a_closed_connection_gets_no_bytes_of_before(self) -> None:
        w = world(make_link=lambda: FakeLink(delay_s=0.5))
        w.run_for(3.0)
        w.order("SIM-1", LandNow())
        old = w.connected["SIM-1"]
        w.driver.disconnect(old.link_id)
        w.connect(old.app)
        w.run_for(0.9)
        assert w.app("SIM-1").aircraft.flight_mode is not FlightMode.AUTO_LANDING


class TestReconnect:
    def test_after_a_restart_it_is_the_same_vehicle_with_its_history(self) -> None:
        w = world(faults=("restart:1:30:2",), wanders=True)
        w.run_for(29.0)
        before = w.vehicle("SIM-1")
        w.run_for(5.0)
        after = w.vehicle("SIM-1")
        assert len(w.driver.station.fleet.vehicles) == 1
        assert after.link_id != before.link_id
        assert after.track[: len(before.track)] == before.track
        assert len(before.track) > 15
        assert staleness(after, w.driver.now_ns) is Staleness.LIVE

    @pytest.mark.parametrize("seed", range(5))
    def test_with_the_old_socket_seemingly_alive_it_takes_a_second(self, seed: int) -> None:
        """1.0 s after its serial came, and a tick of 50 ms; the old link is closed."""
        w = world(faults=("half-open:1:20:60",), wanders=True, seed=seed)
        w.run_for(19.5)
        before, old_id = w.vehicle("SIM-1"), w.connected["SIM-1"].link_id
        assert w.run_until(lambda: w.connected["SIM-1"].link_id != old_id, 2.0)
        new_id = w.connected["SIM-1"].link_id
        links = w.driver.station.fleet.links
        claimed = lambda: w.driver.station.fleet.links[new_id].claimed_serial == "SIM-1"  # noqa: E731
        assert w.run_until(claimed, 2.0)
        claimed_at_ns = w.driver.now_ns
        assert w.run_until(lambda: w.vehicle("SIM-1").link_id == new_id, 3.0)
        assert w.driver.now_ns - claimed_at_ns <= 1.06 * NS_PER_S
        assert w.driver.now_ns - claimed_at_ns >= 0.9 * NS_PER_S
        assert links[old_id].is_open
        assert not w.driver.is_connected(old_id)
        (closed,) = [e for e in w.driver.log if isinstance(e, LinkClosed)]
        assert closed.link_id == old_id
        assert "reconnected on link" in closed.reason
        after = w.vehicle("SIM-1")
        assert after.track[: len(before.track)] == before.track
        w.run_for(1.0)
        assert w.vehicle("SIM-1").rival_link_ids == ()

    def test_orders_reach_it_on_its_new_link(self) -> None:
        w = world(faults=("half-open:1:5:60",))
        w.run_for(8.0)
        order = w.order("SIM-1", LandNow())
        w.run_for(3.0)
        assert Phase.CONFIRMED in w.phases(order)

    def test_a_second_live_link_is_a_conflict_that_ends(self) -> None:
        w = world(faults=("second-link:1:5:10",))
        w.run_for(8.0)
        assert w.vehicle("SIM-1").in_conflict
        first_id = w.connected["SIM-1"].link_id
        assert w.vehicle("SIM-1").link_id == first_id
        w.run_for(10.0)
        assert not w.vehicle("SIM-1").in_conflict
        assert w.vehicle("SIM-1").link_id == first_id


class TestMissions:
    @pytest.mark.parametrize("seed", range(3))
    @pytest.mark.parametrize("reference", [AltitudeReference.TAKEOFF, AltitudeReference.WGS84])
    def test_both_references_fly_the_same_true_height(
        self, reference: AltitudeReference, seed: int
    ) -> None:
        w = world(reference=reference, seed=seed)
        w.run_for(2.0)
        order = w.order("SIM-1", FlyMission(square_mission(height_m=55.0)))
        heights_m: list[float] = []
        for _ in range(60):
            w.run_for(1.0)
            heights_m.append(w.app("SIM-1").aircraft.motion.height_m)
        assert Phase.STARTED in w.phases(order)
        assert max(heights_m) == pytest.approx(55.0, abs=1.0)
        assert "wgs84" in str(w.record(order).altitudes).lower() or (
            reference is AltitudeReference.TAKEOFF
        )

    def test_a_wrong_altitude_reference_flies_far_too_high(self) -> None:
        """The control: an app for heights above takeoff climbs hundreds of metres by altitudes."""
        w = world(reference=AltitudeReference.TAKEOFF, profile_reference=AltitudeReference.WGS84)
        w.run_for(2.0)
        w.order("SIM-1", FlyMission(square_mission(height_m=55.0)))
        w.run_for(60.0)
        assert w.app("SIM-1").aircraft.motion.height_m > 150.0


def alarm_rules(w: World) -> set[str]:
    return {alarm.condition.rule for alarm in w.driver.station.alarms.alarms.values()}


class TestAnswers:
    def test_a_good_app_acknowledges_then_telemetry_confirms(self) -> None:
        w = world()
        w.run_for(2.0)
        order = w.order("SIM-1", LandNow())
        w.run_for(3.0)
        assert w.phases(order)[:4] == [
            Phase.QUEUED,
            Phase.SENT,
            Phase.ACKNOWLEDGED,
            Phase.CONFIRMED,
        ]

    def test_without_an_answer_telemetry_confirms(self) -> None:
        w = world(faults=("no-ack",))
        w.run_for(2.0)
        order = w.order("SIM-1", LandNow())
        w.run_for(3.0)
        assert Phase.CONFIRMED in w.phases(order)
        assert Phase.ACKNOWLEDGED not in w.phases(order)

    def test_a_negative_answer_is_a_refusal(self) -> None:
        w = world(faults=("negative-ack",))
        w.run_for(2.0)
        order = w.order("SIM-1", FlyMission(square_mission()))
        w.run_for(3.0)
        assert w.record(order).phase is Phase.REFUSED_BY_APP

    def test_an_answer_without_an_effect_is_never_confirmed(self) -> None:
        w = world(faults=("ack-then-nothing",))
        w.run_for(2.0)
        order = w.order("SIM-1", FlyMission(square_mission()))
        w.run_for(1.0)
        assert w.record(order).phase is Phase.ACKNOWLEDGED
        w.run_for(10.0)
        assert w.record(order).phase is Phase.TIMED_OUT
        assert "mission_ignored" in alarm_rules(w)

    def test_a_mission_is_not_begun_because_the_one_before_flies_the_same_way(self) -> None:
        w = world(faults=("ignored-missions::20:30",))
        w.run_for(2.0)
        flown = w.order("SIM-1", FlyMission(square_mission()))
        w.run_for(20.0)
        assert w.record(flown).phase is Phase.STARTED
        again = w.order("SIM-1", FlyMission(square_mission()))
        w.run_for(10.0)
        assert w.vehicle("SIM-1").flight_mode.value is FlightMode.GPS_WAYPOINT
        assert w.record(again).phase is Phase.TIMED_OUT
        assert "mission_ignored" in alarm_rules(w)

    def test_an_emergency_ignored_is_repeated_and_alarmed(self) -> None:
        w = world(faults=("ack-then-nothing",), wanders=True)
        w.run_for(2.0)
        order = w.order("SIM-1", Hover())
        w.run_for(15.0)
        assert w.record(order).times_sent == 4
        assert w.record(order).phase is Phase.TIMED_OUT
        assert "order_not_confirmed" in alarm_rules(w)

    def test_on_the_ground_hover_is_refused(self) -> None:
        w = world(airborne=Airborne.NONE)
        w.run_for(2.0)
        order = w.order("SIM-1", Hover())
        assert w.record(order).phase is Phase.REFUSED_BY_STATION
