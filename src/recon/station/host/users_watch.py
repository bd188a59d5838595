"""Follows the users file while the station runs: `recon user` takes effect within a second.

A file that cannot be used changes nothing: a mistake in it must not keep pilots from stopping their
vehicles. An alarm states the mistake.
"""

import asyncio
from collections.abc import Callable, Sequence
from pathlib import Path

from recon.api.login import Login
from recon.model.errors import RecordError
from recon.model.event import UsersChanged
from recon.model.person import User
from recon.record.files.users_file import read_users

EVERY_S = 1.0


class UsersWatch:
    """Keeps the users of a `Login` as the file has them."""

    def __init__(self, path: Path, login: Login, report: Callable[[UsersChanged], None]) -> None:
        self._path = path
        self._login = login
        self._report = report
        self._problem: str | None = None

    async def run(self) -> None:
        """Read the file once a second, on a thread, until cancelled."""
        while True:
            await asyncio.sleep(EVERY_S)
            self._take(*await asyncio.to_thread(self._read))

    def read(self) -> None:
        """Read the file now."""
        self._take(*self._read())

    def _take(self, users: Sequence[User] | None, problem: str | None) -> None:
        """Take what was read: the users, or why the file cannot be used."""
        if problem is not None and problem != self._problem:
            self._report(UsersChanged("", problem))
        self._problem = problem
        if users is None:
            return
        change = _change(self._login.users, users)
        self._login.users = tuple(users)
        if change:
            self._report(UsersChanged(change))

    def _read(self) -> tuple[tuple[User, ...] | None, str | None]:
        try:
            users = read_users(self._path)
        except RecordError as problem:
            return None, str(problem)
        if not users and self._login.users and not self._path.exists():
            return None, f"the users file {self._path} is gone; `recon user remove` removes users"
        return users, None


def _change(before: Sequence[User], after: Sequence[User]) -> str:
    """Return what changed, in words; empty if nothing."""
    old = {user.name: user for user in before}
    new = {user.name: user for user in after}
    parts = [f"{name} removed" for name in old if name not in new]
    parts += [f"{name} added as {user.role.value}" for name, user in new.items() if name not in old]
    for name, user in new.items():
        was = old.get(name, user)
        if was.role is not user.role:
            parts.append(f"{name} is now {user.role.value}")
        if was.token_sha256 != user.token_sha256:
            parts.append(f"{name} has a new token")
    return "users: " + "; ".join(parts) if parts else ""
