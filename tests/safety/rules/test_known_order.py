"""Deny by default."""

from dataclasses import dataclass

import pytest
from tests.safety.cases import command, refused_by, situation

from recon.model.command import BODY_NAMES, Hover, Refusal
from recon.safety import approve
from recon.safety.rules.known_order import known_order


@dataclass(frozen=True, slots=True)
class Loop:
    pass


@dataclass(frozen=True, slots=True)
class AlmostHover(Hover):
    pass


def test_a_body_no_rule_knows_is_refused() -> None:
    for body in (Loop(), AlmostHover(), None):
        judged = approve(command(body), situation())  # type: ignore[arg-type]
        assert refused_by(judged) == "known_order"


def test_a_refusal_names_it_and_what_is_known() -> None:
    assert known_order(command(Loop()), situation()) == Refusal(  # type: ignore[arg-type]
        "known_order",
        "Order type Loop is unknown; known types: hover, land, return_home, camera_start, "
        "camera_stop, camera_lock, mission, stick, goto, nudge, hold_position, follow_path",
    )


@pytest.mark.parametrize("kind", BODY_NAMES)
def test_every_order_the_station_has_is_known(kind: type) -> None:
    body = object.__new__(kind)
    assert known_order(command(body), situation()) is None
