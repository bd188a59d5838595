"""Virtual time runs the same again: in another process, and however it is cut into pieces."""

from dataclasses import replace

import numpy as np
import pytest
from tests.oracles.eight_vehicles import eight_vehicles
from tests.oracles.run_digest import RunDigest, parts_of
from tests.oracles.same_again import FAULTS, HASH_SEEDS, in_another_process

from recon.model.event import CommandAnswered, CommandSent, Event, LinkClosed
from recon.station.state.station import Station
from recon.station.state.steps import JobDone

SECONDS = 20.0


@pytest.mark.flight
def test_eight_vehicles_with_commands_faults_and_pictures_in_two_processes() -> None:
    """The processes hash strings by different seeds: no order of a set decides anything."""
    first, second = (in_another_process(3, SECONDS, each) for each in HASH_SEEDS)
    assert first == second
    assert [line.split(":")[0] for line in first] == ["flights", "faults", "pictures"]


@pytest.mark.flight
def test_the_scene_has_commands_answers_closed_links_and_jobs() -> None:
    seen: list[Event] = []
    scene = eight_vehicles(3, sees=True, faults=FAULTS)
    scene.driver.observe = lambda step: seen.append(step.event)
    scene.run_for(13.0)
    kinds = {type(event) for event in seen}
    assert {CommandSent, CommandAnswered, LinkClosed, JobDone} <= kinds
    assert scene.driver.station.shade.number >= 2
    assert len(scene.driver.station.fleet.vehicles) == 8


def test_another_seed_is_another_run() -> None:
    assert digest_of(1, [5.0]) != digest_of(2, [5.0])


@pytest.mark.parametrize("pieces_s", [[0.01] * 400, [0.13, 1.87, 1.0, 1.0]])
def test_run_for_in_any_pieces_gives_the_same_run(pieces_s: list[float]) -> None:
    """The driver skips steps at which nothing is due; where it stops it advances every peer."""
    assert digest_of(3, pieces_s) == digest_of(3, [4.0])


def digest_of(seed: int, pieces_s: list[float]) -> str:
    """What a run of the driver alone comes to, with a damaged and a second link in it."""
    scene = eight_vehicles(seed, faults=("corrupted-bytes:1:0:9", "bursts:2:0:9"))
    digest = RunDigest(scene.driver)
    scene.order("SIM-1", scene.mission("SIM-1"))
    for seconds in pieces_s:
        scene.driver.run_for(seconds)
    return digest.value()


def test_the_digest_sees_one_pixel_and_the_last_bit() -> None:
    assert whole(np.zeros((2, 2))) != whole(np.eye(2))
    assert whole(np.zeros(4)) != whole(np.zeros((2, 2)))
    assert whole(0.1 + 0.2) != whole(0.3)
    station = Station()
    assert whole(station) == whole(Station())
    assert whole(station) != whole(replace(station, next_frame_id=2))
    with pytest.raises(TypeError, match="plain parts"):
        whole(object())


def whole(value: object) -> bytes:
    return b"".join(parts_of(value))
