"""The timers of survey cameras have hidden phases, the same for the same seed."""

import numpy as np

from recon.score.true_paths import phases_s

SERIALS = [f"SIM-{number}" for number in range(200)]


def test_timers_phases_fill_the_interval() -> None:
    phases = phases_s(3, SERIALS, 2.0)
    counts, _ = np.histogram(phases, bins=4, range=(0.0, 2.0))
    assert counts.sum() == len(SERIALS)
    assert counts.min() > 30


def test_a_phase_depends_on_seed_and_serial_alone() -> None:
    assert phases_s(3, SERIALS[5:6], 2.0) == phases_s(3, SERIALS, 2.0)[5:6]
    assert phases_s(3, SERIALS, 2.0) != phases_s(4, SERIALS, 2.0)
