"""Login by token: which user a token belongs to, and a limit for wrong ones.

A token has 256 random bits, so guessing it is hopeless at any rate. What is limited is what wrong
tokens cost: audit lines, alarms, and work of the station. Beyond the limit they get 429 without a
line in the audit, and lose their connection. A right token always gets in, also from an address
that sent wrong ones: a tablet with an old token, or a stranger behind the same access point, must
not keep an operator from stopping the vehicles.
"""

import hmac
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from hashlib import sha256
from ipaddress import IPv6Address, IPv6Network, ip_address

from recon.model.event import LoginAccepted, LoginRefused
from recon.model.person import Person, User

WINDOW_S = 60.0
FAILURES_PER_ADDRESS = 5
FAILURES_OVERALL = 50
"""Failures in one window; further wrong tokens get 429."""

MAX_ADDRESSES = 256
"""Addresses with failures that are remembered; the oldest is dropped."""
MAX_LOGINS = 256
"""Logins remembered to write each into the audit once."""

UNAUTHORISED = 401
TOO_MANY = 429

EVERY_ADDRESS = "many addresses"


@dataclass(frozen=True, slots=True)
class RefusedRequest:
    """A refused request: status and sentence; `retry_after_s` beyond the limit of wrong tokens."""

    status: int
    sentence: str
    retry_after_s: int | None = None

    @property
    def is_about_login(self) -> bool:
        """Return whether another token could change it."""
        return self.status in (UNAUTHORISED, TOO_MANY)


WRONG_TOKEN = RefusedRequest(
    UNAUTHORISED,
    "token wrong: it was renewed or its user removed; an administrator gives you another with "
    "`recon user renew`",
)
NO_TOKEN = RefusedRequest(
    UNAUTHORISED,
    "token missing: open the address that `recon user add` printed, or log in with its token",
)


@dataclass(slots=True)
class FailedLogins:
    """Counts wrong tokens per address in windows of `WINDOW_S`, in bounded memory."""

    _windows: dict[str, tuple[float, int]] = field(default_factory=dict)

    def add(self, key: str, now_s: float) -> tuple[int, float]:
        """Count a failure; return how many the window has, and how long it lasts, seconds."""
        began_s, count = self._windows.pop(key, (now_s, 0))
        if not 0.0 <= now_s - began_s < WINDOW_S:
            began_s, count = now_s, 0
        self._windows[key] = (began_s, count + 1)
        if len(self._windows) > MAX_ADDRESSES:
            self._windows.pop(next(iter(self._windows)))
        return count + 1, began_s + WINDOW_S - now_s


class Login:
    """The users that may log in now. `report` takes what the audit and the alarms must know."""

    def __init__(
        self,
        users: Sequence[User] = (),
        report: Callable[[LoginAccepted | LoginRefused], None] = lambda event: None,
        clock_s: Callable[[], float] = time.monotonic,
    ) -> None:
        self.users = tuple(users)
        self._report = report
        self._clock_s = clock_s
        self._by_address, self._overall = FailedLogins(), FailedLogins()
        self._reported: dict[tuple[bytes, str], None] = {}

    def person(self, token: str, address: str) -> Person | RefusedRequest:
        """Return the person with a token, or why it is refused."""
        digest = sha256(token.encode(errors="surrogateescape")).digest()
        user = self._user(digest)
        if user is None:
            return self._failed(address)
        person = Person(user.name, user.role, address)
        if (digest, address) not in self._reported:
            self._reported[digest, address] = None
            if len(self._reported) > MAX_LOGINS:
                self._reported.pop(next(iter(self._reported)))
            self._report(LoginAccepted(person.label, user.role.value))
        return person

    def knows(self, person: Person, token: str) -> bool:
        """Return whether a token still belongs to a person, with the same role."""
        user = self._user(sha256(token.encode(errors="surrogateescape")).digest())
        return user is not None and (user.name, user.role) == (person.name, person.role)

    def _user(self, digest: bytes) -> User | None:
        # All of them, in constant time: how long it takes tells nothing about any of them.
        found = None
        for user in self.users:
            if hmac.compare_digest(user.token_sha256, digest):
                found = user
        return found

    def _failed(self, address: str) -> RefusedRequest:
        now_s = self._clock_s()
        count, left_s = self._by_address.add(_network(address), now_s)
        overall, overall_left_s = self._overall.add(EVERY_ADDRESS, now_s)
        if count <= FAILURES_PER_ADDRESS and overall <= FAILURES_OVERALL:
            self._report(LoginRefused(address, count, count == FAILURES_PER_ADDRESS))
            if overall == FAILURES_OVERALL:
                self._report(LoginRefused(EVERY_ADDRESS, overall, True))
            return WRONG_TOKEN
        wait_s = left_s if count > FAILURES_PER_ADDRESS else overall_left_s
        seconds = max(1, round(wait_s))
        sentence = f"too many wrong tokens: try again in {seconds} s, or with the right token"
        return RefusedRequest(TOO_MANY, sentence, seconds)


def _network(address: str) -> str:
    """Return what failures are counted by: an address, of IPv6 its /64, all one computer's."""
    try:
        parsed = ip_address(address.partition("%")[0])
    except ValueError:
        return address[:64]
    if isinstance(parsed, IPv6Address):
        return str(IPv6Network((parsed, 64), strict=False))
    return str(parsed)
