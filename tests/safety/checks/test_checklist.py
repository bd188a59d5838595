"""The whole checklist: every point once, for any vehicle, from what is known alone."""

from dataclasses import replace

import pytest
from tests.safety.cases import situation, vehicle

from recon.model.vehicle import VehicleState
from recon.safety import OPEN_AIRSPACE
from recon.safety.check import CheckState
from recon.safety.checks import checklist
from recon.safety.situation import NO_FACTS

KEYS = [
    "link",
    "battery",
    "endurance",
    "gnss",
    "wind",
    "altitude_reference",
    "go_home_height",
    "failsafe",
    "home",
    "pad",
    "fence",
    "ground",
    "clock",
    "camera_interval",
    "app",
]


def test_a_ready_vehicle_passes_every_point_that_matters() -> None:
    checks = checklist(vehicle(), situation())
    assert [check.key for check in checks] == KEYS
    assert [check for check in checks if check.holds_back] == []
    assert {check.key for check in checks if check.state is CheckState.ATTENTION} == {"ground"}


def test_of_an_unknown_vehicle_every_needed_point_is_unknown_or_fails() -> None:
    bare = VehicleState(serial="A")
    nothing = replace(situation(bare), airspace=OPEN_AIRSPACE, facts=NO_FACTS)
    held = [check.key for check in checklist(bare, nothing) if check.holds_back]
    assert held == [
        key for key in KEYS if key not in ("wind", "pad", "ground", "camera_interval", "app")
    ]


@pytest.mark.parametrize(
    ("state", "holds"),
    [
        (CheckState.OK, False),
        (CheckState.ATTENTION, False),
        (CheckState.UNKNOWN, True),
        (CheckState.FAILS, True),
    ],
)
def test_what_is_unknown_holds_back_as_what_fails(state: CheckState, holds: bool) -> None:
    check = replace(checklist(vehicle(), situation())[0], state=state)
    assert check.holds_back is holds
