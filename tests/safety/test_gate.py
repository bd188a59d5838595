"""How long an approval holds, and that all rules are asked."""

from pathlib import Path

import pytest
from tests.safety.cases import NOW, PLACE, STICK, S, approved, command, mission, situation, vehicle

from recon.model.command import (
    Body,
    Command,
    FlyMission,
    GoTo,
    Hover,
    LandNow,
    Refusal,
    ReturnHome,
    StartCamera,
    StopCamera,
)
from recon.safety import approve, rules
from recon.safety.gate import judge, judge_parts
from recon.safety.rules import RULES
from recon.safety.situation import Situation


@pytest.mark.parametrize(
    ("body", "holds_s"),
    [
        (Hover(), 1.5),
        (ReturnHome(), 1.5),
        (STICK, 1.5),
        (mission(), 2.5),
        (LandNow(), 5.0),
        (StartCamera(1.0), 5.0),
        (StopCamera(), 5.0),
    ],
)
def test_what_could_start_a_takeoff_does_not_wait_long_in_a_queue(
    body: Body, holds_s: float
) -> None:
    answer = approved(approve(command(body), situation()))
    assert answer.command.expires_at_ns == NOW + round(holds_s * S)
    assert answer.approved_at_ns == NOW


def test_no_approval_outlives_the_order() -> None:
    for body in (Hover(), mission(), LandNow()):
        order = command(body, expires_at_ns=NOW + S // 2)
        assert approved(approve(order, situation())).command.expires_at_ns == NOW + S // 2


def test_the_vehicles_own_profile_goes_with_it() -> None:
    """Its packet gap is the link's business."""
    state = vehicle()
    assert approved(approve(command(LandNow()), situation(state))).profile is state.profile


def test_a_steered_order_is_judged_and_never_approved_for_the_wire() -> None:
    order = command(GoTo(PLACE, 30.0, 5.0))
    assert judge(order, situation()) is None
    answer = approve(order, situation())
    assert isinstance(answer, Refusal)
    assert answer.rule == "not_for_the_wire"


class TestARuleThatFails:
    """A fault in a rule's code: nothing that moves goes out unjudged, and every stop goes out."""

    @pytest.fixture(autouse=True)
    def _failing(self, monkeypatch: pytest.MonkeyPatch) -> None:
        def broken(_command: Command, _situation: Situation) -> Refusal | None:
            raise ZeroDivisionError("division by zero")

        monkeypatch.setattr("recon.safety.gate.RULES", (broken,))

    @pytest.mark.parametrize("body", [STICK, mission(), GoTo(PLACE, 30.0, 5.0)])
    def test_it_refuses_what_moves(self, body: Body) -> None:
        answer = judge(command(body), situation())
        assert answer is not None
        assert answer.rule == "rule_fault"
        assert "the rule broken" in answer.reason
        assert "ZeroDivisionError: division by zero" in answer.reason

    def test_a_mission_in_parts_too(self) -> None:
        whole = mission().mission
        answer = judge_parts(command(FlyMission(whole)), (whole,), situation())
        assert answer is not None
        assert answer.rule == "rule_fault"

    @pytest.mark.parametrize("body", [Hover(), LandNow(), ReturnHome()])
    def test_it_holds_no_stop_back(self, body: Body) -> None:
        assert approved(approve(command(body), situation())).command.body == body

    def test_a_takeoff_is_no_stop(self) -> None:
        answer = approve(command(Hover(), takeoff=True), situation())
        assert isinstance(answer, Refusal)
        assert answer.rule == "rule_fault"


def test_every_rule_has_one_file_named_after_it() -> None:
    for rule in RULES:
        assert rule.__module__ == f"recon.safety.rules.{rule.__name__}"
    files = {path.stem for path in Path(rules.__file__).parent.glob("*.py")} - {"__init__"}
    assert sorted(rule.__name__ for rule in RULES) == sorted(files)
