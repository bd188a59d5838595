"""Who gives orders: a person with a role, as the API has authenticated them."""

import re
from dataclasses import dataclass
from enum import StrEnum

LONGEST_NAME = 32
NAME = re.compile(r"[A-Za-z0-9](?:[A-Za-z0-9._-]{0,31})")
"""Names appear in audit lines and on terminals: one ASCII word, so that no two look alike by
invisible letters, and no name contains another person's line."""

THIS_COMPUTER = "this computer"
"""Stands for the address of a request over loopback, which needs no login."""


class Role(StrEnum):
    """What a person may do, each role all of the one before."""

    OBSERVER = "observer"
    PILOT = "pilot"
    OPERATOR = "operator"
    ADMIN = "admin"

    def includes(self, needed: "Role") -> bool:
        """Return whether this role may do what `needed` may."""
        order = tuple(Role)
        return order.index(self) >= order.index(needed)


@dataclass(frozen=True, slots=True)
class Person:
    """A person who asks the station for something.

    `address` is where the request came from; empty without one.
    """

    name: str
    role: Role
    address: str = ""

    @property
    def label(self) -> str:
        """The text for the audit, alarms and order records: name and address."""
        return f"{self.name} ({self.address})" if self.address else self.name


@dataclass(frozen=True, slots=True)
class User:
    """A person that may log in, as the users file has it.

    Of the token only the SHA-256 is kept. A fast hash is right for it: a token has 256 random bits,
    which no search finds, however fast it hashes. Slow hashes are for passwords that users choose.
    """

    name: str
    role: Role
    token_sha256: bytes
    created_utc: str


def is_name(text: str) -> bool:
    """Return whether a text can be a person's name."""
    return NAME.fullmatch(text) is not None
