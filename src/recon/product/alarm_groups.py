"""Alarms of a report: the same alarm, raised again and again, in one row with a count."""

import re
from collections.abc import Iterable
from dataclasses import dataclass

from recon.product.report import AlarmSpan

MEASURED = re.compile(r"-?\d+\.\d+|-?\d+(?= ?(?:%|°|(?:s|min|h|m|km|V|m/s)\b))")
"""What differs from one time to the next: a value with its unit. Names of vehicles stay."""


@dataclass(frozen=True, slots=True)
class AlarmGroup:
    """One alarm, as often as it was raised."""

    spans: tuple[AlarmSpan, ...]
    """In the order of time."""

    def lasted_ns(self, end_ns: int) -> int:
        """Return the time of all of them together; `end_ns` is the record's end."""
        ends = (end_ns if each.ended_ns is None else each.ended_ns for each in self.spans)
        return sum(end - each.began_ns for end, each in zip(ends, self.spans, strict=True))


def grouped(alarms: Iterable[AlarmSpan]) -> list[AlarmGroup]:
    """Return alarms by what they say but for measured values; the order is that of the first."""
    found: dict[tuple[str, str], list[AlarmSpan]] = {}
    for each in alarms:
        found.setdefault((each.severity, MEASURED.sub("#", each.text)), []).append(each)
    return [
        AlarmGroup(tuple(sorted(spans, key=lambda span: span.began_ns))) for spans in found.values()
    ]
