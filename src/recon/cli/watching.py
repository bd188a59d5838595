"""`recon status`, `recon alarms`, `recon commands`: what the station knows, in the terminal."""

from typing import Annotated, Any

import msgspec
import typer

from recon.cli.at_station import (
    DEFAULT_ADDRESS,
    DONE,
    JsonOption,
    StationOption,
    TokenOption,
    at_station,
)
from recon.cli.output import say, say_json, table
from recon.client import Alarm, Life, Station, Telemetry


def status_command(
    as_json: JsonOption = False,
    station: StationOption = DEFAULT_ADDRESS,
    token_file: TokenOption = None,
) -> None:
    """Show every vehicle: where it is, how it is, how old that is."""

    async def work(at: Station) -> int:
        vehicles, alarms = at.vehicles(), await at.alarms()
        if as_json:
            say_json(msgspec.to_builtins(vehicles))
            return DONE
        columns = ("vehicle", "serial", "heard", "state", "mode", "height", "speed", "battery")
        table("vehicles", columns, [_vehicle_row(vehicle) for vehicle in vehicles])
        active = sum(alarm.is_active for alarm in alarms)
        say(f"{len(vehicles)} vehicles, {active} active alarms")
        return DONE

    at_station(station, token_file, work)


def alarms_command(
    ack: Annotated[
        list[int] | None, typer.Option("--ack", help="Say that you have seen the alarm; repeat.")
    ] = None,
    as_json: JsonOption = False,
    station: StationOption = DEFAULT_ADDRESS,
    token_file: TokenOption = None,
) -> None:
    """Show the alarms; one stays until its cause ends and a person has seen it."""

    async def work(at: Station) -> int:
        for number in ack or []:
            await at.acknowledge(number)
        alarms = await at.alarms()
        if as_json:
            say_json(msgspec.to_builtins(alarms))
            return DONE
        columns = ("id", "severity", "since", "what", "seen")
        table("alarms", columns, [_alarm_row(alarm) for alarm in alarms])
        say(f"{sum(alarm.is_active for alarm in alarms)} active alarms")
        return DONE

    at_station(station, token_file, work)


def commands_command(
    as_json: JsonOption = False,
    station: StationOption = DEFAULT_ADDRESS,
    token_file: TokenOption = None,
) -> None:
    """Show the latest orders and what became of them, the newest first."""

    async def work(at: Station) -> int:
        lives = await at.commands()
        if as_json:
            say_json(msgspec.to_builtins(lives))
            return DONE
        columns = ("id", "vehicle", "order", "phase", "age", "note")
        table("orders", columns, [_life_row(life) for life in lives])
        say(f"{len(lives)} orders")
        return DONE

    at_station(station, token_file, work)


def _vehicle_row(vehicle: Telemetry) -> tuple[str, ...]:
    simulated = " (simulated)" if vehicle.is_simulated else ""
    return (
        vehicle.name + simulated,
        vehicle.serial or "none",
        _age(vehicle.telemetry_age_s, vehicle.staleness.value),
        {True: "flying", False: "on the ground", None: "unknown"}[vehicle.is_flying.value],
        (vehicle.flight_mode.value or "unknown").replace("_", " "),
        _unit(vehicle.height_above_takeoff_m.value, "m"),
        _unit(_speed_mps(vehicle), "m/s"),
        _percent(vehicle.battery_fraction.value),
    )


def _speed_mps(vehicle: Telemetry) -> float | None:
    velocity = vehicle.velocity_ned
    parts = (velocity.north_mps, velocity.east_mps, velocity.down_mps)
    known = [part for part in parts if part is not None]
    return sum(part**2 for part in known) ** 0.5 if len(known) == len(parts) else None


def _alarm_row(alarm: Alarm) -> tuple[str, ...]:
    ended = "" if alarm.is_active else " (ended)"
    seen = "yes" if alarm.is_acknowledged else "no"
    since = f"{alarm.raised_age_s:.0f} s"
    return (str(alarm.id), alarm.severity, since, alarm.text + ended, seen)


def _life_row(life: Life) -> tuple[str, ...]:
    age = f"{life.history[0].age_s:.0f} s" if life.history else ""
    kind, phase = (word.replace("_", " ") for word in (life.kind, life.phase.value))
    return (str(life.id), life.vehicle_name, kind, phase, age, life.note)


def _age(age_s: float | None, word: str) -> str:
    return "never" if age_s is None else f"{age_s:.1f} s, {word}"


def _unit(value: float | None, unit: str) -> str:
    return "unknown" if value is None else f"{value:.1f} {unit}"


def _percent(fraction: Any) -> str:
    return "unknown" if fraction is None else f"{fraction:.0%}"
