"""What every command that speaks to a running station shares: where it is, and how it ends.

Exit codes: 0 done; 1 refused, or not shown by telemetry to be done; 2 wrong use, or no connection.
"""

import asyncio
from collections.abc import Awaitable, Callable
from pathlib import Path
from typing import Annotated

import typer

from recon.client import Station
from recon.client.errors import AddressError

DONE, REFUSED, NO_USE = 0, 1, 2

DEFAULT_ADDRESS = "http://127.0.0.1:8080"
LARGEST_TOKEN_BYTES = 4096

StationOption = Annotated[
    str, typer.Option("--station", envvar="RECON_STATION", help="Address of the station's console.")
]
TokenOption = Annotated[
    Path | None,
    typer.Option(
        "--token-file", envvar="RECON_TOKEN_FILE", help="File with the station's secret, if any."
    ),
]
JsonOption = Annotated[bool, typer.Option("--json", help="Tell it as JSON, for programs.")]
WaitOption = Annotated[
    float,
    typer.Option(
        "--wait", min=0.0, max=3600.0, help="Seconds to wait for telemetry to confirm; 0: none."
    ),
]
NamesArgument = Annotated[
    list[str] | None, typer.Argument(metavar="VEHICLE...", help="Serials, or names of the site.")
]
NameArgument = Annotated[str, typer.Argument(metavar="VEHICLE", help="Its serial or its name.")]

Work = Callable[[Station], Awaitable[int]]


def at_station(address: str, token_file: Path | None, work: Work) -> None:
    """Do work at a station and end with its exit code; raises `ClientError`s."""
    raise typer.Exit(asyncio.run(_at_station(address, read_secret(token_file), work)))


async def _at_station(address: str, token: str | None, work: Work) -> int:
    async with Station(address, token) as station:
        return await work(station)


def read_secret(path: Path | None) -> str | None:
    """Return the secret in a file; raises `AddressError` when it cannot be read."""
    if path is None:
        return None
    try:
        with path.open("rb") as file:
            return file.read(LARGEST_TOKEN_BYTES).decode("utf-8").strip()
    except (OSError, UnicodeDecodeError) as problem:
        raise AddressError(f"cannot read the token file {path}: {problem}") from problem
