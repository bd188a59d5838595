"""`recon take`, `release` and `preflight`: who leads a vehicle, and whether it is ready."""

from enum import Enum
from typing import Annotated

import msgspec
import typer

from recon.cli.at_station import (
    DEFAULT_ADDRESS,
    DONE,
    REFUSED,
    JsonOption,
    NameArgument,
    NamesArgument,
    StationOption,
    TokenOption,
    at_station,
)
from recon.cli.output import say, say_json, table
from recon.cli.vehicle_names import NamingError, serials_of
from recon.client import Preflight, Refusal, Station


class Receiver(Enum):
    """To whom a vehicle can be left."""

    PILOT = "pilot"
    GUIDANCE = "guidance"


def take_command(
    vehicles: NamesArgument = None,
    station: StationOption = DEFAULT_ADDRESS,
    token_file: TokenOption = None,
) -> None:
    """Take vehicles over: from now on only the operator sets them in motion. Nothing is sent."""

    async def work(at: Station) -> int:
        done = [
            _told(serial, await at.known(serial).take(), "led by the operator")
            for serial in serials_of(at, _named(vehicles))
        ]
        return DONE if all(done) else REFUSED

    at_station(station, token_file, work)


def release_command(
    vehicles: NamesArgument = None,
    to: Annotated[Receiver, typer.Option("--to", help="Who leads them then.")] = Receiver.PILOT,
    station: StationOption = DEFAULT_ADDRESS,
    token_file: TokenOption = None,
) -> None:
    """Leave vehicles to their pilots, or to the station's own planning. Nothing is sent."""

    async def work(at: Station) -> int:
        done: list[bool] = []
        for serial in serials_of(at, _named(vehicles)):
            known = at.known(serial)
            give = known.give_to_pilot if to is Receiver.PILOT else known.give_to_guidance
            done.append(_told(serial, await give(), f"led by {to.value}"))
        return DONE if all(done) else REFUSED

    at_station(station, token_file, work)


def preflight_command(
    vehicle: NameArgument,
    override: Annotated[
        str | None,
        typer.Option("--override", help="Fly missions all the same, for this reason; audited."),
    ] = None,
    as_json: JsonOption = False,
    station: StationOption = DEFAULT_ADDRESS,
    token_file: TokenOption = None,
) -> None:
    """Show a vehicle's checklist. Exit code 0 when missions may fly: passed, or overridden."""

    async def work(at: Station) -> int:
        (serial,) = serials_of(at, [vehicle])
        known = at.known(serial)
        if override is not None:
            refusal = await known.override_preflight(override)
            if refusal is not None:
                _told(serial, refusal, "")
                return REFUSED
        return _tell(await known.preflight(), as_json)

    at_station(station, token_file, work)


def _named(vehicles: list[str] | None) -> list[str]:
    if not vehicles:
        raise NamingError("name the vehicles")
    return vehicles


def _told(serial: str, refusal: Refusal | None, words: str) -> bool:
    if refusal is None:
        say(f"{serial}: {words}")
    else:
        say(f"{serial}: refused by the rule {refusal.rule}: {refusal.reason}")
    return refusal is None


def _tell(checklist: Preflight, as_json: bool) -> int:
    may_fly = checklist.is_passed or checklist.override is not None
    if as_json:
        say_json(msgspec.to_builtins(checklist))
        return DONE if may_fly else REFUSED
    rows = [(p.name, p.state, p.text, p.to_do) for p in checklist.points]
    table(f"preflight of {checklist.name}", ("point", "state", "what is", "what to do"), rows)
    if checklist.override is not None:
        say(f"overridden by {checklist.override.by}: {checklist.override.reason}")
    elif checklist.is_passed:
        say("passed")
    else:
        say(f"{len(checklist.unmet)} points hold missions back")
    return DONE if may_fly else REFUSED
