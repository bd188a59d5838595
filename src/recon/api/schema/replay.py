"""A recorded flight in the console."""

from typing import Literal

from pydantic import Field

from recon.api.schema.message import Message, StrictMessage


class ReplayView(Message):
    """Where a replay is in its record; a state's `time_ns` is the record's own time."""

    file: str
    duration_s: float
    position_s: float = Field(description="since the record's first state")
    speed: float = Field(description="times the recorded speed")
    is_playing: bool
    trouble: str | None = Field(description="why the record ends early; null: it does not")


class ReplayMark(Message):
    """An alarm that was raised, or an order that was given, refused or failed."""

    at_s: float = Field(description="since the record's first state")
    kind: Literal["alarm", "order"]
    text: str


class ReplayMarksView(Message):
    """The marks of a record, by time."""

    marks: list[ReplayMark]
    read_share: float = Field(description="of the record, from which they were read so far")


class ReplayTransport(StrictMessage):
    """What to change; null leaves it as it is."""

    is_playing: bool | None = None
    speed: float | None = Field(default=None, ge=0.1, le=50.0, strict=False)
    position_s: float | None = Field(
        default=None, ge=0.0, le=1e7, strict=False, description="beyond the end: the end"
    )
