"""Nothing leaves the ground unless the order includes takeoff (decisions on the ICD, 16 and 17)."""

from dataclasses import replace

import pytest
from tests.safety.cases import (
    NOW,
    PLACE,
    STICK,
    S,
    approved,
    command,
    mission,
    refused_by,
    situation,
    vehicle,
)

from recon.model.command import (
    Body,
    GoTo,
    HoldPosition,
    Hover,
    LandNow,
    Nudge,
    Refusal,
    ReturnHome,
    StartCamera,
    StopCamera,
)
from recon.model.units import Stamped
from recon.safety import approve
from recon.safety.rules.flying import flying

MOVES = [Hover(), ReturnHome(), mission(), STICK]
STEERED = [GoTo(PLACE, 40.0, 5.0), Nudge(1.0, 0.0, 0.0), HoldPosition()]


def test_an_unknown_vehicle_is_another_rules_matter() -> None:
    asked = command(Hover(), takeoff=True)
    unknown = replace(situation(), vehicle=None, claiming_links=())
    assert flying(asked, unknown) is None
    assert refused_by(approve(asked, unknown)) == "reachable"


@pytest.mark.parametrize("body", MOVES)
class TestWithoutTakeoff:
    def test_it_goes_to_a_vehicle_that_flies(self, body: Body) -> None:
        assert approved(approve(command(body), situation())).link_ids == (1,)

    def test_it_is_never_sent_to_a_vehicle_on_the_ground(self, body: Body) -> None:
        judged = approve(command(body), situation(vehicle(flying=False)))
        assert refused_by(judged) == "flying"

    def test_it_is_not_sent_while_the_app_does_not_say(self, body: Body) -> None:
        assert refused_by(approve(command(body), situation(vehicle(flying=None)))) == "flying"

    @pytest.mark.parametrize(("age_s", "is_open"), [(3.0, True), (3.000000001, False)])
    def test_telemetry_must_be_fresh(self, body: Body, age_s: float, is_open: bool) -> None:
        """An order to move is then still refused, by the younger age it needs itself."""
        low = vehicle(age_s=age_s, height_above_takeoff_m=30.0)
        judged = flying(command(body), situation(low))
        assert (judged is None) is is_open

    def test_it_is_not_sent_before_any_telemetry(self, body: Body) -> None:
        lost = vehicle()
        lost = type(lost)(serial="A", link_id=1, profile=lost.profile)
        assert refused_by(approve(command(body), situation(lost))) == "flying"


def test_a_report_on_the_ground_without_a_landing_seen_is_uncertain() -> None:
    uncertain = vehicle(flying=None, reported_is_flying=False)
    assert flying(command(Hover()), situation(uncertain)) == Refusal(
        "flying",
        "A: it reports on the ground, and no landing was seen; the order could start a takeoff",
    )


class TestWithTakeoff:
    @pytest.mark.parametrize("body", [Hover(), mission(), STICK])
    def test_the_operator_may_order_a_takeoff(self, body: Body) -> None:
        judged = approve(command(body, takeoff=True), situation(vehicle(flying=False)))
        assert approved(judged).link_ids == (1,)

    @pytest.mark.parametrize("is_flying", [True, False])
    @pytest.mark.parametrize("body", [ReturnHome(), LandNow(), StopCamera(), *STEERED])
    def test_no_other_order_takes_the_word(self, body: Body, is_flying: bool) -> None:
        judged = flying(command(body, takeoff=True), situation(vehicle(flying=is_flying)))
        assert judged is not None
        assert f"got {command(body).name}. Give" in judged.reason

    @pytest.mark.parametrize("body", [Hover(), mission(), STICK])
    def test_an_app_that_does_not_report_flight_never_takes_off(self, body: Body) -> None:
        asked = command(body, takeoff=True)
        assert refused_by(flying(asked, situation(vehicle(flying=None)))) == "flying"
        assert flying(asked, replace(situation(), vehicle=None)) is None


@pytest.mark.parametrize("body", STEERED)
def test_a_steered_order_never_leaves_the_ground(body: Body) -> None:
    asked = command(body)
    assert flying(asked, situation(vehicle())) is None
    assert refused_by(flying(asked, situation(vehicle(flying=False)))) == "flying"


