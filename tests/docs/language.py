"""Metaphors that this project does not use, and the terms that it uses instead.

`python tests/docs/language.py PATH ...` lists where they are.
"""

import re
import sys
from collections.abc import Iterator
from pathlib import Path

INSTEAD = {
    r"ghosts?": "hazard area",
    r"(the|an|an?other|its|each|no|one) eyes?|eye's": "imaging drone (`imager` in code)",
    r"bark(s|ed)?": "raise an alarm",
    r"crews?": "available vehicles; scripted operator",
    r"gears?": "simulation mode",
    r"homewards?": "return, return to home",
    r"told\.py|told_\w+|\w+_told": "reported, commanded, requested",
    r"nameless": "unidentified",
    r"mishaps?": "fault effects",
    r"sightings?": "vehicle snapshots",
}
"""The ten metaphors, matched as whole words of prose and as parts of identifiers, any case.

All other English is free: the words of a sentence are its writer's business.
"""

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
