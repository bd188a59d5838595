"""Mutation testing of what keeps vehicles apart: every change must fail a test.

    python -m studies.mutants              all parts, hours on two cores
    python -m studies.mutants rules guard  some of them

Copies the project to a temporary folder, runs mutmut there for each part, lists the mutants that no
test notices, and ends with 1 when one of them has no written reason in studies/survivors.toml, or a
reason stands there for nothing. A reason is found again by the function and the changed lines, not
by mutmut's numbering.

A mutant whose tests run out of time is not counted as noticed: on a busy machine any of them does,
an unnoticed one too. It is run once more, automatically; what runs out of time again loops forever,
or the machine is too busy to tell, and stands among the survivors until a reason is written.
"""

import shutil
import subprocess
import sys
import tempfile
import tomllib
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from configparser import ConfigParser
from dataclasses import dataclass
from pathlib import Path

PROJECT = Path(__file__).parents[1]
REASONS = Path(__file__).with_name("survivors.toml")
COPIED = ("src", "tests", "vectors", "scenarios", "docs", "benches", "studies", "tools")
KILLED = ("killed", "caught by type check")
TIMEOUT = "timeout"


@dataclass(frozen=True, slots=True)
class Part:
    """Files that are changed together, and the tests that must notice."""

    changed: tuple[str, ...]
    tests: tuple[str, ...]


def _safety(*names: str) -> tuple[str, ...]:
    return tuple(f"src/recon/safety/{name}" for name in names)


PARTS: Mapping[str, Part] = {
    "rules": Part(
        _safety("rules/*.py", "gate.py"),
        ("tests/safety/rules", "tests/safety/test_gate.py", "tests/safety/test_unknown_heights.py"),
    ),
    "trust": Part(
        ("src/recon/fleet/trust.py", "src/recon/fleet/airborne.py"),
        (
            "tests/fleet/test_trust.py",
            "tests/fleet/test_trust_limits.py",
            "tests/fleet/test_airborne.py",
            "tests/fleet/test_airborne_limits.py",
        ),
    ),
    "guard": Part(("src/recon/guard/watch.py",), ("tests/guard",)),
    "failsafe": Part(_safety("failsafe/*.py"), ("tests/safety/failsafe",)),
    "returns": Part(
        _safety("go_home.py", "return_missions.py", "landing_time.py"),
        (
            "tests/safety/test_go_home.py",
            "tests/safety/test_return_missions.py",
            "tests/safety/test_landing_time.py",
            "tests/safety/checks",
        ),
    ),
    "checks": Part(_safety("checks/*.py", "check.py"), ("tests/safety/checks",)),
    "watchdogs": Part(_safety("watchdogs/*.py"), ("tests/safety/watchdogs",)),
    "path": Part(
        _safety("path/*.py"),
        (
            "tests/safety/test_order_path.py",
            "tests/safety/test_path_volumes.py",
            "tests/safety/test_standstill.py",
        ),
    ),
    "prediction": Part(
        _safety("prediction/*.py", "separation_minima.py"),
        (
            "tests/safety/test_prediction.py",
            "tests/safety/test_predicted_orders.py",
            "tests/safety/test_trajectory.py",
            "tests/safety/test_conflicts.py",
            "tests/safety/test_may_conflict.py",
            "tests/safety/test_height_drift.py",
            "tests/safety/test_standstill.py",
            "tests/safety/test_legs.py",
            "tests/safety/test_predicted_flights.py",
            "tests/safety/test_hazard_area.py",
            "tests/safety/test_vehicle_motion.py",
            "tests/safety/test_unknown_heights.py",
            "tests/safety/test_go_home.py",
            "tests/safety/rules/test_separation.py",
        ),
    ),
    "places": Part(
        _safety("airspace.py", "datum.py", "heights.py", "energy.py", "temporary_zones.py"),
        (
            "tests/safety/test_airspace.py",
            "tests/safety/test_datum.py",
            "tests/safety/test_energy.py",
            "tests/safety/test_energy_of_orders.py",
            "tests/safety/test_height_drift.py",
            "tests/safety/test_heights.py",
            "tests/safety/test_temporary_zones.py",
            "tests/safety/test_unknown_heights.py",
            "tests/safety/rules/test_boundary.py",
            "tests/safety/rules/test_height_zones.py",
            "tests/safety/rules/test_keep_out.py",
            "tests/safety/rules/test_max_height.py",
            "tests/safety/rules/test_min_height.py",
        ),
    ),
}
"""By name; small parts first, so that a broken set-up shows within minutes."""


Key = tuple[str, str, str]
"""Function, its lines before, and after."""


@dataclass(frozen=True, slots=True)
class Mutant:
    """One changed function: what was there, what the mutant has instead."""

    name: str
    function: str
    before: str
    after: str

    @property
    def key(self) -> "Key":
        """What a written reason names."""
        return self.function, self.before, self.after


