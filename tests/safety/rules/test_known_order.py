"""Deny by default."""

from dataclasses import dataclass

from tests.safety.cases import command, refused_by, situation

from recon.model.command import Hover
from recon.safety import approve


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
