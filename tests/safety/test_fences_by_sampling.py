"""The fence rules say what an independent, slow checker measures; `make study` draws 10,000."""

import pytest
from tests.examples import family
from tests.oracles.drawn_fences import RULES, compare

from recon.geo import Footprints
from recon.model.command import Command, Refusal
from recon.safety.path.pieces import UnknownPath
from recon.safety.path.volumes import path_volume
from recon.safety.situation import Situation

SEEDS = (range(20_000, 20_100), range(20_100, 20_300))
"""None that `make study` draws too."""


def boundary_at_corners_only(command: Command, situation: Situation) -> Refusal | None:
    """What fences get wrong elsewhere: only the ends of the legs are looked at."""
    fence, path = situation.airspace.boundary, path_volume(command, situation)
    if fence is None or path is None or isinstance(path, UnknownPath):
        return None
    corners_m = path.pieces.triangles_m.reshape(-1, 1, 2).repeat(3, axis=1)
    margin_m = situation.airspace.airspace.limits.boundary_margin_m
    inside = fence.holds(Footprints(corners_m), margin_m)
    return None if inside.all() else Refusal("corners", "a corner is outside")


@pytest.mark.parametrize("seeds", family(*SEEDS))
def test_the_rules_agree_with_dense_sampling_on_every_drawn_scene(seeds: range) -> None:
    found = compare(seeds)
    assert found.disagreements == []
    for name in RULES:
        assert found.kept[name] > 0
        assert found.broken[name] > 0


@pytest.mark.flight
def test_the_sampling_finds_out_a_fence_that_looks_at_corners_only() -> None:
    found = compare(range(20_000, 20_100), {"boundary": boundary_at_corners_only})
    assert found.disagreements
    assert all("approves" in text for text in found.disagreements)
