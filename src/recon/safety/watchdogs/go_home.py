"""Compares each flight home by an aircraft's own go-home with what the site asks of it."""

from collections.abc import Iterator

from recon.model.control import Commanded
from recon.safety.go_home import LANDING, deviations
from recon.safety.watchdogs.traffic_picture import Finding, TrafficPicture

RULE = "go_home"


def go_home(picture: TrafficPicture) -> Iterator[Finding]:
    """Find vehicles that go home at another height, elsewhere, or not at all."""
    for watched in picture.flying:
        for found in deviations(watched.state, picture.now_ns, picture.go_home):
            lands_as_ordered = watched.intent.commanded is Commanded.LAND and found.kind == LANDING
            if not lands_as_ordered:
                yield watched.finding(
                    RULE, found.severity, found.text, about=f":{found.kind}", after_s=found.after_s
                )
