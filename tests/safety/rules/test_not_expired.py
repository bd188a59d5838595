"""An order that comes late is no order."""

from dataclasses import replace

import pytest
from tests.safety.cases import NOW, STICK, S, approved, command, mission, refused_by, situation

from recon.model.command import (
    Body,
    Hover,
    LandNow,
    Refusal,
    ReturnHome,
    StartCamera,
)
from recon.safety import approve
from recon.safety.rules.not_expired import not_expired


def test_the_last_nanosecond_counts() -> None:
    assert approved(approve(command(LandNow(), expires_at_ns=NOW + 1), situation()))


def test_at_its_time_it_is_over() -> None:
    judged = approve(command(LandNow(), expires_at_ns=NOW), situation())
    assert refused_by(judged) == "not_expired"


def given(body: Body, ago_s: float, *, takeoff: bool = False) -> Refusal | None:
    """The rule's answer to an order given this long ago."""
    asked = replace(command(body, takeoff=takeoff), given_at_ns=NOW - round(ago_s * S))
    return not_expired(asked, situation())


@pytest.mark.parametrize("body", [mission(), STICK])
@pytest.mark.parametrize(("ago_s", "is_late"), [(0.0, False), (5.0, False), (5.001, True)])
def test_what_moves_must_have_been_given_lately(body: Body, ago_s: float, is_late: bool) -> None:
    assert (given(body, ago_s) is not None) is is_late


def test_a_takeoff_given_long_ago_is_refused_with_its_age() -> None:
    assert given(Hover(), 25.0, takeoff=True) == Refusal(
        "not_expired",
        "Order given 25.0 s ago by its client's clock; motion must be given at most 5 s before it "
        "is sent; give it again if still wanted, and check that clock",
    )
    late = given(mission(), 25.0)
    assert late is not None
    assert late.parameters == {"age_s": 25.0, "max_s": 5.0}


@pytest.mark.parametrize("body", [Hover(), LandNow(), ReturnHome(), StartCamera(1.0)])
@pytest.mark.parametrize("ago_s", [3600.0, -3600.0])
def test_stops_and_the_camera_are_never_late(body: Body, ago_s: float) -> None:
    assert given(body, ago_s) is None


@pytest.mark.parametrize(("ago_s", "is_wrong"), [(-2.0, False), (-2.001, True)])
def test_a_time_in_the_future_is_a_wrong_clock(ago_s: float, is_wrong: bool) -> None:
    answer = given(mission(), ago_s)
    refusal = Refusal(
        "not_expired",
        "Order given 2.0 s in the future: its client's clock is ahead of the station's; set it, or "
        "send the order without its time",
    )
    assert answer == (refusal if is_wrong else None)
    assert answer is None or answer.parameters == {"age_s": -2.001, "max_s": 5.0}


def test_an_order_without_its_time_was_given_now() -> None:
    assert not_expired(command(mission()), situation()) is None


def test_an_expiry_states_how_late_it_is() -> None:
    answer = not_expired(command(LandNow(), expires_at_ns=NOW - S), situation())
    assert answer is not None
    assert answer.reason == "Order expired 1.0 s ago; give it again if still wanted"
    assert answer.parameters == {"late_s": 1.0, "max_s": 0.0}
