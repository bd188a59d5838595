"""One point of a checklist, asked alone."""

from collections.abc import Callable
from dataclasses import replace

from tests.safety.cases import situation

from recon.model.vehicle import VehicleState
from recon.safety.check import Check, CheckState
from recon.safety.situation import Situation

OK, ATTENTION = CheckState.OK, CheckState.ATTENTION
UNKNOWN, FAILS = CheckState.UNKNOWN, CheckState.FAILS


def checked(
    point: Callable[[VehicleState, Situation], Check], state: VehicleState, **now: object
) -> Check:
    """The point for a vehicle, in a situation with these changes."""
    found = point(state, replace(situation(state), **now))  # type: ignore[arg-type]
    assert found.key
    assert found.name
    assert found.text
    assert (found.to_do == "") is (found.state is OK)
    return found
