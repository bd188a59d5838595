"""Recorded flights give the same outputs, to the bit; a change of behaviour shows here.

Intended? `python -m tests.replay.flights` makes the records anew; state the change in the commit.
"""

from math import isclose

import pytest
from tests.replay.flights import FLIGHTS, FOLDER

from recon.cli.replay import lines
from recon.station.kernel.recorded_values import this_machine
from recon.station.kernel.replay import Difference, check


def is_rounding(difference: Difference) -> bool:
    """Whether two numbers differ in their last bits: processors compute sines by instructions of
    their own."""
    values = difference.recorded, difference.now
    return all(isinstance(each, float) for each in values) and isclose(*values, rel_tol=1e-13)


@pytest.mark.parametrize("name", FLIGHTS)
def test_a_recorded_flight_gives_the_same_outputs(name: str) -> None:
    found = check(FOLDER / f"{name}.mcap")
    assert found.start is not None
    is_other = found.start.machine != this_machine()
    # Of frames, linear algebra is judged by thresholds: what follows may differ by more.
    may_differ = name == "pictures" or all(map(is_rounding, found.differences))
    if found.differences and is_other and may_differ:
        pytest.skip("recorded on another processor: numbers differ in their last bits")
    assert not found.differences, "\n".join((*lines(found), __doc__ or ""))
    assert not found.trouble
    assert found.steps > 500
    assert found.jobs >= {"faults": 0, "survey": 40, "pictures": 4}[name]