@pytest.mark.parametrize("flying", [True, False, None])
@pytest.mark.parametrize("age_s", [0.1, 600.0])
def test_land_is_always_sent(flying: bool | None, age_s: float) -> None:
    judged = approve(command(LandNow()), situation(vehicle(flying=flying, age_s=age_s)))
    assert approved(judged).link_ids == (1,)


@pytest.mark.parametrize("body", [StartCamera(1.0), StopCamera()])
def test_camera_orders_need_no_flight(body: Body) -> None:
    assert approved(approve(command(body), situation(vehicle(flying=False))))


class TestRivals:
    @pytest.mark.parametrize("body", [Hover(), ReturnHome()])
    def test_hover_and_return_spare_a_rival_link_that_reports_on_the_ground(
        self, body: Body
    ) -> None:
        now = situation(vehicle(), Stamped(False, NOW), Stamped(True, NOW), Stamped(False, 1))
        assert approved(approve(command(body), now)).link_ids == (1, 3)

    def test_the_vehicles_own_link_on_the_ground_is_spared_too(self) -> None:
        now = situation(vehicle(flying=False), Stamped(True, NOW))
        assert approved(approve(command(Hover()), now)).link_ids == (2,)

    def test_land_goes_to_every_link_that_claims_the_serial(self) -> None:
        now = situation(vehicle(), Stamped(False, NOW), Stamped(None, None))
        assert approved(approve(command(LandNow()), now)).link_ids == (1, 2, 3)

    def test_a_rival_without_telemetry_is_held_while_the_vehicle_flies(self) -> None:
        now = situation(vehicle(), Stamped(None, None))
        assert approved(approve(command(Hover()), now)).link_ids == (1, 2)

    def test_a_rival_whose_old_telemetry_shows_flight_opens_no_door(self) -> None:
        now = situation(vehicle(flying=False), Stamped(True, NOW - 4 * S))
        assert refused_by(approve(command(Hover()), now)) == "flying"


class TestReasons:
    """Word for word, and whether only stale telemetry is the cause."""

    @pytest.mark.parametrize(
        ("is_flying", "age_s", "reason", "is_stale"),
        [
            (False, 0.1, "on the ground; takeoff was not allowed", False),
            (False, 3.0, "on the ground; takeoff was not allowed", False),
            (
                None,
                0.1,
                "its app does not report whether it flies; the order could start a takeoff",
                False,
            ),
            (
                True,
                3.5,
                "telemetry must be at most 3 s old; got 3.5 s; if it has landed, the order would "
                "start a takeoff. Land is always sent",
                True,
            ),
            (
                False,
                3.5,
                "telemetry must be at most 3 s old; got 3.5 s; if it has landed, the order would "
                "start a takeoff. Land is always sent",
                False,
            ),
        ],
    )
    def test_without_takeoff(
        self, is_flying: bool | None, age_s: float, reason: str, is_stale: bool
    ) -> None:
        answer = flying(command(Hover()), situation(vehicle(flying=is_flying, age_s=age_s)))
        assert answer == Refusal("flying", f"A: {reason}", is_stale=is_stale)
        assert answer.is_stale is is_stale

    def test_before_any_telemetry(self) -> None:
        lost = vehicle(is_flying=Stamped(None, None))
        assert flying(command(Hover()), situation(lost)) == Refusal(
            "flying", "A: no telemetry shows flight; the order could start a takeoff"
        )

    def test_telemetry_of_exactly_the_age_is_not_stale(self) -> None:
        answer = flying(command(Hover()), replace(situation(vehicle(age_s=3.0)), claiming_links=()))
        assert answer is not None
        assert answer.is_stale is False

    def test_a_takeoff_of_an_app_that_does_not_say_whether_it_flies(self) -> None:
        asked = command(Hover(), takeoff=True)
        assert flying(asked, situation(vehicle(flying=None))) == Refusal(
            "flying",
            "A: its app does not report whether it flies, so takeoff is uncertain; check the app",
        )

    def test_a_takeoff_by_an_order_that_never_takes_off(self) -> None:
        asked = command(LandNow(), takeoff=True)
        assert flying(asked, situation()) == Refusal(
            "flying",
            "Takeoff is accepted with hover, mission, stick only; got land. Give the order again "
            "without takeoff",
        )
