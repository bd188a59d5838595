"""One person operates a vehicle at a time; every person may stop it."""

from dataclasses import replace

import pytest
from tests.safety.cases import NOW, STICK, STOPS, S, command, mission, situation

from recon.model.command import Body, Hover, Refusal
from recon.model.control import AuthorityHolder, OperatorLease
from recon.safety import Situation, approve
from recon.safety.rules.operator_lease import operator_lease

LEASE = OperatorLease("anna", NOW - 14 * S, NOW - 2 * S)


def operated() -> Situation:
    return replace(situation(), lease=LEASE)


@pytest.mark.parametrize("body", [mission(), STICK])
@pytest.mark.parametrize(("person", "is_refused"), [("anna", False), ("bob", True), ("", True)])
def test_only_the_person_who_leads_moves_it(body: Body, person: str, is_refused: bool) -> None:
    answer = operator_lease(replace(command(body), person=person), operated())
    assert (answer is not None) is is_refused


def test_the_refusal_names_the_person_since_when_and_what_to_do() -> None:
    answer = approve(replace(command(STICK), person="bob"), operated())
    assert isinstance(answer, Refusal)
    assert answer.rule == "operator_lease"
    assert answer.reason.startswith(
        "A is operated by anna, since 14 s ago; ask anna, or take it over"
    )
    assert answer.parameters == {"person": "anna", "age_s": 14.0}


@pytest.mark.parametrize("body", STOPS)
@pytest.mark.parametrize("person", ["anna", "bob", ""])
def test_every_person_stops_it_or_uses_its_camera(body: Body, person: str) -> None:
    assert operator_lease(replace(command(body), person=person), operated()) is None


def test_a_takeoff_by_hover_moves_it() -> None:
    asked = replace(command(Hover(), takeoff=True), person="bob")
    assert operator_lease(asked, operated()) is not None


def test_guidance_acts_for_the_person_who_gave_it_the_vehicle() -> None:
    asked = replace(command(mission()), role=AuthorityHolder.GUIDANCE)
    assert operator_lease(asked, operated()) is None


def test_a_vehicle_that_is_free_and_a_link_without_a_vehicle() -> None:
    asked = replace(command(mission()), person="bob")
    assert operator_lease(asked, situation()) is None
    assert operator_lease(asked, replace(operated(), vehicle=None)) is None
