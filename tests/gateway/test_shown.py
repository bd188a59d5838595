"""What is sent of a vehicle: telemetry, each sample once, and nothing without it."""

import math

import pytest
from tests.gateway.fleet_state import Stepping, seen, sent, types

from recon.api import schema
from recon.gateway.mavlink.dialect import mavlink
from recon.gateway.mavlink.inputs_outputs import TimePassed
from recon.gateway.mavlink.values import GatewaySettings

FAST = ["GLOBAL_POSITION_INT", "ATTITUDE"]


def place(age_s: float = 0.05, latitude_deg: float | None = 41.90123456) -> schema.PositionView:
    return schema.PositionView(latitude_deg=latitude_deg, longitude_deg=-93.60345678, age_s=age_s)


def test_a_live_vehicle_beats_once_a_second_and_shows_each_sample() -> None:
    gateway = Stepping()
    beats, places = 0, 0
    for tenth in range(1, 31):
        names = types(gateway.give(seen(5.0 + tenth / 10.0)))
        beats += names.count("HEARTBEAT")
        places += names.count("GLOBAL_POSITION_INT")
    assert (beats, places) == (3, 30)


def test_every_digit_is_that_of_the_telemetry() -> None:
    gateway = Stepping(GatewaySettings(ground_above_sea_level_m=278.5))
    messages = {
        m.get_type(): m
        for m in sent(
            gateway.give(
                seen(
                    6.0,
                    position=place(),
                    height_above_takeoff_m=schema.AgedNumber(value=39.987, age_s=0.05),
                    velocity_ned=schema.VelocityView(
                        north_mps=1.234, east_mps=-2.5, down_mps=0.011, age_s=0.05
                    ),
                    attitude=schema.AttitudeView(
                        yaw_deg=-90.5, pitch_deg=1.25, roll_deg=-2.0, age_s=0.05
                    ),
                    battery_fraction=schema.AgedNumber(value=0.57, age_s=1.0),
                ),
                after_s=1.0,
            )
        )
    }
    at = messages["GLOBAL_POSITION_INT"]
    assert (at.lat, at.lon) == (419012346, -936034568)
    assert (at.relative_alt, at.alt) == (39_987, 278_500 + 39_987)
    assert (at.vx, at.vy, at.vz, at.hdg) == (123, -250, 1, 26_950)
    assert at.time_boot_ms == 5_950
    pose = messages["ATTITUDE"]
    assert pose.yaw == pytest.approx(math.radians(-90.5))
    assert (pose.pitch, pose.roll) == (math.radians(1.25), math.radians(-2.0))
    assert math.isnan(pose.yawspeed)
    assert messages["SYS_STATUS"].battery_remaining == 57


def test_a_sample_is_sent_once() -> None:
    gateway = Stepping()
    gateway.give(seen(5.1), after_s=1.0)
    again = seen(5.2)
    assert types(gateway.give(again)) == FAST
    assert types(gateway.give(again)) == []


@pytest.mark.parametrize("staleness", ["late", "lost", "silent"])
def test_a_vehicle_without_live_telemetry_sends_nothing(staleness: str) -> None:
    gateway = Stepping()
    for tenth in range(30):
        outputs = gateway.give(seen(6.0 + tenth / 10.0, staleness=staleness, telemetry_age_s=1.5))
        assert outputs == ()


def test_a_state_that_is_old_itself_sends_nothing() -> None:
    assert Stepping().give(seen(6.0, age_s=1.0), after_s=2.0) == ()


def test_an_old_position_is_not_sent_again_while_the_vehicle_beats() -> None:
    gateway = Stepping()
    names = types(gateway.give(seen(7.0, position=place(age_s=1.2)), after_s=2.0))
    assert "HEARTBEAT" in names
    assert not {"GLOBAL_POSITION_INT", "GPS_RAW_INT", "VFR_HUD"} & set(names)


def test_an_unknown_place_is_no_zero() -> None:
    names = types(Stepping().give(seen(7.0, position=place(latitude_deg=None)), after_s=2.0))
    assert "HEARTBEAT" in names
    assert "GLOBAL_POSITION_INT" not in names


def test_unknown_flight_counts_as_in_the_air() -> None:
    unknown = schema.AgedFlag(value=None, age_s=None)
    messages = {m.get_type(): m for m in sent(Stepping().give(seen(7.0, is_flying=unknown), 2.0))}
    assert messages["HEARTBEAT"].base_mode & 128
    assert messages["EXTENDED_SYS_STATE"].landed_state == 0


def test_home_is_where_it_was_last_seen_on_the_ground() -> None:
    gateway = Stepping()
    assert "HOME_POSITION" not in types(gateway.give(seen(7.0), 2.0))
    grounded = schema.AgedFlag(value=False, age_s=0.05)
    gateway.give(seen(8.0, is_flying=grounded, position=place()))
    messages = {m.get_type(): m for m in sent(gateway.give(seen(9.0), 2.0))}
    assert messages["HOME_POSITION"].latitude == 419012346


def test_of_a_silent_station_nothing_is_told_as_if_it_were_now() -> None:
    """A client that asks gets no place and no sign of life."""
    gateway = Stepping()
    gateway.give(seen(6.0, is_flying=schema.AgedFlag(value=False, age_s=0.05), position=place()))
    asked = mavlink.MAVLink_command_long_message(1, 1, 512, 0, 242, 0, 0, 0, 0, 0, 0)
    ping = mavlink.MAVLink_ping_message(1, 2, 0, 0)
    assert types(gateway.receive(asked)) == ["COMMAND_ACK", "HOME_POSITION"]
    assert types(gateway.receive(ping)) == ["PING"]
    gateway.give(TimePassed(), after_s=1.0)
    (answer,) = sent(gateway.receive(asked))
    assert answer.result == mavlink.MAV_RESULT_TEMPORARILY_REJECTED
    assert gateway.receive(ping) == ()
    assert gateway.receive(mavlink.MAVLink_timesync_message(0, 42)) == ()


def test_health_is_all_good_and_never_armable() -> None:
    messages = {m.get_type(): m for m in sent(Stepping().give(seen(7.0), 2.0))}
    healthy = messages["SYS_STATUS"].onboard_control_sensors_health
    assert healthy & 0b100111 == 0b100111
    prearm = 1 << 28
    assert not healthy & prearm


def test_only_identified_vehicles_are_shown() -> None:
    assert Stepping(serial=None).state.vehicles == {}


def test_beats_come_from_the_autopilot_component_alone() -> None:
    from recon.gateway.mavlink.encoder import Encoder

    (beat, *_) = sent(Stepping().give(seen(7.0), 2.0))
    frame = Encoder().encode(1, [beat], 0.0)[0]
    assert (frame[5], frame[6]) == (1, 1)


def test_what_is_slow_is_spread_over_the_states_of_a_second() -> None:
    stepping = {number: Stepping(number=number) for number in (1, 5, 9)}
    waits_ns = [g.state.vehicles[n].slow_due_ns - g.now_ns for n, g in stepping.items()]
    assert waits_ns == [95_000_000, 475_000_000, 855_000_000]
