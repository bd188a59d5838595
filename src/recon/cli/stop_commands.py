"""`recon hold`, `land`, `return`, `all-stop`: what is always allowed for a vehicle in the air."""

import asyncio
import time
from collections.abc import Awaitable, Callable, Sequence
from pathlib import Path
from typing import Annotated

import typer

from recon.cli.at_station import (
    DEFAULT_ADDRESS,
    JsonOption,
    NamesArgument,
    StationOption,
    TokenOption,
    WaitOption,
    at_station,
    read_secret,
)
from recon.cli.output import Outcome, outcomes, tell
from recon.cli.vehicle_names import NamingError, serials_of
from recon.client import ClientError, Fleet, Life, Station, StopAnswer, VehicleAnswer

CONFIRMED_WITHIN_S = 15.0
LOOKED_EVERY_S = 0.2
ON_THE_GROUND = "flying"
"""The rule by which the gate refuses a hover to what stands: there, apps answer with a takeoff."""

AllOption = Annotated[bool, typer.Option("--all", help="Every vehicle that has a serial.")]
Give = Callable[[Fleet, Sequence[str] | None], Awaitable[tuple[VehicleAnswer, ...]]]


def hold_command(
    vehicles: NamesArgument = None,
    everyone: AllOption = False,
    wait: WaitOption = CONFIRMED_WITHIN_S,
    as_json: JsonOption = False,
    station: StationOption = DEFAULT_ADDRESS,
    token_file: TokenOption = None,
) -> None:
    """Stop vehicles and hold them where they are."""
    _order(Fleet.hold, vehicles, everyone, wait, as_json, station, token_file)


def land_command(
    vehicles: NamesArgument = None,
    everyone: AllOption = False,
    wait: WaitOption = CONFIRMED_WITHIN_S,
    as_json: JsonOption = False,
    station: StationOption = DEFAULT_ADDRESS,
    token_file: TokenOption = None,
) -> None:
    """Land vehicles where they are. Confirmed means that they have begun to."""
    _order(Fleet.land, vehicles, everyone, wait, as_json, station, token_file)


def return_command(
    vehicles: NamesArgument = None,
    everyone: AllOption = False,
    wait: WaitOption = CONFIRMED_WITHIN_S,
    as_json: JsonOption = False,
    station: StationOption = DEFAULT_ADDRESS,
    token_file: TokenOption = None,
) -> None:
    """Send vehicles home, each at the go-home height set in the aircraft, to land there."""
    _order(Fleet.return_home, vehicles, everyone, wait, as_json, station, token_file)


def all_stop_command(
    wait: WaitOption = CONFIRMED_WITHIN_S,
    as_json: JsonOption = False,
    station: StationOption = DEFAULT_ADDRESS,
    token_file: TokenOption = None,
) -> None:
    """Hold everything that flies, with a serial or without. Never cuts motors."""
    told = asyncio.run(_all_stop(Station(station, read_secret(token_file)), wait))
    raise typer.Exit(tell(told, as_json))


def _order(
    give: Give,
    names: list[str] | None,
    everyone: bool,
    wait_s: float,
    as_json: bool,
    address: str,
    token_file: Path | None,
) -> None:
    if bool(names) is everyone:
        raise NamingError("name the vehicles, or say --all: no order is for a guess")

    async def work(station: Station) -> int:
        serials = None if everyone else serials_of(station, names or [])
        answers = await give(station.fleet, serials)
        told = await outcomes(station, answers, wait_s, leaves_grounded_alone=everyone)
        return tell(told, as_json)

    at_station(address, token_file, work)


async def _all_stop(station: Station, wait_s: float) -> list[Outcome]:
    """Stop first; only then look what became of it."""
    try:
        answers = await station.all_stop_at_once()
        lives: dict[int, Life] = {}
        end_s = time.monotonic() + wait_s
        while time.monotonic() < end_s and not _are_over(answers, lives):
            try:
                lives = {life.id: life for life in await station.commands()}
            except ClientError:
                # The stop is given; that nobody can say what became of it is told below.
                lives = {}
            await asyncio.sleep(LOOKED_EVERY_S)
        return [_stopped(answer, lives.get(answer.command_id), wait_s) for answer in answers]
    finally:
        await station.close()


def _are_over(answers: Sequence[StopAnswer], lives: dict[int, Life]) -> bool:
    accepted = [answer.command_id for answer in answers if answer.accepted]
    return all(number in lives and lives[number].phase.is_final for number in accepted)


def _stopped(answer: StopAnswer, life: Life | None, wait_s: float) -> Outcome:
    stands = answer.rule == ON_THE_GROUND
    whom = (answer.serial, answer.link_id, answer.vehicle_name)
    if not answer.accepted:
        return Outcome(*whom, False, False, stands, rule=answer.rule, note=answer.reason or "")
    if wait_s == 0.0 or life is None:
        is_done, note = wait_s == 0.0, "" if wait_s == 0.0 else "what became of it is not known"
        return Outcome(*whom, True, is_done, False, answer.command_id, note=note)
    return Outcome(
        *whom, True, life.is_seen, False, answer.command_id, life.phase.value, note=life.note
    )
