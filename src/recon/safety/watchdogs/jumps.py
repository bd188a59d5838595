"""Notices a position that no flight explains."""

from collections.abc import Iterator
from math import hypot

from recon.model.severity import Severity
from recon.model.units import NS_PER_S
from recon.safety.watchdogs.finding import Finding
from recon.safety.watchdogs.picture import Picture, WatchedVehicle

RULE = "position_jump"


def jumps(picture: Picture) -> Iterator[Finding]:
    """Find vehicles whose newest position does not follow from the one before."""
    for watched in picture.watched:
        jump_m = _jump_m(watched, picture)
        if jump_m is not None:
            text = f"its position has jumped by {jump_m:.0f} m; it may not be where it is shown"
            yield watched.finding(RULE, Severity.ERROR, text)


def _jump_m(watched: WatchedVehicle, picture: Picture) -> float | None:
    """How far, when that is more than its speed and the times' uncertainty allow."""
    before, flyer, at_ns = watched.before, watched.flyer, watched.state.position.received_at_ns
    if before is None or flyer is None or at_ns is None or at_ns <= before.at_ns:
        return None
    settings, between_s = picture.settings, (at_ns - before.at_ns) / NS_PER_S
    was_m = flyer.plane.east_north_m(before.place)
    moved_m = hypot(flyer.east_m - was_m[0], flyer.north_m - was_m[1])
    fastest_mps = max(before.speed_mps, flyer.speed_mps)
    allowed_m = settings.jump_m + settings.jump_per_s * between_s
    allowed_m += fastest_mps * (between_s + settings.burst_s)
    return moved_m if moved_m > allowed_m else None
