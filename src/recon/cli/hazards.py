"""`recon dismiss` and `recon separation-hold`: a person's word on what the watchdogs go by."""

from enum import Enum
from typing import Annotated

import typer

from recon.cli.at_station import (
    DEFAULT_ADDRESS,
    DONE,
    NameArgument,
    StationOption,
    TokenOption,
    at_station,
)
from recon.cli.output import say
from recon.cli.vehicle_names import NamingError, serials_of
from recon.client import Station


class Switch(Enum):
    """On or off."""

    ON = "on"
    OFF = "off"


def dismiss_command(
    vehicle: NameArgument,
    station: StationOption = DEFAULT_ADDRESS,
    token_file: TokenOption = None,
) -> None:
    """Say that you know where a vehicle is that is not heard: others need not keep clear of it.

    One without a serial is named as its alarm names it.
    """

    async def work(at: Station) -> int:
        try:
            (named,) = serials_of(at, [vehicle])
        except NamingError:
            named = vehicle
        await at.known(named).dismiss_hazard()
        say(f"{named}: no longer counted as in the air; your word is in the audit")
        return DONE

    at_station(station, token_file, work)


def separation_hold_command(
    switch: Annotated[Switch, typer.Argument(help="Whether vehicles in conflict are held.")],
    station: StationOption = DEFAULT_ADDRESS,
    token_file: TokenOption = None,
) -> None:
    """Switch on or off that vehicles about to come too close are held; off, an alarm says so."""

    async def work(at: Station) -> int:
        await at.switch_separation_hold(switch is Switch.ON)
        say(f"vehicles in conflict are {'held' if switch is Switch.ON else 'NOT held'} from now on")
        return DONE

    at_station(station, token_file, work)
