"""`recon sim proxy`: a bad link on purpose, between any app and the station."""

import asyncio
import sys
from typing import Annotated

import typer

from recon.cli.places import parse_place
from recon.cli.until_stopped import say_at_once, until_stopped
from recon.model.errors import ReconError
from recon.sim.proxy import Damage, ProxyConfig, Towards, run_proxy

MS_PER_S = 1_000.0
BYTES_PER_KB = 1_000.0


def proxy_command(
    listen: Annotated[str, typer.Option(help="HOST:PORT for apps; port 0 picks one.")] = (
        "127.0.0.1:3002"
    ),
    station: Annotated[str, typer.Option(help="HOST:PORT of the station.")] = "127.0.0.1:3001",
    delay_ms: Annotated[float, typer.Option(help="Every byte comes so much later.")] = 0.0,
    jitter_ms: Annotated[float, typer.Option(help="And up to so much later still.")] = 0.0,
    rate_kb_s: Annotated[
        float | None, typer.Option(help="Thousand bytes a second and direction, at most.")
    ] = None,
    stalls_per_min: Annotated[float, typer.Option(help="How often nothing passes.")] = 0.0,
    stall_s: Annotated[float, typer.Option(help="How long nothing passes then.")] = 2.0,
    resets_per_min: Annotated[
        float, typer.Option(help="How often a connection is ended hard.")
    ] = 0.0,
    corruption_per_mb: Annotated[float, typer.Option(help="Bytes changed in a million.")] = 0.0,
    towards: Annotated[Towards, typer.Option(help="Which direction is damaged.")] = Towards.BOTH,
    seed: Annotated[int, typer.Option(help="The same seed damages the same way.")] = 0,
) -> None:
    """Pass apps' connections on to a station and damage what passes, until Ctrl+C."""
    try:
        damage = Damage(
            delay_s=delay_ms / MS_PER_S,
            jitter_s=jitter_ms / MS_PER_S,
            rate_bytes_per_s=float("inf") if rate_kb_s is None else rate_kb_s * BYTES_PER_KB,
            stalls_per_min=stalls_per_min,
            stall_s=stall_s,
            resets_per_min=resets_per_min,
            corrupted_per_mb=corruption_per_mb,
        )
        config = ProxyConfig(
            listen=parse_place("--listen", listen, lowest_port=0),
            station=parse_place("--station", station),
            damage=damage,
            towards=towards,
            seed=seed,
        )
        asyncio.run(until_stopped(run_proxy(config, say_at_once), "proxy ended"))
    except ReconError as problem:
        print(f"recon sim proxy: {problem}", file=sys.stderr)
        raise typer.Exit(2) from None
