"""`recon user`: who may log in at the station from other computers, with which role."""

import secrets
from collections.abc import Sequence
from dataclasses import replace
from datetime import UTC, datetime
from hashlib import sha256
from pathlib import Path
from typing import Annotated

import typer

from recon.cli.commands import App
from recon.cli.output import print_line
from recon.cli.qr import qr_lines
from recon.model.errors import ReconError
from recon.model.person import LONGEST_NAME, Role, User, is_name
from recon.record.files.users_file import change_users, default_users_file, read_users

user_app = App(help="Manage the users of the console on other computers.", no_args_is_help=True)

TOKEN_BYTES = 32
DEFAULT_PORT = 8443

UsersOption = Annotated[
    Path | None,
    typer.Option("--users", help="The users file; default: one for each user of this computer."),
]
NameArgument = Annotated[str, typer.Argument(metavar="NAME", help="The user's name.")]
AtOption = Annotated[
    str | None,
    typer.Option(
        "--at", metavar="URL", help="Address of the station; default: this computer, port 8443."
    ),
]


class UserError(ReconError):
    """A user that cannot be added, or is not there."""


@user_app.command("add")
def add_command(
    name: NameArgument,
    role: Annotated[Role, typer.Option(help="What the user may do.")],
    at: AtOption = None,
    users: UsersOption = None,
) -> None:
    """Add a user and print the token, once, with the address to open."""
    if not is_name(name):
        raise UserError(
            f"name must be 1 to {LONGEST_NAME} ASCII letters, digits, '.', '_' or '-', the first a "
            f"letter or digit; got {name[:80]!r}"
        )

    def added(known: tuple[User, ...], token: str) -> Sequence[User]:
        if any(user.name.casefold() == name.casefold() for user in known):
            raise UserError(f"user {name} exists; `recon user renew {name}` prints another token")
        return (*known, User(name, role, _digest(token), _now()))

    token = secrets.token_urlsafe(TOKEN_BYTES)
    change_users(users or default_users_file(), lambda known: added(known, token))
    _print_token(f"{name} may log in as {role.value}", token, at)


@user_app.command("list")
def list_command(users: UsersOption = None) -> None:
    """List the users with their roles."""
    path = users or default_users_file()
    known = read_users(path)
    for user in known:
        print_line(f"{user.name:<{LONGEST_NAME}}  {user.role.value:<8}  since {user.created_utc}")
    if not known:
        print_line(f"no users in {path}; add one with `recon user add NAME --role operator`")


@user_app.command("remove")
def remove_command(name: NameArgument, users: UsersOption = None) -> None:
    """Remove a user; a running station ends its streams within two seconds."""

    def without(known: tuple[User, ...]) -> Sequence[User]:
        gone = _named(known, name)
        return [user for user in known if user is not gone]

    change_users(users or default_users_file(), without)
    print_line(f"{name} is removed and logged out")


@user_app.command("renew")
def renew_command(name: NameArgument, at: AtOption = None, users: UsersOption = None) -> None:
    """Print another token for a user; the one before ends."""
    token = secrets.token_urlsafe(TOKEN_BYTES)

    def renewed(known: tuple[User, ...]) -> Sequence[User]:
        old = _named(known, name)
        new = replace(old, token_sha256=_digest(token), created_utc=_now())
        return [new if user is old else user for user in known]

    change_users(users or default_users_file(), renewed)
    _print_token(f"{name} has a new token, the one before no longer works", token, at)


def _named(known: Sequence[User], name: str) -> User:
    for user in known:
        if user.name == name:
            return user
    names = ", ".join(user.name for user in known) or "none"
    raise UserError(f"expected a user's name, got {name[:80]!r}; users: {names}")


def _print_token(sentence: str, token: str, at: str | None) -> None:
    # Imported here: `recon run` needs this module for an option only.
    from recon.api.addresses import EVERY_ADDRESS, in_url, reachable_addresses

    hosts = reachable_addresses(next(iter(EVERY_ADDRESS)))
    urls = [at.rstrip("/")] if at is not None else [_url(in_url(host)) for host in hosts]
    print_line(f"{sentence}. The token is shown this once:")
    print_line(f"  token: {token}")
    for url in urls:
        print_line(f"  open:  {url}/#token={token}")
    for line in qr_lines(f"{urls[0]}/#token={token}"):
        print_line(line)
    print_line("A running station with --https-host takes it within two seconds.")


def _url(host: str) -> str:
    return f"https://{host}:{DEFAULT_PORT}"


def _digest(token: str) -> bytes:
    return sha256(token.encode()).digest()


def _now() -> str:
    return f"{datetime.now(UTC):%Y-%m-%dT%H:%M:%SZ}"
