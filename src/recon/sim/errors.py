"""What can be wrong with an order to simulate; each error is one sentence for a person.

SimulationError
|-- FaultError         a fault's description cannot be read, or names no vehicle
|-- ReplayError        a folder to replay holds no usable field
`-- FrameSourceError   frames cannot be read, or do not fit
"""

from recon.model.errors import ReconError


class SimulationError(ReconError):
    """The simulation cannot start or go on as asked."""


class FaultError(SimulationError):
    """A fault's description cannot be read, or names no vehicle."""


class ReplayError(SimulationError):
    """A folder to replay holds no usable field."""


class FrameSourceError(SimulationError):
    """Frames cannot be read, or do not fit."""
