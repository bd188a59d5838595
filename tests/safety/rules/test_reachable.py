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


@pytest.mark.parametrize(
    ("known", "reason"),
    [
        (
            True,
            "A: its app waits to be admitted (link 3, 4); admit it first. Until then only hold, "
            "land and return are sent to it",
        ),
        (
            False,
            "A: its app waits to be admitted (link 3, 4); admit it first. Until then only an all "
            "stop reaches it",
        ),
    ],
)
def test_a_serial_whose_app_waits_to_be_admitted(known: bool, reason: str) -> None:
    waits = Situation(NOW, vehicle() if known else None, (), waiting_link_ids=(3, 4))
    assert reachable(LAND, waits) == Refusal("reachable", reason)


def test_a_waiting_app_changes_nothing_for_a_vehicle_that_is_connected() -> None:
    assert reachable(LAND, replace(situation(), waiting_link_ids=(3,))) is None
