"""Recorded flights give the same outputs, to the bit; a change of behaviour shows here.

Intended? `python -m tests.replay.flights` makes the records anew; state the change in the commit.
"""

from math import isclose

import pytest
from tests.replay.flights import FLIGHTS, FOLDER, skip_if_recorded_elsewhere

from recon.cli.replay import lines
from recon.station.recording.recorded_values import this_machine
from recon.station.recording.replay import Difference, check


def is_rounding(difference: Difference) -> bool:
    """Whether two numbers differ in their last bits: processors compute sines by instructions of
    their own."""
    values = difference.recorded, difference.now
    return all(isinstance(each, float) for each in values) and isclose(*values, rel_tol=1e-13)


@pytest.mark.parametrize("name", FLIGHTS)
def test_a_recorded_flight_gives_the_same_outputs(name: str) -> None:
    on_start = skip_if_recorded_elsewhere if name == "pictures" else None
    found = check(FOLDER / f"{name}.mcap", on_start=on_start)
    assert found.start is not None
    is_here = found.start.machine == this_machine()
    found.differences = [each for each in found.differences if is_here or not is_rounding(each)]
    assert not found.differences, "\n".join((*lines(found), __doc__ or ""))
    assert not found.trouble
    assert found.steps > 500
    assert found.jobs >= {"faults": 0, "survey": 40, "pictures": 4}[name]
