"""The log that the companion app shares after a flight, as `recon inspect` shows it.

A line is a time in UTC, a kind and a text; lines of the kind `told` are texts of the extension
`recon 1` (docs/icd.md). A log comes from a phone: what cannot be read is counted and left out.
"""

import json
import re
from collections import Counter
from collections.abc import Iterator
from dataclasses import asdict, dataclass, field
from typing import BinaryIO, NamedTuple, TextIO

from recon.model.app_report import AppFacts, OutcomeReport, PhotosReport
from recon.vehicles.printable import printable

LONGEST_LINE_BYTES = 8192
_START = re.compile(rb"\d{4}-\d\d-")
_LINE = re.compile(rb"(\d{4}-\d\d-\d\dT\d\d:\d\d:\d\d(?:\.\d{1,9})?Z) ([a-z]{1,16}) +(.*)")


class AppLogLine(NamedTuple):
    """One line: its time as it is written, its kind, and its text made safe for a terminal."""

    time: str
    kind: str
    text: str
    raw: bytes


@dataclass(slots=True)
class AppLogSummary:
    """What a person who was not there asks first."""

    first: str = ""
    last: str = ""
    kinds: Counter[str] = field(default_factory=Counter)
    unread: int = 0
    versions: list[str] = field(default_factory=list)
    facts: AppFacts | None = None
    photos: dict[int, set[int]] = field(default_factory=dict)
    failed: Counter[str] = field(default_factory=Counter)

    def add(self, line: AppLogLine) -> None:
        """Count a line."""
        self.first, self.last = self.first or line.time, line.time
        self.kinds[line.kind] += 1
        if line.kind == "start" and line.text not in self.versions[:10]:
            self.versions.append(line.text)
        if line.kind == "told":
            self._add_report(line.raw)

    def _add_report(self, raw: bytes) -> None:
        from recon.vehicles.app_texts import read_app_text

        report = read_app_text(raw)
        if isinstance(report, AppFacts):
            self.facts = report
        elif isinstance(report, PhotosReport):
            self.photos.setdefault(report.series, set()).update(
                each.index for each in report.photos
            )
        elif isinstance(report, OutcomeReport) and not report.ok:
            self.failed[f"{report.action.value} {report.code or 'without a code'}"] += 1

    def lines(self) -> Iterator[str]:
        """Yield the summary."""
        kinds = ", ".join(f"{kind} {count}" for kind, count in sorted(self.kinds.items()))
        yield f"app log from {self.first} to {self.last}: {kinds}; {self.unread} lines not read"
        yield from (f"started: {each}" for each in self.versions)
        if self.facts is not None:
            known = {k: v for k, v in asdict(self.facts).items() if v is not None}
            yield "last facts: " + ", ".join(f"{key} {value}" for key, value in known.items())
        for series, indexes in self.photos.items():
            yield f"photos of series {series}: {len(indexes)} told of {max(indexes)}"
        yield from (f"failed {count} times: {what}" for what, count in self.failed.items())


def is_app_log(start: bytes) -> bool:
    """Return whether a file that starts so is the log of the app."""
    return _START.match(start) is not None


def show_app_log(start: bytes, source: BinaryIO, json_lines: bool, out: TextIO) -> bool:
    """Write each line and the summary to `out`; return whether there was a line."""
    summary = AppLogSummary()
    for raw in _raw_lines(start, source):
        found = _LINE.fullmatch(raw)
        if found is None:
            summary.unread += 1
            continue
        time, kind, text = found.groups()
        line = AppLogLine(time.decode(), kind.decode(), printable(text, LONGEST_LINE_BYTES), text)
        summary.add(line)
        shown = {"time": line.time, "kind": line.kind, "text": line.text}
        print(json.dumps(shown) if json_lines else "  ".join(shown.values()), file=out)
    for each in summary.lines():
        print(json.dumps({"summary": each}) if json_lines else each, file=out)
    return bool(summary.kinds)


def _raw_lines(start: bytes, source: BinaryIO) -> Iterator[bytes]:
    """Yield lines without their end; a longer line comes in pieces, which are no lines of a log."""
    line = start + source.readline(LONGEST_LINE_BYTES)
    while line:
        yield line.rstrip(b"\r\n")
        line = source.readline(LONGEST_LINE_BYTES)
