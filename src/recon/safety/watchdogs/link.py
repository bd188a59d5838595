"""Warns of a vehicle in the air that has said nothing for a second; from 3 s on it is lost."""

from collections.abc import Iterator

from recon.model.severity import Severity
from recon.model.units import NS_PER_S
from recon.safety.watchdogs.finding import Finding
from recon.safety.watchdogs.picture import Picture

RULE = "link_late"


def link(picture: Picture) -> Iterator[Finding]:
    """Find the vehicles in the air whose core telemetry is late."""
    for watched in picture.watched:
        at_ns = watched.state.core_received_at_ns
        if at_ns is None:
            continue
        age_s = (picture.now_ns - at_ns) / NS_PER_S
        if picture.settings.link_late_s <= age_s < picture.prediction.stale_s:
            yield watched.finding(RULE, Severity.WARNING, "no telemetry for more than a second")
