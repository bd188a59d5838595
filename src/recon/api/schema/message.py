"""What every message of the API is."""

from pydantic import BaseModel, ConfigDict


class Message(BaseModel):
    """Base of all messages: immutable, and unknown keys are refused."""

    model_config = ConfigDict(frozen=True, extra="forbid")
