"""The fleet's thresholds, each with its reason."""

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class FleetSettings:
    """Times in seconds."""

    takeover_silence_s: float = 1.0
    """A rival link becomes the vehicle when the old link stays silent this long after the rival's
    serial arrived (an app that reconnects while its old socket still looks alive)."""

    conflict_silence_s: float = 3.0
    """In a declared conflict the old link keeps command until it is silent this long: longer than
    the dropouts of a second or two that running video causes."""

    track_interval_s: float = 1.0
    """The track keeps one point a second: enough to see a path, little to keep."""

    track_points: int = 600
    """Ten minutes of track."""

    vehicles_kept: int = 64
    """An app that names a new serial again and again must not fill the memory: beyond this, the
    vehicles on the ground that have no link and were silent longest are forgotten; while this many
    without a link may fly, no new serial is accepted."""

    closed_links_kept: int = 32
    """Closed links kept for display with the reason they closed."""
