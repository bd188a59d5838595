"""`recon look-aside`: an imaging drone flies 25 m aside and back, and its progress."""

from typing import Annotated

import msgspec
import typer

from recon.cli.connection import (
    DEFAULT_ADDRESS,
    DONE,
    REFUSED,
    AddressOption,
    JsonOption,
    TokenOption,
    WaitOption,
    named_serials,
    read_until,
    run_at_station,
)
from recon.cli.output import print_json, print_line
from recon.client import LookAsideStatus, Station


def look_aside_command(
    vehicle: Annotated[
        str | None,
        typer.Argument(
            metavar="[VEHICLE]",
            help="Serial, or name from site.toml; without one the imaging drone below which light "
            "is unknown, or the site's first.",
        ),
    ] = None,
    wait: WaitOption = 0.0,
    as_json: JsonOption = False,
    address: AddressOption = DEFAULT_ADDRESS,
    token_file: TokenOption = None,
) -> None:
    """Fly an imaging drone 25 m aside and back, to tell even sun from even shade.

    It must hover. Exits once it has begun; with --wait, once it has ended or after that many
    seconds. It continues after the exit: `recon hold` stops it.
    """

    async def work(station: Station) -> int:
        refusal = await station.look_aside(
            named_serials(station, [vehicle])[0] if vehicle is not None else None
        )
        if refusal is not None:
            print_line(f"look aside: refused ({refusal.rule}): {refusal.reason}")
            return REFUSED
        status = await read_until(station.looking_aside, _is_over, wait)
        assert status is not None, "the station has accepted one"
        _print(status, as_json)
        is_good = status.stage == "done" if wait > 0.0 else status.stage != "stopped"
        return DONE if is_good else REFUSED

    run_at_station(address, token_file, work)


def _is_over(status: LookAsideStatus | None) -> bool:
    return status is None or status.is_over


def _print(status: LookAsideStatus, as_json: bool) -> None:
    if as_json:
        print_json(msgspec.to_builtins(status))
        return
    reason = f": {status.reason}" if status.reason else ""
    print_line(
        f"{status.vehicle_name}: look aside to bearing {status.bearing_deg:.0f} deg, "
        f"{status.stage}{reason}"
    )
