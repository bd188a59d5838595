"""`recon fleet-return`: vehicles returned in separate height layers, and their progress."""

from collections.abc import Sequence

import msgspec

from recon.cli.connection import (
    JsonOption,
    NamesArgument,
    WaitOption,
    named_serials,
    read_until,
    station_command,
)
from recon.cli.exit_codes import DONE, REFUSED
from recon.cli.output import print_json, print_table
from recon.client import Station, VehicleReturn

PLANNING_TIMEOUT_S = 10.0


@station_command
async def fleet_return_command(
    station: Station,
    vehicles: NamesArgument = None,
    wait: WaitOption = 0.0,
    as_json: JsonOption = False,
) -> int:
    """Return vehicles in separate height layers; they land one at a time.

    Without names: every vehicle that is or may be in the air. Exits once the plan is made; with
    --wait, once all have ended or after that many seconds. The return continues after the exit.
    """
    serials = named_serials(station, vehicles) if vehicles else None
    called = {answer.serial for answer in await station.fleet.return_in_layers(serials)}

    async def read() -> list[VehicleReturn]:
        return [f for f in await station.fleet.returning() if f.serial in called]

    flights = await read_until(read, _are_planned, PLANNING_TIMEOUT_S)
    if wait > 0.0:
        flights = await read_until(read, _are_done, wait)
    _print_flights(flights, as_json)
    is_good = all(flight.stage not in ("excluded", "released") for flight in flights)
    is_over = wait == 0.0 or _are_done(flights)
    return DONE if is_good and is_over else REFUSED


def _are_planned(flights: Sequence[VehicleReturn]) -> bool:
    return all(flight.wave is not None or flight.is_done for flight in flights)


def _are_done(flights: Sequence[VehicleReturn]) -> bool:
    return all(flight.is_done for flight in flights)


def _print_flights(flights: Sequence[VehicleReturn], as_json: bool) -> None:
    if as_json:
        print_json(msgspec.to_builtins(flights))
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
    columns = ("vehicle", "stage", "wave", "height", "pad", "reason")
    print_table("fleet return", columns, rows, has_heads=True)


def _metres(height_m: float | None) -> str:
    return "" if height_m is None else f"{height_m:.0f} m"
