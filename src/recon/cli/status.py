"""`recon status`, `recon alarms`, `recon commands`: the state of the station, in the terminal."""

from collections.abc import Sequence
from typing import Annotated

import msgspec
import typer

from recon.cli.connection import JsonOption, station_command
from recon.cli.exit_codes import DONE
from recon.cli.output import print_json, print_line, print_table
from recon.client import AlarmStatus, OrderStatus, Station, StopLatchStatus, Telemetry


@station_command
async def status_command(
    station: Station,
    as_json: JsonOption = False,
) -> int:
    """Show every vehicle and its telemetry's age."""
    vehicles, alarms = station.vehicles(), await station.alarms()
    if as_json:
        print_json(msgspec.to_builtins(vehicles))
        return DONE
    facts = ("vehicle", "serial", "telemetry", "state", "mode", "height", "speed", "battery")
    columns = (*facts, "operated by")
    print_table("vehicles", columns, [_vehicle_row(vehicle) for vehicle in vehicles])
    latch = await station.stop_in_force()
    if latch is not None:
        print_line(_in_force(latch))
    active, _ = _counted(alarms)
    print_line(f"{len(vehicles)} vehicles, {active} active alarms")
    return DONE


def _in_force(latch: StopLatchStatus) -> str:
    released = ", ".join(latch.released) or "none"
    return (
        f"ALL STOP by {latch.by} {latch.age_s:.0f} s ago: nothing moves a vehicle; released: "
        f"{released}; end it with recon release-stop"
    )


@station_command
async def alarms_command(
    station: Station,
    acknowledged: Annotated[
        list[int] | None,
        typer.Option("--ack", metavar="ID", help="Acknowledge an alarm; may be repeated."),
    ] = None,
    as_json: JsonOption = False,
) -> int:
    """Show alarms, and acknowledge them.

    An alarm stays listed until its cause has ended and an operator has acknowledged it.
    """
    for number in acknowledged or []:
        await station.acknowledge(number)
    alarms = sorted(await station.alarms(), key=lambda alarm: not alarm.is_active)
    if as_json:
        print_json(msgspec.to_builtins(alarms))
        return DONE
    columns = ("id", "severity", "since", "alarm", "acknowledged")
    print_table("alarms", columns, [_alarm_row(alarm) for alarm in alarms])
    active, ended = _counted(alarms)
    print_line(f"{active} active alarms; {ended} ended, not acknowledged")
    return DONE


@station_command
async def commands_command(
    station: Station,
    as_json: JsonOption = False,
) -> int:
    """Show recent orders and their outcomes.

    The newest comes first.
    """
    lives = await station.commands()
    if as_json:
        print_json(msgspec.to_builtins(lives))
        return DONE
    columns = ("id", "vehicle", "order", "phase", "age", "note")
    print_table("orders", columns, [_life_row(life) for life in lives])
    print_line(f"{len(lives)} orders")
    return DONE


def _vehicle_row(vehicle: Telemetry) -> tuple[str, ...]:
    simulated = " (simulated)" if vehicle.is_simulated else ""
    battery = vehicle.battery_fraction.value
    return (
        vehicle.name + simulated,
        vehicle.serial or "none",
        _age(vehicle.telemetry_age_s, vehicle.staleness.value),
        {True: "flying", False: "on the ground", None: "unknown"}[vehicle.is_flying.value],
        (vehicle.flight_mode.value or "unknown").replace("_", " "),
        _with_unit(vehicle.height_above_takeoff_m.value, "m"),
        _with_unit(_speed_mps(vehicle), "m/s"),
        "unknown" if battery is None else f"{battery:.0%}",
        "" if vehicle.lease is None else vehicle.lease.person,
    )


def _speed_mps(vehicle: Telemetry) -> float | None:
    velocity = vehicle.velocity_ned
    parts = (velocity.north_mps, velocity.east_mps, velocity.down_mps)
    known = [part for part in parts if part is not None]
    return sum(part**2 for part in known) ** 0.5 if len(known) == len(parts) else None


def _alarm_row(alarm: AlarmStatus) -> tuple[str, ...]:
    ended = "" if alarm.is_active else " (ended)"
    acknowledged = "yes" if alarm.is_acknowledged else "no"
    since = f"{alarm.raised_age_s:.0f} s"
    return (str(alarm.id), alarm.severity, since, alarm.text + ended, acknowledged)


def _counted(alarms: Sequence[AlarmStatus]) -> tuple[int, int]:
    """How many are active, without notes, as the console counts them; and how many have ended."""
    active = sum(alarm.is_active and alarm.severity != "info" for alarm in alarms)
    return active, sum(not alarm.is_active for alarm in alarms)


def _life_row(life: OrderStatus) -> tuple[str, ...]:
    age = f"{life.history[0].age_s:.0f} s" if life.history else ""
    kind, phase = (word.replace("_", " ") for word in (life.kind, life.phase.value))
    return (str(life.id), life.vehicle_name, kind, phase, age, life.note)


def _age(age_s: float | None, staleness: str) -> str:
    return "never" if age_s is None else f"{age_s:.1f} s, {staleness}"


def _with_unit(value: float | None, unit: str) -> str:
    return "unknown" if value is None else f"{value:.1f} {unit}"
