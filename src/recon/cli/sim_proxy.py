"""`recon sim proxy`: a degraded link between any app and the station."""

import asyncio
from typing import Annotated

import typer

from recon.cli.endpoints import host_and_port
from recon.cli.foreground import print_now, until_stopped
from recon.sim.proxy import Damage, ProxyConfig, Towards, run_proxy

MS_PER_S = 1_000.0
BYTES_PER_KB = 1_000.0


def proxy_command(
    listen: Annotated[str, typer.Option(help="HOST:PORT for apps; port 0: any free port.")] = (
        "127.0.0.1:3002"
    ),
    station: Annotated[str, typer.Option(help="HOST:PORT of the station.")] = "127.0.0.1:3001",
    delay_ms: Annotated[float, typer.Option(help="Delay of every byte.")] = 0.0,
    jitter_ms: Annotated[float, typer.Option(help="Random extra delay, at most.")] = 0.0,
    rate_kb_s: Annotated[float | None, typer.Option(help="Rate limit per direction, kB/s.")] = None,
    stalls_per_min: Annotated[float, typer.Option(help="Stalls per minute.")] = 0.0,
    stall_s: Annotated[float, typer.Option(help="Duration of a stall.")] = 2.0,
    resets_per_min: Annotated[float, typer.Option(help="Connection resets per minute.")] = 0.0,
    corruption_per_mb: Annotated[float, typer.Option(help="Corrupted bytes per megabyte.")] = 0.0,
    towards: Annotated[Towards, typer.Option(help="The degraded direction.")] = Towards.BOTH,
    seed: Annotated[int, typer.Option(help="The same seed gives the same faults.")] = 0,
) -> None:
    """Forward apps' connections to a station over a degraded link.

    It runs until Ctrl+C.
    """
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
        listen=host_and_port("--listen", listen, lowest_port=0),
        station=host_and_port("--station", station),
        damage=damage,
        towards=towards,
        seed=seed,
    )
    asyncio.run(until_stopped(run_proxy(config, print_now), "proxy ended"))
