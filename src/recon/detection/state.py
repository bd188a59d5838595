"""What a detector remembers from frame to frame; bounded, and never changed in place."""

from dataclasses import dataclass

from recon.detection.cells import CellLight
from recon.detection.exposure import Exposure
from recon.detection.history import LightHistory
from recon.model.geo import GroundGrid


@dataclass(frozen=True, slots=True, eq=False)
class DetectionState:
    """One state for all methods, so that a method may be changed in flight."""

    grid: GroundGrid | None = None
    """The field's grid, once a frame came."""
    serial: str = ""
    """Whose camera the rest is of."""
    latest: CellLight | None = None
    """The newest frame that was used, and when it was taken."""
    latest_ns: int | None = None
    exposure: Exposure | None = None
    history: LightHistory | None = None
