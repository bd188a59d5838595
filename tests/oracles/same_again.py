"""The same scenes in two processes, compared to the bit.

Eight vehicles with commands and sticks; the same with faults of links, apps and aircraft over links
that delay and damage; the same with an imaging drone whose frames are rendered and read. The
processes hash strings by different seeds, so that no order of a set or dictionary decides anything.
"""

import argparse
import os
import subprocess
import sys
from collections.abc import Mapping
from random import Random

from tests.oracles.eight_vehicles import EightVehicles, eight_vehicles
from tests.oracles.run_digest import RunDigest

from recon.sim.fake_link import FakeLink

FAULTS = (
    "gusts:1:5:20",
    "bursts:2:10:10",
    "second-link:3:8:8",
    "restart:4:12:3",
    "half-open:5:10:10",
    "corrupted-bytes:6:5:20",
    "slow-reader:7:10:20",
    "telemetry-dropout:8:4:3",
    "delayed-acks:3:10:20",
    "pilot-takes:2:14:5",
)
SEES_FOR_S = 8.0
"""Rendered frames are slow, and a few show as much as many."""
HASH_SEEDS = ("1", "2")
DAMAGED_SHARE = 0.02


def scenes(seed: int) -> Mapping[str, EightVehicles]:
    """Return the scenes by name, at their start."""
    return {
        "flights": eight_vehicles(seed),
        "faults": eight_vehicles(seed, faults=FAULTS, make_link=lambda: bad_link(seed)),
        "pictures": eight_vehicles(seed, sees=True),
    }


def digests(seed: int, seconds: float) -> dict[str, str]:
    """Return for each scene its number of events and their digest."""
    found = {}
    for name, scene in scenes(seed).items():
        digest = RunDigest(scene.driver)
        scene.run_for(min(seconds, SEES_FOR_S) if name == "pictures" else seconds)
        found[name] = f"{digest.events} events, {digest.value()}"
    return found


def bad_link(seed: int) -> FakeLink:
    """Return a link that delays and damages."""
    return FakeLink(jitter_s=0.05, damage=_damaged, seed=seed)


def _damaged(chunk: bytes, random: Random) -> bytes:
    if random.random() >= DAMAGED_SHARE:
        return chunk
    place = random.randrange(len(chunk))
    return chunk[:place] + bytes([chunk[place] ^ 0x10]) + chunk[place + 1 :]


def in_another_process(seed: int, seconds: float, hash_seed: str) -> list[str]:
    """Return the digests that another process prints for the same scenes."""
    command = [sys.executable, "-m", "tests.oracles.same_again", "--once"]
    arguments = ["--seed", str(seed), "--seconds", str(seconds)]
    done = subprocess.run(
        [*command, *arguments],
        env={**os.environ, "PYTHONHASHSEED": hash_seed},
        stdout=subprocess.PIPE,
        text=True,
        check=True,
    )
    return done.stdout.splitlines()


def main() -> int:
    """Run the scenes twice and compare; or once, for the other process."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0] if __doc__ else "")
    parser.add_argument("--seconds", type=float, default=60.0)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--once", action="store_true", help="run here, and print the digests")
    options = parser.parse_args()
    if options.once:
        for name, digest in digests(options.seed, options.seconds).items():
            print(f"{name}: {digest}")
        return 0
    first, second = (in_another_process(options.seed, options.seconds, each) for each in HASH_SEEDS)
    for one, other in zip(first, second, strict=True):
        print(f"{one}: {'the same again' if one == other else f'differs: {other}'}")
    return 0 if first == second else 1


if __name__ == "__main__":
    sys.exit(main())
