"""Messages about access: the person of a request, and how other computers reach the console."""

from typing import Literal

from recon.api.schema.message import Message


class AccessView(Message):
    """The person of this request. `is_logged_in`: by a token, not as this computer's user.

    `urls` and `fingerprint` are of the console for other computers; empty and null without one.
    """

    name: str
    role: Literal["observer", "pilot", "operator", "admin"]
    is_logged_in: bool
    urls: list[str]
    fingerprint: str | None
