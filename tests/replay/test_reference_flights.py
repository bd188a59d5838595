"""Recorded flights give the same outputs, to the bit; a change of behaviour shows here.

Intended? `python -m tests.replay.flights` makes the records anew; state the change in the commit.
"""

import pytest
from tests.replay.flights import FLIGHTS, FOLDER, skip_if_recorded_elsewhere
from tests.replay.rounding import changes

from recon.cli.replay import lines
from recon.station.recording.replay import check


@pytest.mark.parametrize("name", FLIGHTS)
def test_a_recorded_flight_gives_the_same_outputs(name: str) -> None:
    on_start = skip_if_recorded_elsewhere if name == "pictures" else None
    found = check(FOLDER / f"{name}.mcap", on_start=on_start)
    found.differences = changes(found)
    assert not found.differences, "\n".join((*lines(found), __doc__ or ""))
    assert not found.trouble
    assert found.steps > 500
    assert found.jobs >= {"faults": 0, "survey": 40, "pictures": 4}[name]
