"""`recon goto` and `recon nudge`: steered by the station while the command runs.

When the command ends before arrival, by Ctrl+C or otherwise, the vehicle stops and holds position.
"""

from collections.abc import Awaitable, Callable
from typing import Annotated

import typer

from recon.cli.connection import (
    JsonOption,
    NameArgument,
    named_serials,
    station_command,
)
from recon.cli.output import Outcome, print_line, print_outcomes
from recon.client import Order, Phase, Refusal, Station, Vehicle

ARRIVAL_TIMEOUT_S = 600.0
CONNECT_TIMEOUT_S = 3.0
SpeedOption = Annotated[float, typer.Option("--speed", help="Metres per second.")]
TimeoutOption = Annotated[
    float,
    typer.Option("--within", min=1.0, max=3600.0, help="Seconds until the order is given up."),
]
Give = Callable[[Vehicle], Awaitable[Order | Refusal]]


def _latitude(degrees: float) -> float:
    return _in_range(degrees, 90.0)


def _longitude(degrees: float) -> float:
    return _in_range(degrees, 180.0)


def _in_range(degrees: float, limit: float) -> float:
    if -limit <= degrees <= limit:
        return degrees
    raise typer.BadParameter(f"expected degrees from -{limit:g} to {limit:g}, got {degrees:g}")


@station_command
async def goto_command(
    station: Station,
    vehicle: NameArgument,
    latitude: Annotated[
        float, typer.Argument(metavar="LAT", help="Degrees, WGS84.", callback=_latitude)
    ],
    longitude: Annotated[
        float, typer.Argument(metavar="LON", help="Degrees, WGS84.", callback=_longitude)
    ],
    height: Annotated[float, typer.Option("--height", help="Metres above the takeoff point.")],
    speed: SpeedOption = 5.0,
    timeout: TimeoutOption = ARRIVAL_TIMEOUT_S,
    as_json: JsonOption = False,
) -> int:
    """Fly a vehicle straight to a position.

    The command runs until the vehicle has arrived. Ctrl+C stops the vehicle.
    """

    async def give(aircraft: Vehicle) -> Order | Refusal:
        return await aircraft.goto(
            latitude, longitude, height_above_takeoff_m=height, speed_mps=speed
        )

    return await _steered(station, vehicle, give, timeout, as_json)


@station_command
async def nudge_command(
    station: Station,
    vehicle: NameArgument,
    north: Annotated[float, typer.Option("--north", help="Metres; negative is south.")] = 0.0,
    east: Annotated[float, typer.Option("--east", help="Metres; negative is west.")] = 0.0,
    up: Annotated[float, typer.Option("--up", help="Metres; negative is down.")] = 0.0,
    turn: Annotated[float, typer.Option("--turn", help="Degrees clockwise.")] = 0.0,
    speed: SpeedOption = 2.0,
    timeout: TimeoutOption = 60.0,
    as_json: JsonOption = False,
) -> int:
    """Move a vehicle by a few metres.

    The command runs until the vehicle has arrived. Ctrl+C stops the vehicle.
    """

    async def give(aircraft: Vehicle) -> Order | Refusal:
        return await aircraft.nudge(
            north_m=north, east_m=east, up_m=up, turn_deg=turn, speed_mps=speed
        )

    return await _steered(station, vehicle, give, timeout, as_json)


async def _steered(station: Station, name: str, give: Give, timeout_s: float, as_json: bool) -> int:
    (serial,) = named_serials(station, [name])
    aircraft = await station.vehicle(serial, timeout_s=CONNECT_TIMEOUT_S)
    order = await give(aircraft)
    vehicle = aircraft.now().name
    if isinstance(order, Refusal):
        rule, reason = order.rule, order.reason
        refused = Outcome(serial, None, vehicle, False, False, rule=rule, note=reason)
        return print_outcomes([refused], as_json)
    if not as_json:
        print_line(f"{vehicle}: moving; Ctrl+C stops it")
    is_replaced = False
    try:
        outcome = await _arrival(order, vehicle, timeout_s)
        is_replaced = outcome.phase == Phase.SUPERSEDED.value
    finally:
        # Closing the connection would stop the vehicle too, but with an alarm. No hold when
        # another order or the pilot flies it now: never fight a pilot's sticks.
        if not is_replaced:
            await aircraft.hold()
    return print_outcomes([outcome], as_json)


async def _arrival(order: Order, vehicle: str, timeout_s: float) -> Outcome:
    """Wait until the vehicle has arrived, or the order has ended otherwise."""
    life = await order.wait_for_arrival(timeout_s)
    return Outcome(
        order.serial,
        None,
        vehicle,
        is_accepted=True,
        is_done=life.has_arrived,
        command_id=order.command_id,
        phase=life.phase.value,
        note=life.note,
    )
