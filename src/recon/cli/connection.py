"""What every command that connects to a running station shares: its address, names, ends."""

import asyncio
import inspect
import os
import time
from collections.abc import Awaitable, Callable, Sequence
from dataclasses import dataclass
from functools import wraps
from inspect import Parameter
from pathlib import Path
from typing import Annotated, Any, TypeVar

import typer

from recon.cli.options import with_options
from recon.client import ClientError, Station, Telemetry
from recon.client.errors import AddressError

Seen = TypeVar("Seen")
READ_EVERY_S = 0.5

DEFAULT_ADDRESS = "http://127.0.0.1:8080"
MAX_TOKEN_BYTES = 4096
FINGERPRINT_VARIABLE = "RECON_FINGERPRINT"
"""SHA-256 of the certificate of an https address, as the station prints it."""

AddressOption = Annotated[
    str, typer.Option("--station", envvar="RECON_STATION", help="Address of the station's console.")
]
TokenOption = Annotated[
    Path | None,
    typer.Option(
        "--token-file", envvar="RECON_TOKEN_FILE", help="File with the station's access token."
    ),
]
JsonOption = Annotated[bool, typer.Option("--json", help="Print JSON.")]
WaitOption = Annotated[
    float,
    typer.Option(
        "--wait",
        min=0.0,
        max=3600.0,
        help="Seconds to wait for confirmation by telemetry; 0: none.",
    ),
]
NamesArgument = Annotated[
    list[str] | None, typer.Argument(metavar="VEHICLE...", help="Serials, or names from site.toml.")
]
NameArgument = Annotated[
    str, typer.Argument(metavar="VEHICLE", help="Serial, or name from site.toml.")
]

Work = Callable[[Station], Awaitable[int]]


@dataclass(frozen=True, slots=True, kw_only=True)
class StationOptions:
    """Where the station is, and what admits to it."""

    address: AddressOption = DEFAULT_ADDRESS
    token_file: TokenOption = None


class VehicleNameError(ClientError):
    """A name that matches no vehicle, or several."""


def station_command(work: Callable[..., Awaitable[int]]) -> Callable[..., None]:
    """Return a command of what is done at a connected station: its options, and the station's.

    The first parameter is the station; what is returned is the exit code.
    """

    def run(at: StationOptions, **values: Any) -> None:
        run_at_station(at, lambda station: work(station, **values))

    _, *own = inspect.signature(work).parameters.values()
    shown = [*own, Parameter("at", Parameter.KEYWORD_ONLY, annotation=StationOptions)]
    return with_options(wraps(work)(run), shown)


def run_at_station(at: StationOptions, work: Work) -> None:
    """Connect, run `work` and exit with its exit code; raises `ClientError`s."""
    raise typer.Exit(asyncio.run(_connected(station_at(at), work)))


def station_at(at: StationOptions, *, is_operator: bool = True) -> Station:
    """Return the station of a command's options, not yet connected; raises `AddressError`."""
    fingerprint = os.environ.get(FINGERPRINT_VARIABLE)
    token = read_token(at.token_file)
    return Station(at.address, token, fingerprint=fingerprint, is_operator=is_operator)


async def _connected(unopened: Station, work: Work) -> int:
    async with unopened as station:
        return await work(station)


def read_token(path: Path | None) -> str | None:
    """Return the access token in a file; raises `AddressError` when it cannot be read."""
    if path is None:
        return None
    try:
        with path.open("rb") as file:
            return file.read(MAX_TOKEN_BYTES).decode("utf-8").strip()
    except (OSError, UnicodeDecodeError) as problem:
        raise AddressError(f"cannot read the token file {path}: {problem}") from problem


async def read_until(
    read: Callable[[], Awaitable[Seen]], is_enough: Callable[[Seen], bool], timeout_s: float
) -> Seen:
    """Read again and again until it is enough or the time is over; return what was read last."""
    end_s = time.monotonic() + timeout_s
    while True:
        seen = await read()
        if is_enough(seen) or time.monotonic() >= end_s:
            return seen
        await asyncio.sleep(READ_EVERY_S)


def named_serials(station: Station, names: Sequence[str] | None) -> list[str]:
    """Return the serial of each name, each once; raises `VehicleNameError`, also without names.

    A serial takes precedence over an equal name. Names match in any case.
    """
    known = station.vehicles()
    if not names:
        raise VehicleNameError(f"name the vehicles; connected are: {_choices(known)}")
    return list(dict.fromkeys(_serial_of(name, known) for name in names))


def _serial_of(name: str, known: Sequence[Telemetry]) -> str:
    serials = [v.serial for v in known if v.serial is not None]
    if name in serials:
        return name
    matches = [v.serial for v in known if v.name.casefold() == name.casefold() and v.serial]
    if len(matches) == 1:
        return matches[0]
    if matches:
        raise VehicleNameError(f"{len(matches)} vehicles have the name {name!r}: use a serial")
    raise VehicleNameError(
        f"expected a vehicle's serial or name, got {name!r}; connected vehicles: {_choices(known)}"
    )


def _choices(known: Sequence[Telemetry]) -> str:
    return ", ".join(f"{v.serial} ({v.name})" for v in known if v.serial) or "none"
