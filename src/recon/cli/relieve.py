"""`recon relieve`: an imaging drone takes the place of another, or returns to its own."""

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
from recon.client import ImagerReliefStatus, Station


def relieve_command(
    vehicle: Annotated[
        str,
        typer.Argument(metavar="VEHICLE", help="The imaging drone whose place is taken."),
    ],
    spare: Annotated[
        str | None,
        typer.Argument(
            metavar="[SPARE]",
            help="The imaging drone that takes it; without one VEHICLE returns to its own place.",
        ),
    ] = None,
    takeoff: Annotated[
        bool, typer.Option("--takeoff", help="Allow takeoff for this relief.")
    ] = False,
    wait: WaitOption = 0.0,
    as_json: JsonOption = False,
    address: AddressOption = DEFAULT_ADDRESS,
    token_file: TokenOption = None,
) -> None:
    """Relieve an imaging drone, or send it back to its place with a fresh battery.

    The spare drone flies to the place in a layer of its own; once its shade maps show the ground,
    the other one is called home. Exits once it has begun; with --wait, once it has ended or after
    that many seconds. It continues after the exit: `recon hold` stops it.
    """

    async def work(station: Station) -> int:
        serials = named_serials(station, [vehicle] if spare is None else [vehicle, spare])
        refusal = await station.relieve(serials[0], serials[-1], takeoff=takeoff)
        if refusal is not None:
            print_line(f"relieve: refused ({refusal.rule}): {refusal.reason}")
            return REFUSED
        status = await read_until(station.relieving, _is_over, wait)
        assert status is not None, "the station has accepted one"
        _print(status, as_json)
        is_good = status.stage == "done" if wait > 0.0 else status.stage != "stopped"
        return DONE if is_good else REFUSED

    run_at_station(address, token_file, work)


def _is_over(status: ImagerReliefStatus | None) -> bool:
    return status is None or status.is_over


def _print(status: ImagerReliefStatus, as_json: bool) -> None:
    if as_json:
        print_json(msgspec.to_builtins(status))
        return
    is_its_own = status.serial == status.relieved
    what = "return to its place" if is_its_own else f"relief of {status.relieved_name}"
    stage = status.stage.replace("_", " ")
    reason = f": {status.reason}" if status.reason else ""
    print_line(f"{status.vehicle_name}: {what}, {stage}{reason}")
