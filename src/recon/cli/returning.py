"""`recon fleet-return`: vehicles called home in layers, and how far each has come."""

import asyncio
import time
from collections.abc import Callable, Sequence

import msgspec

from recon.cli.at_station import (
    DEFAULT_ADDRESS,
    DONE,
    REFUSED,
    JsonOption,
    NamesArgument,
    StationOption,
    TokenOption,
    WaitOption,
    at_station,
)
from recon.cli.output import say_json, table
from recon.cli.vehicle_names import serials_of
from recon.client import Returning, Station

PLANNED_WITHIN_S = 10.0
LOOKED_EVERY_S = 0.5

IsSo = Callable[[Sequence[Returning]], bool]


def fleet_return_command(
    vehicles: NamesArgument = None,
    wait: WaitOption = 0.0,
    as_json: JsonOption = False,
    station: StationOption = DEFAULT_ADDRESS,
    token_file: TokenOption = None,
) -> None:
    """Call vehicles home, each at a height of its own, one at a time at each pad.

    Without names every one that flies or may. Ends once the plan is made; with --wait, once all
    are done, or after so many seconds. The return goes on however this command ends.
    """

    async def work(at: Station) -> int:
        serials = serials_of(at, vehicles) if vehicles else None
        called = {answer.serial for answer in await at.fleet.return_in_layers(serials)}
        flights = await _until(at, called, _are_planned, PLANNED_WITHIN_S)
        if wait > 0.0:
            flights = await _until(at, called, _are_done, wait)
        _tell(flights, as_json)
        is_good = all(flight.stage not in ("left_out", "released") for flight in flights)
        is_over = wait == 0.0 or _are_done(flights)
        return DONE if is_good and is_over else REFUSED

    at_station(station, token_file, work)


def _are_planned(flights: Sequence[Returning]) -> bool:
    return all(flight.wave is not None or flight.is_done for flight in flights)


def _are_done(flights: Sequence[Returning]) -> bool:
    return all(flight.is_done for flight in flights)


async def _until(
    station: Station, called: set[str | None], is_so: IsSo, within_s: float
) -> list[Returning]:
    end_s = time.monotonic() + within_s
    while True:
        flights = [f for f in await station.fleet.returning() if f.serial in called]
        if is_so(flights) or time.monotonic() >= end_s:
            return flights
        await asyncio.sleep(LOOKED_EVERY_S)


def _tell(flights: Sequence[Returning], as_json: bool) -> None:
    if as_json:
        say_json(msgspec.to_builtins(flights))
        return
    rows = [
        (
            flight.vehicle_name,
            flight.stage.replace("_", " "),
            "" if flight.wave is None else f"wave {flight.wave}",
            _metres(flight.layer_height_above_takeoff_m),
            flight.pad or "",
            flight.reason or "",
        )
        for flight in flights
    ]
    table("the way home", ("vehicle", "stage", "wave", "height", "pad", "why"), rows)


def _metres(height_m: float | None) -> str:
    return "" if height_m is None else f"{height_m:.0f} m"
