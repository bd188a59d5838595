"""Operations: surveys, fleet returns, side-steps, moves upwind, reliefs: done by several orders.

Each is one `Operation`; the kernel, the alarms and the audit go through `OPERATIONS` and know none
by name. Every motion that an operation commands is an order, judged by the gate like any other.
"""

from recon.station.operations.fleet_return import FLEET_RETURN
from recon.station.operations.imager_motion import IMAGER_MOTIONS
from recon.station.operations.imager_relief import IMAGER_RELIEF
from recon.station.operations.operation import Operation
from recon.station.operations.survey import SURVEY

OPERATIONS: tuple[Operation, ...] = (
    FLEET_RETURN,
    *IMAGER_MOTIONS,
    IMAGER_RELIEF,
    SURVEY,
)
"""All operations, in the order of their ticks."""
