"""The base classes of all messages, and the responses that every room uses."""

from pydantic import BaseModel, ConfigDict, Field


class Message(BaseModel):
    """Base of all messages: immutable, and unknown keys are refused."""

    model_config = ConfigDict(frozen=True, extra="forbid")


class StrictMessage(Message):
    """Base of requests: no value is converted from another type ("yes" is not true)."""

    model_config = ConfigDict(frozen=True, extra="forbid", strict=True)


class GivenRequest(StrictMessage):
    """Base of requests that must arrive soon after their person gave them."""

    given_at_unix_ms: int | None = Field(
        default=None,
        ge=0,
        le=2**53,
        description=(
            "when its person gave it, in Unix milliseconds of the station's time (a state's "
            "`time_ns` and the time since then) or of a clock set by NTP; null: now. What moves a "
            "vehicle is refused when given more than 5 s ago or in the future; stops are never late"
        ),
    )

    @property
    def given_at_ns(self) -> int | None:
        """Return when it was given, in nanoseconds; None: now."""
        return None if self.given_at_unix_ms is None else self.given_at_unix_ms * 1_000_000


class ActionResponse(Message):
    """The outcome of an operator command that is no order: accepted, or refused with a reason."""

    accepted: bool
    rule: str | None
    reason: str | None


class OrderResult(Message):
    """The outcome of an order for one vehicle: accepted with a command id, or refused."""

    serial: str | None
    link_id: int | None
    vehicle_name: str
    is_simulated: bool
    accepted: bool
    command_id: int
    rule: str | None
    reason: str | None
    parameters: dict[str, float | int | str] = Field(
        description="a refusal's measured values and limits, by name with unit"
    )
    repairs: list[str] = Field(description="changes made to a mission so that DJI accepts it")
    parts: int = Field(description="number of parts of a mission; 0 for other orders")


class OrderResponse(Message):
    """One result for each named vehicle."""

    results: list[OrderResult]


class Problem(Message):
    """Why a request failed, in one sentence."""

    error: str
