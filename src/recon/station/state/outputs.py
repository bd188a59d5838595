"""What the station's step wants done."""

from dataclasses import dataclass

from recon.fleet.step import CloseLink
from recon.safety import ApprovedCommand


@dataclass(frozen=True, slots=True)
class SendCommand:
    """Hand an approved command to its links."""

    approved: ApprovedCommand


@dataclass(frozen=True, slots=True, eq=False)
class StartWork:
    """Give heavy work to the worker; it comes back as a `WorkerResult`."""

    job_id: int
    kind: str
    payload: object


@dataclass(frozen=True, slots=True)
class WithdrawMotion:
    """Take orders to move that wait unsent out of these links' queues: somebody else flies now."""

    link_ids: tuple[int, ...]
    reason: str


Output = SendCommand | CloseLink | StartWork | WithdrawMotion
