"""Times of a flight as people at the field read them, beside UTC."""

from dataclasses import dataclass
from datetime import UTC, datetime, tzinfo

from recon.model.units import NS_PER_S


@dataclass(frozen=True, slots=True)
class LocalTime:
    """Local time of one flight; `zone` None is that of this computer."""

    zone: tzinfo | None
    utc_ahead_ns: int
    """Added to station time it gives UTC."""

    def at(self, at_ns: int) -> datetime:
        """Return a station time as local time."""
        utc = datetime.fromtimestamp((at_ns + self.utc_ahead_ns) // NS_PER_S, UTC)
        return utc.astimezone(self.zone)

    def clock(self, at_ns: int) -> str:
        """Return a station time as hours, minutes and seconds."""
        return f"{self.at(at_ns):%H:%M:%S}"

    def name(self, at_ns: int) -> str:
        """Return the zone in words: its distance from UTC, and whose it is."""
        offset = f"{self.at(at_ns):%z}"
        whose = "this computer's zone" if self.zone is None else str(self.zone)
        return f"UTC{offset[:3]}:{offset[3:5]}, {whose}"
