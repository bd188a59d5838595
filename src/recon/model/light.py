"""What light sensors on the ground state."""

from dataclasses import dataclass

from recon.model.geo import LatLon


@dataclass(frozen=True, slots=True)
class LightReading:
    """One value of one sensor, in its own unit."""

    sensor: str
    at_ns: int
    """Unix time, as its logger states it."""
    value: float
    place: LatLon | None = None
    """None where its logger has not stated it."""


@dataclass(frozen=True, slots=True)
class LightRead:
    """Readings came from a logger, or lines of it were refused."""

    source: str
    """The logger: its address, or the file's name."""
    readings: tuple[LightReading, ...] = ()
    refused: int = 0
    """Lines that could not be used since the last event."""
    problem: str = ""
    """Why the newest of them could not."""
