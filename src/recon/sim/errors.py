"""What can be wrong with an order to simulate; each error is one sentence for a person."""

from recon.model.errors import ReconError


class SimulationError(ReconError):
    """The simulation cannot start or go on as asked."""


class FaultError(SimulationError):
    """A fault's description cannot be read."""


class FrameSourceError(SimulationError):
    """Frames cannot be read, or do not fit."""
