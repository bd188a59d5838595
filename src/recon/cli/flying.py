"""`recon fly` and `recon camera`: a mission from a file, the video feed on and off."""

from pathlib import Path
from typing import Annotated

import typer

from recon.cli.at_station import (
    DEFAULT_ADDRESS,
    DONE,
    REFUSED,
    JsonOption,
    NameArgument,
    StationOption,
    TokenOption,
    WaitOption,
    at_station,
)
from recon.cli.mission_file import read_mission
from recon.cli.output import outcomes, say, say_json, tell
from recon.cli.vehicle_names import serials_of
from recon.client import Mission, Refusal, Station, VehicleAnswer

STARTED_WITHIN_S = 15.0


def fly_command(
    vehicle: NameArgument,
    mission: Annotated[Path, typer.Argument(help="Mission as JSON, or a GeoJSON line.")],
    takeoff: Annotated[
        bool, typer.Option("--takeoff", help="It may leave the ground for this.")
    ] = False,
    dry_run: Annotated[
        bool, typer.Option("--dry-run", help="Tell what the gate says; send nothing.")
    ] = False,
    height: Annotated[
        float | None, typer.Option("--height", help="Of a line: metres above its takeoff point.")
    ] = None,
    speed: Annotated[
        float | None, typer.Option("--speed", help="Of a line: metres per second.")
    ] = None,
    wait: WaitOption = STARTED_WITHIN_S,
    as_json: JsonOption = False,
    station: StationOption = DEFAULT_ADDRESS,
    token_file: TokenOption = None,
) -> None:
    """Fly a mission. Confirmed means that telemetry shows the vehicle flying it."""
    read = read_mission(mission, height, speed)

    async def work(at: Station) -> int:
        (serial,) = serials_of(at, [vehicle])
        flown = await at.vehicle(serial, timeout_s=3.0)
        if dry_run:
            return _told_check(await flown.would_fly(read, takeoff), serial, read, as_json)
        answer = VehicleAnswer(serial, None, flown.now().name, await flown.fly(read, takeoff))
        return tell(await outcomes(at, [answer], wait), as_json)

    at_station(station, token_file, work)


def camera_command(
    vehicle: NameArgument,
    on: Annotated[bool, typer.Option("--on/--off", help="Start or stop the images.")] = True,
    fps: Annotated[float, typer.Option("--fps", help="Images a second, at most.")] = 1.0,
    wait: WaitOption = STARTED_WITHIN_S,
    as_json: JsonOption = False,
    station: StationOption = DEFAULT_ADDRESS,
    token_file: TokenOption = None,
) -> None:
    """Start or stop a vehicle's images."""

    async def work(at: Station) -> int:
        (serial,) = serials_of(at, [vehicle])
        filmed = await at.vehicle(serial, timeout_s=3.0)
        order = await (filmed.start_camera(fps) if on else filmed.stop_camera())
        answer = VehicleAnswer(serial, None, filmed.now().name, order)
        return tell(await outcomes(at, [answer], wait), as_json)

    at_station(station, token_file, work)


def _told_check(refusal: Refusal | None, serial: str, mission: Mission, as_json: bool) -> int:
    if as_json:
        rule, reason = (None, None) if refusal is None else (refusal.rule, refusal.reason)
        say_json({"serial": serial, "would_fly": refusal is None, "rule": rule, "reason": reason})
    elif refusal is None:
        say(f"{serial}: the gate would let {len(mission.waypoints)} waypoints go now; none is sent")
    else:
        say(f"{serial}: the gate would refuse it by the rule {refusal.rule}: {refusal.reason}")
    return DONE if refusal is None else REFUSED
