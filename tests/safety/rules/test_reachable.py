"""A command needs a known vehicle and an open link."""

from dataclasses import replace

import pytest
from tests.safety.cases import NOW, command, situation, vehicle

from recon.model.command import LandNow, Refusal
from recon.safety import Situation, approve
from recon.safety.rules.reachable import reachable

LAND = command(LandNow())


def test_an_unknown_serial() -> None:
    assert approve(LAND, Situation(NOW, None, ())) == Refusal(
        "reachable", "A is unknown: no app has reported this serial"
    )


def test_an_unknown_link() -> None:
    unsaid = replace(LAND, serial=None, link_id=7)
    assert approve(unsaid, Situation(NOW, None, ())) == Refusal(
        "reachable", "link 7 is unknown: no app has reported this serial"
    )


@pytest.mark.parametrize(("flying", "is_stale"), [(True, True), (False, False), (None, False)])
def test_a_vehicle_without_a_connection(flying: bool | None, is_stale: bool) -> None:
    """One that was last known to fly is waited for; it is not called unknown."""
    answer = approve(LAND, Situation(NOW, vehicle(flying=flying), ()))
    assert isinstance(answer, Refusal)
    assert (answer.rule, answer.reason) == (
        "reachable",
        "A is not connected: its companion app must connect first",
    )
    assert answer.is_stale is is_stale


def test_one_that_is_connected() -> None:
    assert reachable(LAND, situation()) is None
