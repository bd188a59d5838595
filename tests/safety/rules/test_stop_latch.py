"""After an all stop nothing moves a vehicle until a person releases it."""

from dataclasses import replace

import pytest
from tests.safety.cases import (
    MOVES,
    NOW,
    STICK,
    STOPS,
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
    Hover,
    Refusal,
)
from recon.model.control import AuthorityHolder, StopLatch
from recon.safety import Situation, approve, judge
from recon.safety.rules.stop_latch import stop_latch

LATCH = StopLatch("Ann", NOW - 12 * S)


def latched(latch: StopLatch | None = LATCH) -> Situation:
    return replace(situation(), stop_latch=latch)


@pytest.mark.parametrize("body", MOVES)
@pytest.mark.parametrize("role", AuthorityHolder)
def test_nothing_that_moves_passes_of_any_client(body: Body, role: AuthorityHolder) -> None:
    judged = stop_latch(replace(command(body), role=role), latched())
    assert judged == Refusal(
        "stop_latch",
        "A: stopped by the all stop of Ann 12 s ago; release its stop first. Hold, land and return "
        "home are always accepted",
    )
    assert judged.parameters == {"age_s": 12.0, "by": "Ann"}
    assert not judged.is_stale


@pytest.mark.parametrize("body", STOPS)
def test_hold_land_return_and_camera_pass(body: Body) -> None:
    assert stop_latch(command(body), latched()) is None
    assert judge(command(body), latched()) is None


def test_a_hover_that_takes_off_moves() -> None:
    judged = stop_latch(command(Hover(), takeoff=True), latched())
    assert judged is not None


@pytest.mark.parametrize("body", MOVES)
def test_without_a_latch_nothing_is_held_back(body: Body) -> None:
    assert stop_latch(command(body), latched(None)) is None


def test_a_released_vehicle_moves_and_the_others_do_not() -> None:
    assert stop_latch(command(mission()), latched(replace(LATCH, released=frozenset("A")))) is None
    assert stop_latch(command(mission()), latched(replace(LATCH, released=frozenset("B"))))


def test_a_link_without_a_serial_cannot_be_released() -> None:
    asked = replace(command(mission()), serial=None, link_id=1)
    unknown = replace(latched(replace(LATCH, released=frozenset("A"))), vehicle=None)
    judged = stop_latch(asked, unknown)
    assert judged is not None
    assert judged.reason.startswith("this link: stopped by the all stop of Ann")


def test_the_gate_asks_it_before_the_holder_of_authority() -> None:
    asked = replace(command(mission()), role=AuthorityHolder.GUIDANCE)
    assert refused_by(approve(asked, latched())) == "stop_latch"
    assert refused_by(approve(asked, situation())) == "authority"


def test_a_stop_is_approved_while_latched() -> None:
    assert approved(approve(command(Hover()), latched())).link_ids == (1,)


def test_its_age_counts_from_the_stop() -> None:
    judged = stop_latch(command(STICK), replace(latched(), vehicle=vehicle(), now_ns=NOW + S))
    assert judged is not None
    assert judged.parameters["age_s"] == 13.0
