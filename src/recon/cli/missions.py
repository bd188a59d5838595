"""`recon fly` and `recon camera`: a mission from a file, the image stream on and off."""

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

import typer

from recon.cli.connection import (
    JsonOption,
    NameArgument,
    StationOptions,
    WaitOption,
    named_serials,
    run_at_station,
    station_command,
)
from recon.cli.exit_codes import DONE, REFUSED
from recon.cli.mission_file import read_mission
from recon.cli.options import with_options
from recon.cli.output import await_outcomes, print_json, print_line, print_outcomes
from recon.client import Mission, Refusal, Station, VehicleAnswer

START_TIMEOUT_S = 15.0
CONNECT_TIMEOUT_S = 3.0


@dataclass(frozen=True, slots=True, kw_only=True)
class FlyOptions:
    """A mission's file, and how it is flown."""

    vehicle: NameArgument
    mission: Annotated[
        Path, typer.Argument(help="Mission as JSON, or GeoJSON with one LineString.")
    ]
    takeoff: Annotated[bool, typer.Option("--takeoff", help="Allow takeoff for this mission.")] = (
        False
    )
    dry_run: Annotated[
        bool, typer.Option("--dry-run", help="Check against the safety rules; send nothing.")
    ] = False
    height: Annotated[
        float | None, typer.Option("--height", help="For GeoJSON: metres above the takeoff point.")
    ] = None
    speed: Annotated[
        float | None, typer.Option("--speed", help="For GeoJSON: metres per second.")
    ] = None
    wait: WaitOption = START_TIMEOUT_S
    as_json: JsonOption = False


@with_options
def fly_command(options: FlyOptions, at: StationOptions) -> None:
    """Fly a mission from a file.

    Exit code 0 once telemetry shows the vehicle flying it.
    """
    plan = read_mission(options.mission, options.height, options.speed)
    run_at_station(at, lambda station: _fly(station, plan, options))


async def _fly(station: Station, plan: Mission, options: FlyOptions) -> int:
    (serial,) = named_serials(station, [options.vehicle])
    aircraft = await station.vehicle(serial, timeout_s=CONNECT_TIMEOUT_S)
    if options.dry_run:
        refusal = await aircraft.would_fly(plan, options.takeoff)
        return _print_check(refusal, serial, plan, options.as_json)
    order = await aircraft.fly(plan, options.takeoff)
    answer = VehicleAnswer(serial, None, aircraft.now().name, order)
    outcomes = await await_outcomes(station, [answer], options.wait)
    return print_outcomes(outcomes, options.as_json)


@station_command
async def camera_command(
    station: Station,
    vehicle: NameArgument,
    on: Annotated[bool, typer.Option("--on/--off", help="Start or stop the images.")] = True,
    fps: Annotated[float, typer.Option("--fps", help="Images per second, at most.")] = 1.0,
    wait: WaitOption = START_TIMEOUT_S,
    as_json: JsonOption = False,
) -> int:
    """Start or stop a vehicle's image stream."""
    (serial,) = named_serials(station, [vehicle])
    aircraft = await station.vehicle(serial, timeout_s=CONNECT_TIMEOUT_S)
    order = await (aircraft.start_camera(fps) if on else aircraft.stop_camera())
    answer = VehicleAnswer(serial, None, aircraft.now().name, order)
    return print_outcomes(await await_outcomes(station, [answer], wait), as_json)


def _print_check(refusal: Refusal | None, serial: str, mission: Mission, as_json: bool) -> int:
    if as_json:
        rule, reason = (None, None) if refusal is None else (refusal.rule, refusal.reason)
        print_json({"serial": serial, "would_fly": refusal is None, "rule": rule, "reason": reason})
    elif refusal is None:
        waypoints = len(mission.waypoints)
        print_line(f"{serial}: a mission of {waypoints} waypoints would be accepted; nothing sent")
    else:
        print_line(f"{serial}: would be refused ({refusal.rule}): {refusal.reason}")
    return DONE if refusal is None else REFUSED
