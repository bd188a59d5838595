"""Which altitude a waypoint carries: a setting, never a guess."""

from dataclasses import replace

import pytest
from hypothesis import given
from hypothesis import strategies as st
from tests.safety.cases import (
    NOW,
    TAKEOFF,
    WGS84,
    S,
    approved,
    command,
    mission,
    refused_by,
    situation,
    vehicle,
    waypoint,
)

from recon.model.command import Hover, Refusal
from recon.model.units import Stamped
from recon.model.vehicle import VehicleProfile, VehicleState
from recon.safety import ApprovedCommand, approve
from recon.vehicles.packets import to_packet


def judged(state: VehicleState) -> ApprovedCommand | Refusal:
    return approve(command(mission()), situation(state))


def aged(age_s: float) -> Stamped[float]:
    """The offset of takeoff, received this long ago."""
    return Stamped(260.0, NOW - round(age_s * S))


@pytest.mark.parametrize("profile", [None, VehicleProfile("A")])
def test_unset_is_refused_and_states_how_to_set_it(profile: VehicleProfile | None) -> None:
    answer = judged(vehicle(profile))
    assert refused_by(answer) == "altitude_reference"
    assert isinstance(answer, Refusal)
    assert answer.reason == (
        "A: the altitude reference of its app is not set; write waypoint_altitude = "
        '"takeoff" (the public iOS app) or "wgs84" (an app built to the first ICD) under '
        '[[vehicles]] serial = "A" in site.toml'
    )


def test_unset_concerns_missions_only() -> None:
    assert approved(approve(command(Hover()), situation(vehicle(None))))


def test_heights_above_takeoff_go_out_as_they_are() -> None:
    assert approved(judged(vehicle(TAKEOFF, offset_m=None))).altitude_offset_m is None


class TestWgs84:
    def test_an_unknown_offset_is_refused(self) -> None:
        assert refused_by(judged(vehicle(WGS84, offset_m=None))) == "altitude_reference"
        lost = replace(vehicle(WGS84), altitude_offset_m=Stamped())
        assert refused_by(judged(lost)) == "altitude_reference"

    @pytest.mark.parametrize(("age_s", "is_sent"), [(2.0, True), (2.000000001, False)])
    def test_an_offset_older_than_2_s_is_refused(self, age_s: float, is_sent: bool) -> None:
        answer = judged(vehicle(WGS84, altitude_offset_m=aged(age_s)))
        assert is_sent or refused_by(answer) == "altitude_reference"
        assert not is_sent or approved(answer)

    @pytest.mark.parametrize(
        ("offset_m", "is_sent"), [(262.0, True), (258.0, True), (262.01, False), (257.99, False)]
    )
    def test_a_jump_of_more_than_2_m_since_takeoff_is_refused(
        self, offset_m: float, is_sent: bool
    ) -> None:
        answer = judged(vehicle(WGS84, offset_m=offset_m))
        assert is_sent or refused_by(answer) == "altitude_reference"
        assert not is_sent or approved(answer)

    @pytest.mark.parametrize("offset_m", [1e17, -10_000.1, float("inf"), float("nan")])
    def test_an_offset_that_is_no_altitude_is_refused(self, offset_m: float) -> None:
        state = vehicle(WGS84, offset_m=offset_m, offset_at_takeoff_m=offset_m)
        assert refused_by(judged(state)) == "altitude_reference"

    def test_10_km_is_still_an_altitude(self) -> None:
        state = vehicle(WGS84, offset_m=10_000.0, offset_at_takeoff_m=10_000.0)
        assert approved(judged(state))

    def test_from_the_ground_no_takeoff_is_there_to_compare_with(self) -> None:
        state = vehicle(WGS84, flying=False, offset_at_takeoff_m=None)
        assert approved(approve(command(mission(), takeoff=True), situation(state)))

    def test_the_approval_ends_with_the_offsets_2_s(self) -> None:
        answer = approved(judged(vehicle(WGS84, altitude_offset_m=aged(1.5))))
        assert answer.command.expires_at_ns == NOW + S // 2 + 1

    @given(
        home_altitude_m=st.floats(-400.0, 5000.0),
        bias_m=st.floats(-300.0, 300.0),
        height_now_m=st.floats(0.0, 120.0),
        wanted_m=st.floats(5.0, 120.0),
    )
    def test_what_the_app_subtracts_cancels_whatever_the_bias(
        self, home_altitude_m: float, bias_m: float, height_now_m: float, wanted_m: float
    ) -> None:
        """The app reports (home + bias) + height, and subtracts its own (home + bias)."""
        apps_home_m = home_altitude_m + bias_m
        offset_m = (apps_home_m + height_now_m) - height_now_m
        state = vehicle(WGS84, offset_m=offset_m, offset_at_takeoff_m=offset_m)
        body = mission(
            waypoint(0.0, height_above_takeoff_m=wanted_m),
            waypoint(50.0, height_above_takeoff_m=wanted_m),
        )
        answer = approved(approve(command(body), situation(state)))
        packet = to_packet(answer.command.body, answer.altitude_offset_m or 0.0)
        flown_m = [w.altitude_m - apps_home_m for w in packet.waypoints]  # type: ignore[union-attr]
        assert flown_m == pytest.approx([wanted_m, wanted_m], abs=1e-6)
