"""Finished runs on disk, one file per seed, so that a stopped command resumes where it was.

The folder's name holds a digest of all that a run follows from besides its seed: the scenario's
files, the methods, the rooms of Recon that fly it and the libraries that compute. Whatever of
these changes, older runs are no longer found.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cache
from hashlib import sha256
from importlib.metadata import version
from importlib.util import find_spec
from pathlib import Path

import msgspec

import recon
from recon.detection import DETECTORS
from recon.forecast import FORECASTERS
from recon.guidance.survey import PLANNERS
from recon.score.run_score import RunScore
from recon.score.scenario import Scenario
from recon.score.scenario_schema import ScenarioError
from recon.site.reading import site_digest

COMPUTING = ("numpy", "opencv-python-headless", "scipy", "msgspec")
CODE = (".py", ".so", ".pyd")
ROOMS_WITHOUT_RUNS = ("cli", "client", "product")
"""No run imports them: with a change there, it is still the same."""
LARGEST_BYTES = 50_000_000
DIGEST_LETTERS = 16


@cache
def code_digest() -> str:
    """Return SHA-256 over Recon's installed code that flies runs, and the versions of the libraries
    it computes with."""
    total = sha256(" ".join(f"{name} {version(name)}" for name in COMPUTING).encode())
    package = Path(recon.__file__).parent
    paths = {path.relative_to(package): path for path in package.rglob("*") if path.suffix in CODE}
    for name, path in sorted(paths.items()):
        if name.parts[0] not in ROOMS_WITHOUT_RUNS:
            total.update(name.as_posix().encode() + path.read_bytes())
    return total.hexdigest()


def runs_digest(file: Path, scenario: Scenario, code: str) -> str:
    """Return the digest of what the runs of a scenario's file, with these methods, follow from.

    Raises `ScenarioError` for a file that cannot be read.
    """
    methods, conditions = scenario.methods, scenario.conditions
    chosen = (methods, scenario.survey.planner, conditions.exposure_locked)
    total = sha256(f"{code} {chosen!r}".encode())
    try:
        for path in (file, *scenario.files):
            content = site_digest(path).encode() if path.is_dir() else path.read_bytes()
            total.update(len(content).to_bytes(8, "big") + content)
    except OSError as problem:
        why = problem.strerror or str(problem)
        raise ScenarioError(f"{problem.filename}: cannot read scenario file: {why}") from problem
    return total.hexdigest()


def flown_code(scenario: Scenario) -> str:
    """Return the digest of all code that flies a scenario: Recon's, and that of other packages."""
    return " ".join((code_digest(), *_outside_code(scenario)))


def _outside_code(scenario: Scenario) -> Iterator[str]:
    """Yield the digests of the methods of installed packages that a scenario names."""
    methods = scenario.methods
    forecasts = methods.forecast, *methods.compared
    used = [(PLANNERS.outside, scenario.survey.planner), (DETECTORS.outside, methods.detection)]
    for outside, name in (*used, *((FORECASTERS.outside, each) for each in forecasts)):
        if name in outside:
            spec = find_spec(outside[name].module.partition(".")[0])
            yield name if spec is None or spec.origin is None else _digest_of(Path(spec.origin))


def _digest_of(module: Path) -> str:
    """Return SHA-256 over a module's code, or that of its whole package."""
    is_package = module.stem == "__init__"
    paths = [path for path in module.parent.rglob("*") if path.suffix in CODE] if is_package else ()
    total = sha256()
    for path in sorted(paths) or [module]:
        total.update(path.name.encode() + path.read_bytes())
    return total.hexdigest()


@dataclass(frozen=True, slots=True)
class KeptRuns:
    """The finished runs of one scenario in a folder of their own."""

    folder: Path

    @classmethod
    def of(cls, folder: Path, file: Path, scenario: Scenario) -> "KeptRuns":
        """Return those of a scenario's file, below a folder. Raises `ScenarioError`."""
        digest = runs_digest(file, scenario, flown_code(scenario))[:DIGEST_LETTERS]
        return cls(folder / f"{scenario.name}-{digest}")

    def found(self, seed: int) -> RunScore | None:
        """Return a seed's run; None without one, or with a damaged file."""
        try:
            path = self._path(seed)
            if path.stat().st_size > LARGEST_BYTES:
                return None
            run: RunScore = msgspec.msgpack.decode(path.read_bytes(), type=RunScore)
        except (OSError, msgspec.MsgspecError):
            return None
        return run if run.seed == seed else None

    def keep(self, run: RunScore) -> None:
        """Write a run. Raises `ScenarioError`."""
        path = self._path(run.seed)
        part = path.with_suffix(".part")
        try:
            self.folder.mkdir(parents=True, exist_ok=True)
            part.write_bytes(msgspec.msgpack.encode(run))
            # A stopped command must not leave half a file.
            part.replace(path)
        except OSError as problem:
            why = problem.strerror or str(problem)
            raise ScenarioError(f"{path}: expected a place for finished runs, got: {why}") from None

    def _path(self, seed: int) -> Path:
        return self.folder / f"seed-{seed}.msgpack"