def main(names: Sequence[str]) -> int:
    """Run the named parts, all by default; print the tally and the survivors without a reason."""
    unknown = sorted(set(names) - set(PARTS))
    if unknown:
        print(f"expected parts of {', '.join(PARTS)}; got {', '.join(unknown)}")
        return 2
    reasons, needed, unexplained = _reasons(), set[Key](), 0
    for name in names or PARTS:
        survivors = survivors_of(name)
        needed |= {mutant.key for mutant in survivors}
        unexplained += _report(name, survivors, set(reasons))
    unneeded = set(reasons) - needed if not names else set[Key]()
    for function, before, _after in unneeded:
        print(f"\na reason is written for {function} ({before}), and no such mutant survives")
    return 1 if unexplained or unneeded else 0


def survivors_of(name: str) -> list["Mutant"]:
    """Run one part in a copy of the project; return the mutants that no test noticed."""
    with tempfile.TemporaryDirectory(prefix="recon-mutants-") as folder:
        copy = Path(folder)
        _copy_project(copy, PARTS[name])
        _run(copy)
        late = [mutant for mutant, state in _all_states(copy).items() if state == TIMEOUT]
        if late:
            _run(copy, "--max-children", "1", *late)
        states = _all_states(copy)
        tally = ", ".join(f"{count} {state}" for state, count in Counter(states.values()).items())
        print(f"\n{name}: {tally}", flush=True)
        return [_read(copy, mutant) for mutant, state in states.items() if state not in KILLED]


def _report(name: str, survivors: Sequence["Mutant"], reasons: set["Key"]) -> int:
    unexplained = [mutant for mutant in survivors if mutant.key not in reasons]
    for mutant in unexplained:
        print(f"\nno test notices {mutant.name}, and no reason is written:")
        print(f"  - {mutant.before}\n  + {mutant.after}")
    print(
        f"{name}: {len(survivors)} survivors, {len(unexplained)} without a written reason",
        flush=True,
    )
    return len(unexplained)


def _copy_project(copy: Path, part: Part) -> None:
    ignored = shutil.ignore_patterns("__pycache__")
    for name in COPIED:
        shutil.copytree(PROJECT / name, copy / name, ignore=ignored)
    shutil.copy(PROJECT / "pyproject.toml", copy)
    parser = ConfigParser()
    parser["mutmut"] = {
        "source_paths": _lines("src"),
        "only_mutate": _lines(*part.changed),
        "pytest_add_cli_args": _lines(
            "-p",
            "no:cacheprovider",
            "-p",
            "no:processor_time",
            "-x",
            "--hypothesis-profile=mutants",
        ),
        "pytest_add_cli_args_test_selection": _lines(*part.tests),
        "also_copy": _lines(*(f"{name}/" for name in COPIED[2:])),
        "use_git_change_detection": "false",
        # Few mutants loop for ever: what runs out of time mostly does so on a busy machine.
        "timeout_multiplier": "60.0",
    }
    with (copy / "setup.cfg").open("w", encoding="utf-8") as file:
        parser.write(file)


def _lines(*values: str) -> str:
    return "\n".join(("", *values))


def _run(copy: Path, *arguments: str) -> None:
    # Its progress is a line that turns: for a terminal only.
    shown = None if sys.stdout.isatty() else subprocess.PIPE
    command = [sys.executable, "-m", "mutmut", "run", *arguments]
    done = subprocess.run(command, cwd=copy, stdout=shown, text=True)
    if done.returncode != 0:
        raise SystemExit(f"mutmut ended with {done.returncode}:\n{(done.stdout or '')[-4000:]}")


def _all_states(copy: Path) -> dict[str, str]:
    return dict(_states(_ask(copy, "results", "--all", "true")))


def _ask(copy: Path, *arguments: str) -> str:
    command = [sys.executable, "-m", "mutmut", *arguments]
    done = subprocess.run(command, check=True, capture_output=True, text=True, cwd=copy)
    return done.stdout


def _states(results: str) -> Iterator[tuple[str, str]]:
    for line in results.splitlines():
        name, separator, state = line.strip().rpartition(": ")
        if separator:
            yield name, state


def _read(copy: Path, name: str) -> Mutant:
    lines = _ask(copy, "show", name).splitlines()
    changes = [line for line in lines if line[:1] in "-+" and line[:3] not in ("---", "+++")]
    module, _, rest = name.rpartition(".")
    function = rest.split("__mutmut_")[0].removeprefix("x_")
    before = " ".join(line[1:].strip() for line in changes if line.startswith("-"))
    after = " ".join(line[1:].strip() for line in changes if line.startswith("+"))
    return Mutant(name, f"{module.removeprefix('recon.')}.{function}", before, after)


def _reasons() -> dict[Key, str]:
    entries = tomllib.loads(REASONS.read_text(encoding="utf-8")).get("survivor", [])
    return {(e["function"], e["before"], e["after"]): e["reason"] for e in entries}


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
