"""The simulated sky of a recorded flight, found again by what the record states of it."""

from dataclasses import dataclass
from hashlib import sha256
from pathlib import Path

from recon.score.scenario import Scenario
from recon.score.scenario_file import load_scenario
from recon.score.scenario_schema import ScenarioError
from recon.score.scenario_sky import sky_of
from recon.sim.world import Sky

DIGEST_LETTERS = 16


@dataclass(frozen=True, slots=True)
class Truth:
    """A simulated sky, and the station's time at which its time was zero."""

    scenario: Scenario
    sky: Sky
    zero_ns: int


def world_text(path: Path, seed: int, zero_ns: int) -> str:
    """Return what a record states of its simulated world: file, seed, zero of its time, digest."""
    return f"{path.name} {seed} {zero_ns} {_digest(path)}"


def truth_of(text: str, path: Path | None, folder: Path) -> Truth | None:
    """Return the sky of a record's text: of the scenario at `path`, else of its name in `folder`.

    None for a flight of real aircraft. Raises `ScenarioError` where the file is missing or is not
    the one that was flown.
    """
    words = text.split(" ")
    if text == "":
        return None
    if len(words) != 4 or not (words[1].isdecimal() and words[2].isdecimal()):
        raise ScenarioError(f"expected file, seed, time and digest of a scenario, got {text!a:.80}")
    name, seed, zero_ns, digest = words[0], int(words[1]), int(words[2]), words[3]
    path = folder / Path(name).name if path is None else path
    if not path.is_file():
        raise ScenarioError(f"{path}: not found; name the scenario {name!a:.80} with --scenario")
    if _digest(path) != digest:
        raise ScenarioError(f"{path}: this is not the scenario as it was flown: its text differs")
    scenario = load_scenario(path)
    return Truth(scenario, sky_of(scenario, seed), zero_ns)


def _digest(path: Path) -> str:
    try:
        return sha256(path.read_bytes()).hexdigest()[:DIGEST_LETTERS]
    except OSError as problem:
        raise ScenarioError(f"{path}: cannot be read: {problem.strerror}") from problem
