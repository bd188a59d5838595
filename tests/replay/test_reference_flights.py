"""Recorded flights give the same outputs, to the bit; a change of behaviour shows here.

Intended? `python -m tests.replay.flights` makes the records anew; state the change in the commit.
"""

import pytest
from tests.replay.flights import FLIGHTS, FOLDER

from recon.cli.replay import lines
from recon.station.kernel.recorded_values import this_machine
from recon.station.kernel.replay import check


@pytest.mark.parametrize("name", FLIGHTS)
def test_a_recorded_flight_gives_the_same_outputs(name: str) -> None:
    found = check(FOLDER / f"{name}.mcap")
    assert found.start is not None
    if found.differences and name == "pictures" and found.start.machine != this_machine():
        pytest.skip("recorded on another processor: linear algebra differs in its last bits")
    assert not found.differences, "\n".join((*lines(found), __doc__ or ""))
    assert not found.trouble
    assert found.steps > 500
    assert found.jobs >= {"faults": 0, "survey": 40, "pictures": 4}[name]
