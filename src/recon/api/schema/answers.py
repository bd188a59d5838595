"""What the station answers to an order."""

from pydantic import Field

from recon.api.schema.message import Message


class WordResponse(Message):
    """What became of a word that is no order: taken, or refused by a rule for a reason."""

    accepted: bool
    rule: str | None
    reason: str | None


class OrderResult(Message):
    """What became of an order for one vehicle: accepted with a command id, or refused."""

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
    repairs: list[str] = Field(description="what was changed in a mission so that DJI accepts it")
    parts: int = Field(description="in how many parts a mission is flown; 0 for other orders")


class OrderResponse(Message):
    """One result for each vehicle named."""

    results: list[OrderResult]


class Problem(Message):
    """Why a request was not carried out."""

    error: str
