"""`recon run`: the station."""

import string
from pathlib import Path
from typing import Annotated

import typer

from recon.cli.console_files import console_folder
from recon.cli.event_loop import run_in_loop
from recon.link.settings import LinkSettings
from recon.record.audit import shown
from recon.site import Site, default_site, load_site, site_report
from recon.station.audit.start import AuditPlace
from recon.station.kernel.run import RunConfig, Started, StartError, run

SHORTEST_TOKEN = 16
TOKEN_LETTERS = frozenset(string.ascii_letters + string.digits + "-._~")
"""What travels unchanged in an address and in a WebSocket's list of subprotocols."""


def run_command(
    site: Annotated[
        Path | None, typer.Option(help="Folder with a site.toml; without one, no ground image.")
    ] = None,
    link_host: Annotated[
        str, typer.Option(help="Address for companion apps; 0.0.0.0 lets phones in.")
    ] = "127.0.0.1",
    link_port: Annotated[
        int, typer.Option(min=0, max=65535, help="Port for companion apps; 0 picks one.")
    ] = 3001,
    http_host: Annotated[
        str, typer.Option(help="Address of the console; beyond loopback a token is needed.")
    ] = "127.0.0.1",
    http_port: Annotated[
        int, typer.Option(min=0, max=65535, help="Port of the console; 0 picks one.")
    ] = 8080,
    token_file: Annotated[
        Path | None, typer.Option(help="File with the secret that opens the console.")
    ] = None,
    capture: Annotated[
        Path | None, typer.Option(help="Folder to write every link's raw bytes to.")
    ] = None,
    audit: Annotated[
        Path | None,
        typer.Option(help="Folder of the audit; default is one for the link port, see the guide."),
    ] = None,
    garbage_limit: Annotated[
        int, typer.Option(min=1024, help="Close a link after so many bytes without a packet.")
    ] = LinkSettings().garbage_limit_bytes,
) -> None:
    """Run the station until Ctrl+C."""
    config = RunConfig(
        site=default_site() if site is None else load_site(site),
        link_host=link_host,
        link_port=link_port,
        http_host=http_host,
        http_port=http_port,
        site_folder=site,
        capture_folder=capture,
        audit=None if audit is None else AuditPlace(audit),
        token=None if token_file is None else read_token(token_file),
        console=console_folder(),
        link=LinkSettings(garbage_limit_bytes=garbage_limit),
    )
    describe(config.site)
    run_in_loop(run(config, _announce))


async def _announce(started: Started) -> None:
    announce(started)


def describe(site: Site) -> None:
    """Print what the site came to: how well the control points fit, what is assumed."""
    for line in site_report(site):
        print(line, flush=True)


def announce(started: Started) -> None:
    """Print every address the station listens on."""
    for address in started.link_addresses:
        print(f"companion apps: {address}", flush=True)
    print(f"audit: {started.audit_folder}", flush=True)
    if started.taken_up:
        print(f"from the last run: {shown(started.taken_up)}; nothing is ordered", flush=True)
    print(f"console: {started.console_url}", flush=True)


def read_token(path: Path) -> str:
    """Return the secret in a file; raises `StartError` for a missing file or a short secret."""
    try:
        token = path.read_text(encoding="utf-8").strip()
    except (OSError, UnicodeDecodeError) as problem:
        raise StartError(f"cannot read the token file {path}: {problem}") from problem
    if len(token) < SHORTEST_TOKEN:
        raise StartError(
            f"{path}: expected a secret of {SHORTEST_TOKEN} characters or more, got {len(token)}"
        )
    if not TOKEN_LETTERS.issuperset(token):
        raise StartError(
            f"{path}: expected a secret of letters, digits and -._~ only, got others: browsers "
            "cannot send those; `openssl rand -hex 24` makes a good one"
        )
    return token
