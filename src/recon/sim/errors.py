"""Errors of the simulator; each message is one sentence for the operator.

SimulationError
|-- FaultError         a fault's description is invalid, or selects no vehicle
|-- ReplayError        a replay folder has no usable field
`-- FrameSourceError   frames cannot be read, or have the wrong size
"""

from recon.model.errors import ReconError


class SimulationError(ReconError):
    """The simulation cannot start or continue as configured."""


class FaultError(SimulationError):
    """A fault's description is invalid, or selects no vehicle."""


class ReplayError(SimulationError):
    """A replay folder has no usable field."""


class FrameSourceError(SimulationError):
    """Frames cannot be read, or have the wrong size."""
