"""`recon side-step` and `recon relieve`: orders to imaging drones, and their progress."""

from collections.abc import Awaitable, Callable
from typing import Annotated, TypeVar

import msgspec
import typer

from recon.cli.connection import JsonOption, WaitOption, named_serials, read_until, station_command
from recon.cli.exit_codes import DONE, REFUSED
from recon.cli.output import print_json, print_line
from recon.client import ImagerReliefStatus, Refusal, SideStepStatus, Station

Motion = TypeVar("Motion", SideStepStatus, ImagerReliefStatus)


@station_command
async def side_step_command(
    station: Station,
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
) -> int:
    """Fly 25 m aside and back, to tell whether a uniform scene is all sun or all shade.

    The imaging drone must hover. Exits once it has begun; with --wait, once it has ended or after
    that many seconds. It continues after the exit: `recon hold` stops it.
    """
    serial = named_serials(station, [vehicle])[0] if vehicle is not None else None
    refusal = await station.side_step(serial)
    read = station.side_stepping
    return await _followed("side-step", refusal, read, wait, _side_step_text, as_json)


@station_command
async def relieve_command(
    station: Station,
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
) -> int:
    """Relieve an imaging drone, or send it back to its place with a fresh battery.

    The spare drone flies to the place in a layer of its own; once its shade maps show the ground,
    the other one is recalled. Exits once it has begun; with --wait, once it has ended or after
    that many seconds. It continues after the exit: `recon hold` stops it.
    """
    serials = named_serials(station, [vehicle] if spare is None else [vehicle, spare])
    refusal = await station.relieve(serials[0], serials[-1], takeoff=takeoff)
    return await _followed("relieve", refusal, station.relieving, wait, _relief_text, as_json)


async def _followed(
    order: str,
    refusal: Refusal | None,
    read: Callable[[], Awaitable[Motion | None]],
    wait_s: float,
    text_of: Callable[[Motion], str],
    as_json: bool,
) -> int:
    """Print how an accepted order goes, or why it was refused; return the exit code."""
    if refusal is not None:
        print_line(f"{order}: refused ({refusal.rule}): {refusal.reason}")
        return REFUSED
    status = await read_until(read, lambda one: one is None or one.is_over, wait_s)
    assert status is not None, "the station has accepted one"
    if as_json:
        print_json(msgspec.to_builtins(status))
    else:
        reason = f": {status.reason}" if status.reason else ""
        print_line(f"{status.vehicle_name}: {text_of(status)}{reason}")
    is_good = status.stage == "done" if wait_s > 0.0 else status.stage != "stopped"
    return DONE if is_good else REFUSED


def _side_step_text(status: SideStepStatus) -> str:
    return f"side-step to bearing {status.bearing_deg:.0f} deg, {status.stage}"


def _relief_text(status: ImagerReliefStatus) -> str:
    is_its_own = status.serial == status.relieved
    what = "return to its place" if is_its_own else f"relief of {status.relieved_name}"
    return f"{what}, {status.stage.replace('_', ' ')}"
