"""The hours in which a survey fits, as text and as JSON."""

from collections.abc import Sequence
from dataclasses import dataclass
from datetime import date
from typing import Any

from recon.guidance.flying_hours import Fit, FlyingLimits, FlyingSpan
from recon.site.local_time import local_time


@dataclass(frozen=True, slots=True)
class FlyingDay:
    """A day at the site, and its spans."""

    day: date
    offset_s: float
    spans: Sequence[FlyingSpan]

    @property
    def row(self) -> tuple[str, str]:
        """The day and its fitting hours."""
        fitting = [self.hours(span) for span in self.spans if span.fit is Fit.FITS]
        return f"{self.day:%a %Y-%m-%d}", ", ".join(fitting) or "none"

    def hours(self, span: FlyingSpan) -> str:
        """Return from when to when, by the clock there."""
        return " - ".join(self.clock(each) for each in (span.from_utc_s, span.to_utc_s))

    def clock(self, utc_s: float) -> str:
        """Return a time of the day; its end is 24:00."""
        at = local_time(utc_s, self.offset_s)
        return f"{at:%H:%M}" if at.date() == self.day else "24:00"

    def others(self, limits: FlyingLimits) -> list[str]:
        """Return a sentence on each span that does not fit, and on sun without weather."""
        return [
            f"{self.day:%a %Y-%m-%d} {self.hours(span)}: {sentence}"
            for span in self.spans
            if (sentence := _sentence(span, limits))
        ]

    def as_json(self, limits: FlyingLimits) -> dict[str, Any]:
        """Return the day with all of its spans."""
        return {"date": self.day.isoformat(), "spans": [self._span(s, limits) for s in self.spans]}

    def _span(self, span: FlyingSpan, limits: FlyingLimits) -> dict[str, Any]:
        return {
            "from": self.clock(span.from_utc_s),
            "to": self.clock(span.to_utc_s),
            "from_utc_s": span.from_utc_s,
            "to_utc_s": span.to_utc_s,
            "fit": span.fit.value,
            "has_weather": span.cloud_share is not None,
            "sentence": _sentence(span, limits),
        }


def _sentence(span: FlyingSpan, limits: FlyingLimits) -> str:
    low, high = span.sun_deg
    if span.fit is Fit.LOW_SUN:
        if high <= 0.0:
            return "the sun is down"
        return f"the sun is below {limits.lowest_sun_deg:g} degrees, {high:.0f} at most"
    if span.fit is Fit.HOT_SPOT:
        return (
            f"the hot spot is in the picture: the sun is {low:.0f} to {high:.0f} degrees high, "
            f"more than {limits.highest_sun_deg:.0f}"
        )
    if span.fit is Fit.CLOUD and span.cloud_share is not None:
        least, most = (f"{100.0 * each:.0f}" for each in span.cloud_share)
        covers = most if least == most else f"{least} to {most}"
        return (
            f"clouds cover {covers} % of the sky, more than {100.0 * limits.most_cloud_share:g} %"
        )
    return ""
