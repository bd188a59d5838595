"""`recon gateway`: a station's vehicles in the protocols of other programs."""

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from recon.api.addresses import is_loopback
from recon.cli.commands import App
from recon.cli.connection import StationOptions, station_at
from recon.cli.endpoints import host_and_port
from recon.cli.foreground import print_now, run_in_loop, until_stopped
from recon.cli.options import with_options
from recon.client import Station
from recon.gateway.endpoints import shown_endpoint
from recon.gateway.errors import GatewayError
from recon.geo.geoid import geoid_height_m
from recon.model.extras import from_extra

if TYPE_CHECKING:
    from recon.gateway.mavlink.run import Endpoints

gateway_app = App(help="Show the vehicles to other ground stations.", no_args_is_help=True)
"""A command for each protocol."""


@gateway_app.callback()
def _group() -> None:
    """Show the vehicles to other ground stations."""


DEFAULT_TCP = "127.0.0.1:5760"
DEFAULT_FOXGLOVE = "127.0.0.1:8765"
MAX_PLACES = 8


@dataclass(frozen=True, slots=True, kw_only=True)
class MavlinkOptions:
    """Where clients are, what they may do, and how heights are told."""

    tcp: Annotated[
        list[str] | None,
        typer.Option(metavar="HOST:PORT", help=f"Listen for TCP clients; default: {DEFAULT_TCP}."),
    ] = None
    udp: Annotated[
        list[str] | None, typer.Option(metavar="HOST:PORT", help="Listen for UDP clients.")
    ] = None
    udp_to: Annotated[
        list[str] | None,
        typer.Option(metavar="HOST:PORT", help="Send to a UDP client, such as 127.0.0.1:14550."),
    ] = None
    signing_key: Annotated[
        Path | None,
        typer.Option(help="File with the key: 64 hexadecimal digits, or a passphrase."),
    ] = None
    allow_orders: Annotated[
        bool,
        typer.Option("--allow-orders", help="Let clients order, as the person of the login."),
    ] = False
    ground_above_sea_level_m: Annotated[
        float | None,
        typer.Option(
            "--ground-above-sea-level",
            min=-500.0,
            max=9000.0,
            help="Altitude of the takeoff points that clients are told, metres; default: the "
            "site's ground.",
        ),
    ] = None


@gateway_app.command("mavlink")
@with_options
def mavlink_command(options: MavlinkOptions, at: StationOptions) -> None:
    """Show every identified vehicle as a MAVLink 2 vehicle, until Ctrl+C.

    Read-only unless --allow-orders.
    """
    with from_extra("gateway", "a gateway of MAVLink", GatewayError):
        from recon.gateway.mavlink.run import Endpoints

    udp, udp_to = _places("--udp", options.udp), _places("--udp-to", options.udp_to, lowest_port=1)
    tcp = _places("--tcp", options.tcp or ([] if udp or udp_to else [DEFAULT_TCP]))
    _check_reach(options, (*tcp, *udp, *udp_to))
    run_in_loop(until_stopped(_run(options, at, Endpoints(tcp, udp, udp_to)), "stopped"))


async def _run(options: MavlinkOptions, at: StationOptions, places: "Endpoints") -> None:
    from recon.gateway.mavlink.run import MavlinkGateway
    from recon.gateway.mavlink.signing import Signer, read_key
    from recon.gateway.mavlink.values import GatewaySettings

    signer = None if options.signing_key is None else Signer(read_key(options.signing_key))
    async with station_at(at, is_operator=False) as station:
        ground_m = options.ground_above_sea_level_m
        if ground_m is None:
            ground_m = await _ground_above_sea_level_m(station)
        settings = GatewaySettings(options.allow_orders, ground_m)
        gateway = MavlinkGateway(station, settings, signer, print_now)
        async with gateway.listening(places):
            for place in gateway.places:
                print_now(f"MAVLink clients: {shown_endpoint(place)}")
            for place in places.udp_to:
                print_now(f"MAVLink to: {shown_endpoint(place)}")
            print_now(f"takeoff points: {ground_m:.1f} m above sea level")
            print_now("orders: allowed" if settings.allow_orders else "orders: none, read-only")
            await gateway.run()


@dataclass(frozen=True, slots=True, kw_only=True)
class FoxgloveOptions:
    """Where clients connect, and who may."""

    listen: Annotated[
        str, typer.Option(metavar="HOST:PORT", help="Where Foxglove or Lichtblick connects.")
    ] = DEFAULT_FOXGLOVE
    allow_network: Annotated[
        bool,
        typer.Option("--allow-network", help="Let other computers read; there is no login."),
    ] = False


@gateway_app.command("foxglove")
@with_options
def foxglove_command(options: FoxgloveOptions, at: StationOptions) -> None:
    """Show vehicles, maps and log live in Foxglove or Lichtblick, until Ctrl+C.

    Under the topics of a flight's record, and read-only.
    """
    with from_extra("gateway", "a gateway for Foxglove", GatewayError):
        import recon.gateway.foxglove.run  # noqa: F401
    place = host_and_port("--listen", options.listen, lowest_port=0)
    if not (options.allow_network or is_loopback(place[0])):
        raise GatewayError(
            f"{place[0]} can be reached from other computers: expected --allow-network, as the "
            "protocol has no login and who reads it learns where every vehicle is"
        )
    run_in_loop(until_stopped(_run_foxglove(place, at), "stopped"))


async def _run_foxglove(place: tuple[str, int], at: StationOptions) -> None:
    from recon.gateway.foxglove.run import FoxgloveGateway

    async with station_at(at, is_operator=False) as station:
        gateway = FoxgloveGateway(station, print_now)
        async with gateway.listening(place) as bound:
            print_now(f"Foxglove clients: ws://{shown_endpoint(bound)}")
            print_now("read-only: clients can order and change nothing")
            await gateway.run()


async def _ground_above_sea_level_m(station: Station) -> float:
    """Return the altitude of the site's ground; 0 of a site without a position."""
    origin = await station.surveys.site_origin()
    if origin is None or origin.ground_altitude_m is None:
        return 0.0
    if origin.latitude_deg is None or origin.longitude_deg is None:
        return 0.0
    return origin.ground_altitude_m - geoid_height_m(origin.latitude_deg, origin.longitude_deg)


def _places(option: str, texts: list[str] | None, lowest_port: int = 0) -> list[tuple[str, int]]:
    if texts is not None and len(texts) > MAX_PLACES:
        raise GatewayError(f"{option}: expected up to {MAX_PLACES} addresses, got {len(texts)}")
    return [host_and_port(option, text, lowest_port) for text in texts or ()]


def _check_reach(options: MavlinkOptions, places: tuple[tuple[str, int], ...]) -> None:
    """Refuse orders from other computers without signatures: MAVLink has no other login."""
    outside = next((host for host, _ in places if not is_loopback(host)), None)
    if outside is not None and options.allow_orders and options.signing_key is None:
        raise GatewayError(
            f"{outside} can be reached from other computers: expected --signing-key with "
            "--allow-orders, as MAVLink has no other login; without orders none is needed"
        )
