"""Notices a stream of sticks that has run dry."""

from collections.abc import Iterator

from recon.model.severity import Severity
from recon.safety.watchdogs.finding import Finding
from recon.safety.watchdogs.picture import Picture

RULE = "stick_starved"


def sticks(picture: Picture) -> Iterator[Finding]:
    """Find vehicles under a steered order to which no stick has gone out for too long."""
    for watched in picture.watched:
        quiet_s = watched.stick_quiet_s
        if quiet_s is not None and quiet_s > picture.settings.stick_quiet_s:
            text = (
                f"no stick has left for it for {quiet_s:.1f} s though it is steered; its app "
                "should stop it within 1 s: if it moves on, hold it, or have its pilot stop it"
            )
            yield watched.finding(RULE, Severity.ERROR, text)
