"""The users file: who may log in at a station from other computers, with which role.

    format = 1
    [[user]]
    name = "anna"
    role = "pilot"
    token_sha256 = "9f86..."
    created_utc = "2026-05-01T09:30:00Z"

It holds no token. A change is written to a temporary file that is created exclusively, so that two
changes at once cannot lose one, and then replaces the file as a whole. Only its owner may write it:
another user of the computer could add an administrator.
"""

import os
import re
import stat
import sys
import tomllib
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Annotated

import msgspec

from recon.model.errors import RecordError
from recon.model.person import LONGEST_NAME, Role, User, is_name

FORMAT = 1
MAX_USERS = 64
MAX_BYTES = 64 * 1024
"""64 users take 15 KiB."""

_SHA256 = re.compile(r"[0-9a-f]{64}")
_Text = Annotated[str, msgspec.Meta(max_length=200)]


class _UserTable(msgspec.Struct, forbid_unknown_fields=True):
    name: _Text
    role: Role
    token_sha256: _Text
    created_utc: _Text


class _UsersTables(msgspec.Struct, forbid_unknown_fields=True):
    format: int
    user: Annotated[list[_UserTable], msgspec.Meta(max_length=MAX_USERS)] = []


def default_users_file(environment: Mapping[str, str] = os.environ) -> Path:
    """Return the users file of this computer's user: one for all sites and ports."""
    return state_folder(environment) / "users.toml"


def state_folder(environment: Mapping[str, str] = os.environ) -> Path:
    """Return Recon's folder among the state of this computer's user."""
    if sys.platform == "win32":
        base = Path(environment.get("LOCALAPPDATA") or Path.home() / "AppData" / "Local")
    else:
        base = Path(environment.get("XDG_STATE_HOME") or Path.home() / ".local" / "state")
    return base / "recon"


def read_users(path: Path) -> tuple[User, ...]:
    """Return the users in a file, none without a file; raises `RecordError`."""
    try:
        with path.open("rb") as file:
            _require_owner_only(path, os.fstat(file.fileno()).st_mode)
            data = file.read(MAX_BYTES + 1)
    except FileNotFoundError:
        return ()
    except OSError as problem:
        raise RecordError(f"cannot read the users file {path}: {problem.strerror}") from problem
    return _parsed(path, data)


def change_users(path: Path, change: Callable[[tuple[User, ...]], Sequence[User]]) -> None:
    """Replace the users by `change` of them, atomically; raises `RecordError`."""
    temporary = path.with_name(path.name + ".tmp")
    try:
        path.parent.mkdir(parents=True, exist_ok=True, mode=0o700)
        # Windows has no such modes; there the folder of the user's profile is private.
        file = os.open(temporary, os.O_CREAT | os.O_EXCL | os.O_WRONLY, 0o600)
    except FileExistsError as problem:
        raise RecordError(
            f"{temporary} exists: another change of the users is under way, or one was "
            "interrupted; if no other `recon user` runs, delete that file and try again"
        ) from problem
    except OSError as problem:
        raise RecordError(f"cannot write {temporary}: {problem.strerror}") from problem
    try:
        with os.fdopen(file, "wb") as opened:
            opened.write(_encoded(path, change(read_users(path))))
            opened.flush()
            os.fsync(opened.fileno())
        os.replace(temporary, path)
    except OSError as problem:
        temporary.unlink(missing_ok=True)
        raise RecordError(f"cannot write the users file {path}: {problem.strerror}") from problem
    except BaseException:
        temporary.unlink(missing_ok=True)
        raise


def _require_owner_only(path: Path, mode: int) -> None:
    if not stat.S_ISREG(mode):
        raise RecordError(f"{path}: expected a users file, got a folder or device")
    if sys.platform != "win32" and mode & (stat.S_IWGRP | stat.S_IWOTH):
        raise RecordError(
            f"{path}: other users of this computer can write it, and so add an administrator; run "
            f"`chmod 600 {path}`"
        )


def _parsed(path: Path, data: bytes) -> tuple[User, ...]:
    if len(data) > MAX_BYTES:
        raise RecordError(f"{path}: expected up to {MAX_BYTES} bytes, got more")
    try:
        tables = msgspec.convert(tomllib.loads(data.decode("utf-8")), _UsersTables)
    except (ValueError, RecursionError) as problem:
        reason = str(problem) or type(problem).__name__
        raise RecordError(
            f"{path}: expected users as `recon user` writes them: {reason}"
        ) from problem
    if tables.format != FORMAT:
        raise RecordError(f"{path}: expected format {FORMAT}, got {tables.format}")
    users = tuple(_user(path, table) for table in tables.user)
    _require_distinct(path, users)
    return users


def _user(path: Path, table: _UserTable) -> User:
    if not is_name(table.name):
        raise RecordError(
            f"{path}: name must be 1 to {LONGEST_NAME} ASCII letters, digits, '.', '_' or '-'; got "
            f"{table.name!r}"
        )
    if _SHA256.fullmatch(table.token_sha256) is None:
        raise RecordError(f"{path}: token_sha256 of {table.name} must be 64 hexadecimal digits")
    digest = bytes.fromhex(table.token_sha256)
    return User(table.name, table.role, digest, table.created_utc)


def _require_distinct(path: Path, users: Sequence[User]) -> None:
    names = [user.name.casefold() for user in users]
    if len(set(names)) < len(names):
        raise RecordError(f"{path}: each name must appear once; letter case does not distinguish")
    if len({user.token_sha256 for user in users}) < len(users):
        raise RecordError(
            f"{path}: two users have the same token; renew one with `recon user renew`"
        )


def _encoded(path: Path, users: Sequence[User]) -> bytes:
    if len(users) > MAX_USERS:
        raise RecordError(f"{path}: expected up to {MAX_USERS} users; remove one first")
    lines = [
        "# The users of Recon stations on this computer. Change it with `recon user`.",
        "format = 1",
    ]
    for user in users:
        created = "".join(
            c for c in user.created_utc if c.isascii() and c not in '"\\' and c.isprintable()
        )
        lines += [
            "",
            "[[user]]",
            f'name = "{user.name}"',
            f'role = "{user.role.value}"',
            f'token_sha256 = "{user.token_sha256.hex()}"',
            f'created_utc = "{created}"',
        ]
    return ("\n".join(lines) + "\n").encode("ascii")
