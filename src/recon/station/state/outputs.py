"""What the station's step asks the driver to do."""

from dataclasses import dataclass
from typing import Any

from recon.fleet.step import CloseLink
from recon.safety import ApprovedCommand
from recon.station.state.jobs import Job


@dataclass(frozen=True, slots=True)
class SendCommand:
    """Queue an approved command on its links."""

    approved: ApprovedCommand


@dataclass(frozen=True, slots=True)
class WithdrawMotion:
    """Remove unsent motion commands from these links' queues: another holder has control."""

    link_ids: tuple[int, ...]
    reason: str


Output = SendCommand | CloseLink | WithdrawMotion | Job[Any, Any]
"""A `Job` is started by the worker and comes back as an event."""
