"""Mutation testing of the gate's rules: every change of a rule must fail a test.

    python -m studies.mutants

Runs mutmut (configured in pyproject.toml), lists the mutants no test notices, and ends with 1 when
one of them has no written reason in studies/survivors.toml, or a reason stands there for nothing.
A reason is found again by the function and the changed lines, not by mutmut's numbering.

A mutant whose tests run out of time is not counted as noticed: on a busy machine any of them does,
an unnoticed one too. It is run once more, by itself; what runs out of time again loops forever, or
the machine is too busy to tell, and stands among the survivors until a reason is written.
"""

import subprocess
import sys
import tomllib
from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

REASONS = Path(__file__).with_name("survivors.toml")
KILLED = ("killed", "caught by type check")
TIMEOUT = "timeout"


@dataclass(frozen=True, slots=True)
class Mutant:
    """One changed function: what was there, what the mutant has instead."""

    name: str
    function: str
    before: str
    after: str

    @property
    def key(self) -> tuple[str, str, str]:
        """What a written reason names."""
        return self.function, self.before, self.after


def main() -> int:
    """Run everything; print the tally and the survivors without a reason."""
    _run()
    late = [name for name, state in _all_states().items() if state == TIMEOUT]
    if late:
        _run("--max-children", "1", *late)
    states = _all_states()
    print(", ".join(f"{count} {state}" for state, count in Counter(states.values()).items()))
    survivors = [_read(name) for name, state in states.items() if state not in KILLED]
    reasons = _reasons()
    unexplained = [mutant for mutant in survivors if mutant.key not in reasons]
    unneeded = set(reasons) - {mutant.key for mutant in survivors}
    for mutant in unexplained:
        print(f"\nno test notices {mutant.name}, and no reason is written:")
        print(f"  - {mutant.before}\n  + {mutant.after}")
    for function, before, _after in unneeded:
        print(f"\na reason is written for {function} ({before}), and no such mutant survives")
    print(f"{len(survivors)} survivors, {len(unexplained)} without a written reason")
    return 1 if unexplained or unneeded else 0


def _run(*arguments: str) -> None:
    subprocess.run([sys.executable, "-m", "mutmut", "run", *arguments], check=True)


def _all_states() -> dict[str, str]:
    return dict(_states(_ask("results", "--all", "true")))


def _ask(*arguments: str) -> str:
    command = [sys.executable, "-m", "mutmut", *arguments]
    return subprocess.run(command, check=True, capture_output=True, text=True).stdout


def _states(results: str) -> Iterator[tuple[str, str]]:
    for line in results.splitlines():
        name, separator, state = line.strip().rpartition(": ")
        if separator:
            yield name, state


def _read(name: str) -> Mutant:
    lines = _ask("show", name).splitlines()
    changes = [line for line in lines if line[:1] in "-+" and line[:3] not in ("---", "+++")]
    module, _, rest = name.rpartition(".")
    function = rest.split("__mutmut_")[0].removeprefix("x_")
    before = " ".join(line[1:].strip() for line in changes if line.startswith("-"))
    after = " ".join(line[1:].strip() for line in changes if line.startswith("+"))
    return Mutant(name, f"{module.removeprefix('recon.')}.{function}", before, after)


def _reasons() -> dict[tuple[str, str, str], str]:
    entries = tomllib.loads(REASONS.read_text(encoding="utf-8")).get("survivor", [])
    return {(e["function"], e["before"], e["after"]): e["reason"] for e in entries}


if __name__ == "__main__":
    sys.exit(main())
