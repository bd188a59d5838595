"""`recon zone`: temporary zones round a person, a tractor or a crewed aircraft."""

from dataclasses import dataclass
from typing import Annotated

import msgspec
import typer

from recon.cli.commands import App
from recon.cli.connection import JsonOption, StationOptions, run_at_station, station_command
from recon.cli.exit_codes import DONE, REFUSED
from recon.cli.options import with_options
from recon.cli.output import print_json, print_line, print_table, refused
from recon.client import ClientError, Refusal, Station, TemporaryZoneStatus
from recon.model.geo import LatLon
from recon.model.temporary_zone import Circle, TemporaryZoneKind

zone_app = App(
    help="Keep drones out of a place at once: add, end and list temporary zones.",
    no_args_is_help=True,
)


class ZoneShapeError(ClientError):
    """The options name no place, or two."""


@dataclass(frozen=True, slots=True, kw_only=True)
class ZoneOptions:
    """A temporary zone: what is kept clear, where and for how long."""

    kind: Annotated[TemporaryZoneKind, typer.Option("--kind", help="What is kept clear.")]
    reason: Annotated[str, typer.Option("--reason", help="For those who see the alarm; audited.")]
    at: Annotated[
        str | None, typer.Option("--at", metavar="LAT,LON", help="Centre of a circle.")
    ] = None
    radius: Annotated[
        float | None, typer.Option("--radius-m", help="Radius of the circle, metres.")
    ] = None
    corners: Annotated[
        list[str] | None,
        typer.Option("--corner", metavar="LAT,LON", help="A corner of an outline; repeat it."),
    ] = None
    floor: Annotated[
        float | None, typer.Option("--floor-m", help="Metres above ground; default: the ground.")
    ] = None
    ceiling: Annotated[
        float | None,
        typer.Option(
            "--ceiling-m",
            help="Metres above ground; default: 30, of a crewed aircraft all heights.",
        ),
    ] = None
    minutes: Annotated[
        float | None, typer.Option("--minutes", help="Default: until a person ends it.")
    ] = None
    as_json: JsonOption = False


@zone_app.command("add")
@with_options
def add_command(zone: ZoneOptions, station: StationOptions) -> None:
    """Draw a zone that everything is kept out of at once.

    Drones about to enter it are held. One that is in it raises an alarm and may be led out.
    """
    shape = _shape(zone.at, zone.radius, zone.corners or [])
    run_at_station(station, lambda connected: _draw(connected, shape, zone))


async def _draw(station: Station, shape: Circle | list[LatLon], options: ZoneOptions) -> int:
    zone = await station.zones.draw(
        options.kind,
        shape,
        options.reason,
        floor_m=options.floor,
        ceiling_m=options.ceiling,
        lasts_s=None if options.minutes is None else 60.0 * options.minutes,
    )
    if isinstance(zone, Refusal):
        print_line(refused(zone))
        return REFUSED
    if options.as_json:
        print_json(msgspec.to_builtins(zone))
    else:
        print_line(f"zone {zone.id} is in force: {zone.name}, {_heights(zone)}, {_until(zone)}")
    return DONE


@zone_app.command("end")
@station_command
async def end_command(
    station: Station,
    number: Annotated[int, typer.Argument(metavar="ID", help="The zone's number.")],
) -> int:
    """End a zone.

    Nothing is sent, and nothing that was held resumes automatically.
    """
    refusal = await station.zones.end(number)
    print_line(f"zone {number} has ended (audited)" if refusal is None else refused(refusal))
    return DONE if refusal is None else REFUSED


@zone_app.command("list")
@station_command
async def list_command(
    station: Station,
    as_json: JsonOption = False,
) -> int:
    """Show the temporary zones in force."""
    zones = await station.zones.in_force()
    if as_json:
        print_json(msgspec.to_builtins(zones))
        return DONE
    columns = ("id", "kind", "size", "heights", "by", "reason", "end")
    print_table("temporary zones", columns, [_row(zone) for zone in zones])
    print_line(f"{len(zones)} temporary zones in force")
    return DONE


def _shape(at: str | None, radius_m: float | None, corners: list[str]) -> Circle | list[LatLon]:
    is_circle = at is not None and radius_m is not None
    if is_circle is bool(corners) or (at is None) is not (radius_m is None):
        raise ZoneShapeError(
            "Name a circle (--at LAT,LON --radius-m METRES) or an outline (--corner LAT,LON, three "
            "times or more)"
        )
    if at is not None and radius_m is not None:
        return Circle(_place(at), radius_m)
    return [_place(corner) for corner in corners]


def _place(text: str) -> LatLon:
    try:
        latitude_deg, longitude_deg = (float(part) for part in text.split(","))
    except ValueError:
        raise ZoneShapeError(f"expected LAT,LON in degrees, got {text!r}") from None
    return LatLon(latitude_deg, longitude_deg)


def _row(zone: TemporaryZoneStatus) -> tuple[str, ...]:
    is_circle = zone.radius_m is not None
    size = f"radius {zone.radius_m:g} m" if is_circle else f"{len(zone.ring) - 1} corners"
    kind = zone.kind.value.replace("_", " ")
    return (str(zone.id), kind, size, _heights(zone), zone.by, zone.reason, _until(zone))


def _heights(zone: TemporaryZoneStatus) -> str:
    if zone.floor_m is None and zone.ceiling_m is None:
        return "all heights"
    top = "up" if zone.ceiling_m is None else f"to {zone.ceiling_m:g} m above ground"
    return f"from {zone.floor_m or 0.0:g} m {top}"


def _until(zone: TemporaryZoneStatus) -> str:
    if zone.ends_in_s is None:
        return "until a person ends it"
    return f"ends in {zone.ends_in_s / 60.0:.0f} min"
