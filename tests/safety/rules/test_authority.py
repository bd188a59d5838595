"""The authority holder sets a vehicle in motion; any client may stop it."""

from dataclasses import replace

import pytest
from tests.safety.cases import MOVES, STICK, STOPS, command, mission, situation, vehicle

from recon.model.command import (
    Body,
    Refusal,
)
from recon.model.control import AuthorityHolder, ControlAuthority
from recon.safety import Situation
from recon.safety.rules.authority import authority


def held_by(who: AuthorityHolder) -> Situation:
    return replace(situation(), authority=ControlAuthority(who, "Ann", 5, "taken over by Ann"))


def judged(body: Body, role: AuthorityHolder, who: AuthorityHolder) -> Refusal | None:
    return authority(replace(command(body), role=role), held_by(who))


@pytest.mark.parametrize("body", MOVES)
@pytest.mark.parametrize("who", AuthorityHolder)
@pytest.mark.parametrize("role", AuthorityHolder)
def test_only_the_holder_sets_a_vehicle_in_motion(
    body: Body, role: AuthorityHolder, who: AuthorityHolder
) -> None:
    answer = judged(body, role, who)
    assert (answer is None) is (role is who)
    assert answer is None or answer.rule == "authority"


@pytest.mark.parametrize("body", STOPS)
@pytest.mark.parametrize("who", AuthorityHolder)
@pytest.mark.parametrize("role", AuthorityHolder)
def test_any_client_stops_it_or_uses_the_camera(
    body: Body, role: AuthorityHolder, who: AuthorityHolder
) -> None:
    assert judged(body, role, who) is None


def test_a_refusal_names_the_holder_and_the_reason() -> None:
    answer = judged(mission(), AuthorityHolder.GUIDANCE, AuthorityHolder.OPERATOR)
    assert answer == Refusal(
        "authority",
        "A is controlled by operator (taken over by Ann), and the order comes from guidance: give "
        "control to guidance first",
    )


@pytest.mark.parametrize(
    ("who", "what_to_do"),
    [
        (
            AuthorityHolder.PILOT,
            "ask the pilot, then take control",
        ),
        (
            AuthorityHolder.GUIDANCE,
            "hold the vehicle, or take control, first",
        ),
    ],
)
def test_a_refusal_states_what_to_do(who: AuthorityHolder, what_to_do: str) -> None:
    answer = judged(STICK, AuthorityHolder.OPERATOR, who)
    assert answer is not None
    assert f": {what_to_do}" in answer.reason


def test_a_missing_vehicle_is_another_rules_matter() -> None:
    assert (
        authority(command(mission()), replace(held_by(AuthorityHolder.PILOT), vehicle=None)) is None
    )


def test_by_default_the_operator_is_the_holder() -> None:
    assert authority(command(mission()), situation(vehicle())) is None
