"""A stick without velocity stops only where its vehicle is; a climb is motion, and judged."""

from dataclasses import replace

import pytest
from tests.safety.cases import (
    STICK,
    approved,
    command,
    refused_by,
    situation,
    vehicle,
)

from recon.model.command import Hover, VirtualStick
from recon.model.control import AuthorityHolder, ControlAuthority
from recon.model.units import Stamped
from recon.model.vehicle import BatteryWarning, VehicleState
from recon.safety import Situation, Traffic, approve
from recon.safety.path.order_path import is_stop

POOR: dict[str, object] = {
    "battery_fraction": 0.03,
    "battery_warning": BatteryWarning.SERIOUS,
    "gnss_satellite_count": 0,
    "gnss_signal_level": 0,
}


def zero(height_m: float) -> VirtualStick:
    return VirtualStick(STICK.frame, 90.0, 0.0, 0.0, height_m, 5.0)


def stops(height_m: float, state: VehicleState, **now: object) -> bool:
    where = replace(situation(state), **now)  # type: ignore[arg-type]
    return is_stop(command(zero(height_m)), where)


class TestHeight:
    @pytest.mark.parametrize(
        ("height_m", "is_there"),
        [(40.0, True), (41.0, True), (39.0, True), (41.1, False), (38.9, False), (60.0, False)],
    )
    def test_it_stops_within_a_metre_of_the_last_height(
        self, height_m: float, is_there: bool
    ) -> None:
        assert stops(height_m, vehicle(age_s=60.0)) is is_there

    def test_without_a_height_that_of_the_stick_before_counts(self) -> None:
        lost = vehicle(height_above_takeoff_m=Stamped())
        assert not stops(40.0, lost)
        assert stops(40.0, lost, stick_height_above_takeoff_m=40.0)
        assert not stops(42.0, lost, stick_height_above_takeoff_m=40.0)

    def test_a_known_height_is_worth_more_than_the_stick_before(self) -> None:
        assert not stops(60.0, vehicle(), stick_height_above_takeoff_m=60.0)

    def test_velocity_takeoff_another_body_and_no_vehicle_are_no_stop(self) -> None:
        now = situation(vehicle())
        assert is_stop(command(zero(40.0)), now)
        assert not is_stop(command(replace(zero(40.0), velocity_x_mps=0.001)), now)
        assert not is_stop(command(replace(zero(40.0), velocity_y_mps=0.001)), now)
        assert not is_stop(command(zero(40.0), takeoff=True), now)
        assert not is_stop(command(Hover()), now)
        assert not is_stop(command(zero(40.0)), replace(now, vehicle=None))


class TestClimb:
    @pytest.mark.parametrize("height_m", [60.0, 20.0])
    def test_without_velocity_it_is_refused_as_any_motion_is(self, height_m: float) -> None:
        now = situation(vehicle(**POOR))
        assert refused_by(approve(command(zero(height_m)), now)) == "gnss"
        late = situation(vehicle(age_s=1.5))
        assert refused_by(approve(command(zero(height_m)), late)) == "link_age"

    def test_it_is_not_flown_into_one_above(self) -> None:
        other = replace(vehicle(height_above_takeoff_m=60.0), serial="B", link_id=9)
        below = replace(situation(), traffic=(Traffic(other),))
        assert refused_by(approve(command(zero(60.0)), below)) == "separation"
        assert approved(approve(command(zero(40.0)), below))

    def test_where_all_is_well_it_is_flown(self) -> None:
        assert approved(approve(command(zero(60.0)), situation()))

    def test_the_stop_itself_always_goes(self) -> None:
        for state in (vehicle(**POOR), vehicle(age_s=3.0, position=Stamped(), **POOR)):
            assert approved(approve(command(zero(40.0)), situation(state)))


def on_ground(**changes: object) -> Situation:
    return situation(vehicle(flying=False, **changes))  # type: ignore[arg-type]


@pytest.mark.parametrize("body", [Hover(), zero(30.0), zero(5.0), STICK])
class TestTakeoff:
    def test_all_being_well_it_takes_off(self, body: Hover | VirtualStick) -> None:
        assert approved(approve(command(body, takeoff=True), on_ground()))

    def test_only_the_holder_may_order_it(self, body: Hover | VirtualStick) -> None:
        led = replace(
            on_ground(),
            authority=ControlAuthority(AuthorityHolder.PILOT, "pilot", 0, "the pilot has it"),
        )
        assert refused_by(approve(command(body, takeoff=True), led)) == "authority"

    @pytest.mark.parametrize(
        ("changes", "rule"),
        [
            ({"age_s": 1.5}, "link_age"),
            ({"gnss_satellite_count": 0}, "gnss"),
            ({"position": Stamped()}, "gnss"),
            ({"battery_fraction": 0.03}, "battery"),
            ({"battery_warning": BatteryWarning.LOW}, "battery"),
            ({"profile": None}, "battery"),
            ({"is_flying": Stamped()}, "flying"),
        ],
    )
    def test_it_asks_for_what_motion_asks_for(
        self, body: Hover | VirtualStick, changes: dict[str, object], rule: str
    ) -> None:
        assert refused_by(approve(command(body, takeoff=True), on_ground(**changes))) == rule

    def test_it_needs_the_checklist(self, body: Hover | VirtualStick) -> None:
        unread = replace(on_ground(), facts=replace(on_ground().facts, clock=None))
        assert refused_by(approve(command(body, takeoff=True), unread)) == "preflight"

    def test_the_space_above_it_must_be_free(self, body: Hover | VirtualStick) -> None:
        for height_m, free in ((8.5, False), (200.0, True)):
            other = replace(vehicle(height_above_takeoff_m=height_m), serial="B", link_id=9)
            above = replace(on_ground(), traffic=(Traffic(other),))
            answer = approve(command(body, takeoff=True), above)
            assert approved(answer) if free else refused_by(answer) == "separation"
