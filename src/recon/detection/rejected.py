"""Frames that no shade is read from."""

from dataclasses import dataclass
from enum import Enum


class FrameFault(Enum):
    """What is wrong with a frame."""

    OTHER_PLACE = "other_place"
    """Laid in another local frame than the field's, or beside its grid."""
    NOT_NEWER = "not_newer"
    REPEATED = "repeated"
    BLACK = "black"
    TORN = "torn"


@dataclass(frozen=True, slots=True)
class RejectedFrame:
    """A frame that was not used; the detection's state is as before."""

    frame_id: int
    fault: FrameFault
    reason: str
    """For people: what was expected, what came."""
