"""How long an approval holds, and that all rules are asked."""

from pathlib import Path

import pytest
from tests.safety.cases import NOW, STICK, S, approved, command, mission, situation, vehicle

from recon.model.command import Body, Hover, LandNow, ReturnHome, StartCamera, StopCamera
from recon.safety import approve, rules
from recon.safety.rules import RULES


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


def test_every_rule_has_one_file_named_after_it() -> None:
    for rule in RULES:
        assert rule.__module__ == f"recon.safety.rules.{rule.__name__}"
    files = {path.stem for path in Path(rules.__file__).parent.glob("*.py")} - {"__init__"}
    assert sorted(rule.__name__ for rule in RULES) == sorted(files)
