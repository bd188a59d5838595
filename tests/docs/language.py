"""Words this project does not use, and what it says instead (the glossary has the full list).

`python tests/docs/language.py PATH ...` lists where they stand.
"""

import re
import sys
from collections.abc import Iterator
from pathlib import Path

INSTEAD = {
    r"told|untold|foretold": "reported, commanded, requested or described",
    r"heard|unheard": "received, in contact; 'telemetry lost'",
    r"said|says|saying|say so": "reported, states, shows",
    r"nobody|somebody|anybody|everybody": "name the role: the operator, the pilot, any client",
    r"ghosts?": "hazard area",
    r"(the|an|an?other|its|each|no|one) eyes?|eye's": "imaging drone (`imager` in code)",
    r"nameless": "unidentified",
    r"newcomers?": "identity grace",
    r"gears?": "simulation mode",
    r"crews?": "available vehicles; scripted operator",
    r"homewards?": "return, return to home",
    r"mishaps?": "fault effects",
    r"complaints?": "validation errors",
    r"advice": "warnings",
    r"manoeuvres?": "flight modes",
    r"claimants?": "claiming links",
    r"sightings?": "vehicle snapshots",
    r"containment": "fault isolation",
    r"stick_?zero": "neutral setpoint",
    r"setpoint leases?": "setpoint stream",
    r"leaders?|(is|are|was) led|leads it": "authority holder; controlled by",
    r"foreseen|foresees?|foreseeing": "predicted",
    r"by and by": "gradually",
    r"for ever": "forever, indefinitely",
    r"in so many words": "explicitly",
    r"not any more|any more": "no longer",
    r"(is|are) (?-i:none)": "does not exist; NaN",
    r"put this answer away": "dismiss",
    r"bark(s|ed)?": "raise an alarm",
    r"who (is|are|flies|has|comes|waits|can|could|moves|stands|leads)": "vehicles that ...",
    r"whoever|whomever": "the client or operator that ...",
    r"people": "operators, users",
    r"in a grower's words": "operator-readable",
    r"time went on": "periodic timer event",
}
"""Each pattern, matched as whole words of prose and as parts of identifiers, any case."""

_BANNED = [
    (re.compile(rf"(?<![a-z])(?:{pattern})(?![a-z])", re.IGNORECASE), instead)
    for pattern, instead in INSTEAD.items()
]
SOURCES = {".py", ".ts", ".tsx", ".css", ".md", ".html", ".toml", ".rs", ".kt"}
QUOTED = ("docs/icd.md", "src/protocol/schema.d.ts")
"""Pages that quote the protocol, and files made from others."""


def findings(file: Path) -> Iterator[str]:
    """Yield a sentence for each banned word of a file."""
    for number, line in enumerate(file.read_text(encoding="utf-8").splitlines(), start=1):
        for pattern, instead in _BANNED:
            for match in pattern.finditer(line):
                yield f"{file}:{number}: '{match.group()}': use {instead}"


def sources(place: Path) -> list[Path]:
    """Return the files under a place that the words are kept out of."""
    files = [place] if place.is_file() else sorted(place.rglob("*"))
    return [
        file
        for file in files
        if file.suffix in SOURCES
        and file.is_file()
        and not {"node_modules", "target"} & set(file.parts)
        and not str(file).endswith(QUOTED)
    ]


if __name__ == "__main__":
    found = [line for place in sys.argv[1:] for f in sources(Path(place)) for line in findings(f)]
    print("\n".join(found))
    print(f"{len(found)} banned words")
