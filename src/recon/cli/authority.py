"""What an operator decides about vehicles without sending them anything.

`recon take`, `release`: control authority. `preflight`: the checklist, and overriding it.
`dismiss`: a lost vehicle's hazard area. `separation-hold`: automatic holds.
"""

from enum import Enum
from typing import Annotated

import msgspec
import typer

from recon.cli.connection import (
    JsonOption,
    NameArgument,
    NamesArgument,
    VehicleNameError,
    named_serials,
    station_command,
)
from recon.cli.exit_codes import DONE, REFUSED
from recon.cli.failsafe_table import print_failsafe_matrix
from recon.cli.output import print_json, print_line, print_table
from recon.client import Preflight, Refusal, Station


class Receiver(Enum):
    """Receiver of control authority."""

    PILOT = "pilot"
    GUIDANCE = "guidance"


class Switch(Enum):
    """Switch position, on or off."""

    ON = "on"
    OFF = "off"


@station_command
async def take_command(
    station: Station,
    vehicles: NamesArgument = None,
    take_over: Annotated[
        bool, typer.Option("--take-over", help="Also from another person who operates them.")
    ] = False,
) -> int:
    """Take control authority for the operator.

    From then on only your orders set these vehicles in motion. Nothing is sent to them, but what
    another person steers stops and holds.
    """
    control = "operator control"
    done = [
        _is_done(serial, await station.known(serial).take(take_over=take_over), control)
        for serial in named_serials(station, vehicles)
    ]
    return DONE if all(done) else REFUSED


@station_command
async def release_command(
    station: Station,
    vehicles: NamesArgument = None,
    to: Annotated[Receiver, typer.Option("--to", help="The new holder.")] = Receiver.PILOT,
) -> int:
    """Hand control authority to the pilot or to guidance.

    Nothing is sent to the vehicles.
    """
    done: list[bool] = []
    for serial in named_serials(station, vehicles):
        known = station.known(serial)
        give = known.give_to_pilot if to is Receiver.PILOT else known.give_to_guidance
        done.append(_is_done(serial, await give(), f"{to.value} control"))
    return DONE if all(done) else REFUSED


@station_command
async def preflight_command(
    station: Station,
    vehicle: NameArgument,
    override: Annotated[
        str | None,
        typer.Option("--override", metavar="REASON", help="Allow missions anyway; audited."),
    ] = None,
    as_json: JsonOption = False,
) -> int:
    """Show a vehicle's checklist.

    With it the failsafe matrix of the site. Exit code 0 when missions are allowed: passed, or
    overridden.
    """
    (serial,) = named_serials(station, [vehicle])
    known = station.known(serial)
    if override is not None:
        refusal = await known.override_preflight(override)
        if refusal is not None:
            _is_done(serial, refusal, "")
            return REFUSED
    return _print_checklist(await known.preflight(), as_json)


@station_command
async def dismiss_command(
    station: Station,
    vehicle: NameArgument,
) -> int:
    """Clear a lost vehicle's hazard area.

    Only when you know where the vehicle is: others then fly through the area again. Name an
    unidentified vehicle as its alarm does.
    """
    try:
        (name,) = named_serials(station, [vehicle])
    except VehicleNameError:
        name = vehicle
    await station.known(name).dismiss_hazard()
    print_line(f"{name}: hazard area cleared (audited)")
    return DONE


@station_command
async def separation_hold_command(
    station: Station,
    switch: Annotated[Switch, typer.Argument(help="Off raises an alarm.")],
) -> int:
    """Turn automatic holds for vehicles on conflicting paths on or off."""
    await station.switch_separation_hold(switch is Switch.ON)
    print_line(f"automatic separation holds are {switch.value.upper()}")
    return DONE


def _is_done(serial: str, refusal: Refusal | None, result: str) -> bool:
    """Print a vehicle's result or refusal; return whether it was accepted."""
    if refusal is None:
        print_line(f"{serial}: {result}")
    else:
        print_line(f"{serial}: refused ({refusal.rule}): {refusal.reason}")
    return refusal is None


def _print_checklist(checklist: Preflight, as_json: bool) -> int:
    may_fly = checklist.is_passed or checklist.override is not None
    if as_json:
        print_json(msgspec.to_builtins(checklist))
        return DONE if may_fly else REFUSED
    rows = [(p.name, p.state, p.text, p.to_do) for p in checklist.points]
    columns = ("check", "state", "finding", "what to do")
    print_table(f"preflight of {checklist.name}", columns, rows)
    print_failsafe_matrix(checklist.failsafe)
    if checklist.override is not None:
        print_line(f"overridden by {checklist.override.by}: {checklist.override.reason}")
    elif checklist.is_passed:
        print_line("passed")
    else:
        print_line(f"failed: {len(checklist.unmet)} checks block missions")
    return DONE if may_fly else REFUSED
