"""`recon goto` and `recon nudge`: flown by the station for as long as the command runs.

The command holds the vehicle: when it ends, by Ctrl+C or however, the vehicle stops and holds.
"""

from collections.abc import Awaitable, Callable
from pathlib import Path
from typing import Annotated

import typer

from recon.cli.at_station import (
    DEFAULT_ADDRESS,
    JsonOption,
    NameArgument,
    StationOption,
    TokenOption,
    at_station,
)
from recon.cli.output import Outcome, say, tell
from recon.cli.vehicle_names import serials_of
from recon.client import Order, Phase, Refusal, Station, Vehicle

ARRIVED_WITHIN_S = 600.0
SpeedOption = Annotated[float, typer.Option("--speed", help="Metres per second.")]
WithinOption = Annotated[
    float, typer.Option("--within", min=1.0, max=3600.0, help="Give up after so many seconds.")
]
Give = Callable[[Vehicle], Awaitable[Order | Refusal]]


def _latitude(degrees: float) -> float:
    return _within(degrees, 90.0)


def _longitude(degrees: float) -> float:
    return _within(degrees, 180.0)


def _within(degrees: float, most: float) -> float:
    """Refuse what is on no map, before anybody is asked; whose it is, the error says by itself."""
    if -most <= degrees <= most:
        return degrees
    raise typer.BadParameter(f"expected degrees from -{most:g} to {most:g}, got {degrees:g}")


def goto_command(
    vehicle: NameArgument,
    latitude: Annotated[
        float, typer.Argument(metavar="LAT", help="Degrees, WGS84.", callback=_latitude)
    ],
    longitude: Annotated[
        float, typer.Argument(metavar="LON", help="Degrees, WGS84.", callback=_longitude)
    ],
    height: Annotated[float, typer.Option("--height", help="Metres above its takeoff point.")],
    speed: SpeedOption = 5.0,
    within: WithinOption = ARRIVED_WITHIN_S,
    as_json: JsonOption = False,
    station: StationOption = DEFAULT_ADDRESS,
    token_file: TokenOption = None,
) -> None:
    """Fly a vehicle straight to a place, until it is there. Ctrl+C stops it."""

    async def give(flown: Vehicle) -> Order | Refusal:
        return await flown.goto(latitude, longitude, height_above_takeoff_m=height, speed_mps=speed)

    _steer(vehicle, give, within, as_json, station, token_file)


def nudge_command(
    vehicle: NameArgument,
    north: Annotated[float, typer.Option("--north", help="Metres; negative is south.")] = 0.0,
    east: Annotated[float, typer.Option("--east", help="Metres; negative is west.")] = 0.0,
    up: Annotated[float, typer.Option("--up", help="Metres; negative is down.")] = 0.0,
    turn: Annotated[float, typer.Option("--turn", help="Degrees clockwise.")] = 0.0,
    speed: SpeedOption = 2.0,
    within: WithinOption = 60.0,
    as_json: JsonOption = False,
    station: StationOption = DEFAULT_ADDRESS,
    token_file: TokenOption = None,
) -> None:
    """Move a vehicle by a little from where it is, until it is there. Ctrl+C stops it."""

    async def give(flown: Vehicle) -> Order | Refusal:
        return await flown.nudge(
            north_m=north, east_m=east, up_m=up, turn_deg=turn, speed_mps=speed
        )

    _steer(vehicle, give, within, as_json, station, token_file)


def _steer(
    name: str, give: Give, within_s: float, as_json: bool, address: str, token_file: Path | None
) -> None:
    async def work(station: Station) -> int:
        (serial,) = serials_of(station, [name])
        flown = await station.vehicle(serial, timeout_s=3.0)
        order = await give(flown)
        called = flown.now().name
        if isinstance(order, Refusal):
            rule, reason = order.rule, order.reason
            return tell(
                [Outcome(serial, None, called, False, False, rule=rule, note=reason)], as_json
            )
        if not as_json:
            say(f"{called}: on its way; Ctrl+C stops it")
        is_anothers = False
        try:
            outcome = await _there(order, called, within_s)
            is_anothers = outcome.phase == Phase.SUPERSEDED.value
        finally:
            # Its end stops the vehicle too, as a connection that is lost, with an alarm. Not when
            # somebody else flies it by now: a pilot who took the sticks is not fought.
            if not is_anothers:
                await flown.hold()
        return tell([outcome], as_json)

    at_station(address, token_file, work)


async def _there(order: Order, called: str, within_s: float) -> Outcome:
    """Wait until the vehicle is there, or the order has ended in another way."""
    life = await order.arrival(within_s)
    return Outcome(
        order.serial,
        None,
        called,
        is_accepted=True,
        is_done=life.is_there,
        command_id=order.command_id,
        phase=life.phase.value,
        note=life.note,
    )
