"""`recon hold`, `land`, `return`, `all-stop`: always allowed for a vehicle in the air.

`release-stop` ends what an all stop leaves behind: until then nothing moves a vehicle.
"""

import asyncio
import time
from collections.abc import Awaitable, Callable, Sequence
from dataclasses import dataclass
from typing import Annotated

import typer

from recon.cli.connection import (
    JsonOption,
    NamesArgument,
    StationOptions,
    VehicleNameError,
    WaitOption,
    named_serials,
    run_at_station,
    station_at,
)
from recon.cli.exit_codes import DONE, REFUSED
from recon.cli.guard_stop import STATION_ANSWERS_WITHIN_S, guard_port_of, stop_all_at_guard
from recon.cli.options import with_options
from recon.cli.output import Outcome, await_outcomes, print_line, print_outcomes
from recon.client import (
    ClientError,
    FleetCommands,
    OrderStatus,
    ResultMessage,
    Station,
    VehicleAnswer,
)
from recon.client.errors import MaybeSentError, StationUnreachableError

CONFIRMATION_TIMEOUT_S = 15.0
POLL_INTERVAL_S = 0.2
ON_GROUND_RULE = "flying"
"""The rule that refuses a hover on the ground, where some apps would answer it with a takeoff."""

AllOption = Annotated[bool, typer.Option("--all", help="Every identified vehicle.")]
Give = Callable[[FleetCommands, Sequence[str] | None], Awaitable[tuple[VehicleAnswer, ...]]]


@dataclass(frozen=True, slots=True, kw_only=True)
class StopOptions:
    """The vehicles that are stopped, and how that is followed."""

    vehicles: NamesArgument = None
    all_vehicles: AllOption = False
    wait: WaitOption = CONFIRMATION_TIMEOUT_S
    as_json: JsonOption = False


@with_options
def hold_command(options: StopOptions, at: StationOptions) -> None:
    """Stop vehicles and hold position."""
    _order(FleetCommands.hold, options, at)


@with_options
def land_command(options: StopOptions, at: StationOptions) -> None:
    """Land vehicles where they are.

    Exit code 0 once telemetry shows them landing.
    """
    _order(FleetCommands.land, options, at)


@with_options
def return_command(options: StopOptions, at: StationOptions) -> None:
    """Return vehicles to home, each at its own go-home height, and land.

    The go-home height is set in the aircraft. Exit code 0 once telemetry shows them returning.
    """
    _order(FleetCommands.return_home, options, at)


@with_options
def all_stop_command(
    at: StationOptions,
    wait: WaitOption = CONFIRMATION_TIMEOUT_S,
    as_json: JsonOption = False,
    stop_port: Annotated[
        int | None,
        typer.Option(help="Port of the station's guard; default: the console's port and 1."),
    ] = None,
) -> None:
    """Hold every vehicle in the air, identified or not. Never stops motors.

    It stays in force: nothing moves a vehicle until `recon release-stop`. Where the station does
    not answer within a second, its guard holds them.
    """
    port = guard_port_of(at.address) if stop_port is None else stop_port
    first = None if port is None else STATION_ANSWERS_WITHIN_S
    try:
        outcomes = asyncio.run(_all_stop(station_at(at), wait, first))
    except (TimeoutError, StationUnreachableError, MaybeSentError) as problem:
        by_guard = None if port is None else stop_all_at_guard(port)
        if by_guard is None and not isinstance(problem, TimeoutError):
            raise
        if by_guard is None:
            outcomes = asyncio.run(_all_stop(station_at(at), wait, None))
        else:
            outcomes = by_guard
    raise typer.Exit(print_outcomes(outcomes, as_json))


@with_options
def release_stop_command(
    at: StationOptions,
    vehicles: NamesArgument = None,
    all_vehicles: Annotated[
        bool, typer.Option("--all", help="Every vehicle, also those that connect later.")
    ] = False,
) -> None:
    """Release vehicles from an all stop.

    Nothing is sent to them, and nothing resumes automatically.
    """
    _require_names_or_all(vehicles, all_vehicles)

    async def work(station: Station) -> int:
        serials = None if all_vehicles else named_serials(station, vehicles)
        refusal = await station.release_stop(serials)
        which = "every vehicle" if serials is None else ", ".join(serials)
        if refusal is not None:
            print_line(f"{which}: refused ({refusal.rule}): {refusal.reason}")
            return REFUSED
        print_line(f"{which}: released from the all stop (audited); nothing was sent")
        return DONE

    run_at_station(at, work)


def _require_names_or_all(names: list[str] | None, all_vehicles: bool) -> None:
    if bool(names) is all_vehicles:
        raise VehicleNameError("Name the vehicles or use --all")


def _order(give: Give, options: StopOptions, at: StationOptions) -> None:
    is_for_all = options.all_vehicles
    _require_names_or_all(options.vehicles, is_for_all)

    async def work(station: Station) -> int:
        serials = None if is_for_all else named_serials(station, options.vehicles)
        answers = await give(station.fleet, serials)
        outcomes = await await_outcomes(
            station, answers, options.wait, leaves_grounded_alone=is_for_all
        )
        return print_outcomes(outcomes, options.as_json)

    run_at_station(at, work)


async def _all_stop(station: Station, wait_s: float, within_s: float | None) -> list[Outcome]:
    """Send the stop before anything else; then poll for the outcomes.

    Raises `TimeoutError` when the station has not answered within `within_s`.
    """
    try:
        async with asyncio.timeout(within_s):
            answers = await station.all_stop_at_once()
        lives: dict[int, OrderStatus] = {}
        end_s = time.monotonic() + wait_s
        while time.monotonic() < end_s and not _are_over(answers, lives):
            try:
                lives = {life.id: life for life in await station.commands()}
            except ClientError:
                # The stops were sent; their outcomes are reported as unknown below.
                lives = {}
            await asyncio.sleep(POLL_INTERVAL_S)
        return [_stopped(answer, lives.get(answer.command_id), wait_s) for answer in answers]
    finally:
        await station.close()


def _are_over(answers: Sequence[ResultMessage], lives: dict[int, OrderStatus]) -> bool:
    accepted = [answer.command_id for answer in answers if answer.accepted]
    return all(number in lives and lives[number].phase.is_final for number in accepted)


def _stopped(answer: ResultMessage, life: OrderStatus | None, wait_s: float) -> Outcome:
    is_on_ground = answer.rule == ON_GROUND_RULE
    vehicle = (answer.serial, answer.link_id, answer.vehicle_name)
    if not answer.accepted:
        note = answer.reason or ""
        return Outcome(*vehicle, False, False, is_on_ground, rule=answer.rule, note=note)
    if wait_s == 0.0 or life is None:
        is_done, note = wait_s == 0.0, "" if wait_s == 0.0 else "outcome unknown"
        return Outcome(*vehicle, True, is_done, False, answer.command_id, note=note)
    return Outcome(
        *vehicle,
        True,
        life.has_taken_effect,
        False,
        answer.command_id,
        life.phase.value,
        note=life.note,
    )
