"""The HTTP servers of a station: loopback without TLS, and the network with TLS and login.

Both serve one application, with rules of access of their own. Loopback is always there: the
operator at the station's computer must be able to stop vehicles whatever is wrong with certificates
or users.
"""

import errno
import getpass
import socket
from collections.abc import Sequence
from dataclasses import dataclass
from datetime import UTC, datetime
from pathlib import Path

import uvicorn
from starlette.types import ASGIApp

from recon.api.addresses import SharedAddress, in_url, is_loopback, reachable_addresses
from recon.api.certificate import Certificate, load_certificate, own_certificate
from recon.api.connections import PING_S, HttpConnection, StreamConnection
from recon.api.login import Login
from recon.api.security import LOCAL_PERSON, Access, AccessCheck
from recon.api.servers import HttpServer, HttpsServer
from recon.api.stop_signals import on_stop
from recon.model.errors import ReconError, RecordError
from recon.model.person import THIS_COMPUTER, Person, Role, is_name
from recon.record.files.users_file import read_users, state_folder

HTTP_BACKLOG = 128
SHUTDOWN_S = 2


class StartError(ReconError):
    """The station cannot start; the text states why, and what to do."""


@dataclass(frozen=True, slots=True)
class NetworkConfig:
    """The HTTPS address for other computers; the certificate is generated without one given."""

    users_file: Path
    host: str | None = None
    """None: other computers reach nothing."""
    port: int = 8443
    certificate: Path | None = None
    key: Path | None = None


def require_startable(http_host: str, network: NetworkConfig) -> None:
    """Raise `StartError` for addresses that would let strangers in."""
    if not is_loopback(http_host):
        raise StartError(
            f"host {http_host} opens the console to the network without encryption and login; "
            "--http-host takes a loopback address. For other computers run `recon user add NAME "
            f"--role operator` once, then start with --https-host {http_host}"
        )
    if network.host is not None and not _users(network.users_file):
        raise StartError(
            f"--https-host {network.host}: no users in {network.users_file}, so no one could log "
            "in; run `recon user add NAME --role operator` first, with the same --users if given"
        )
    if (network.certificate is None) is not (network.key is None):
        raise StartError("--certificate and --key belong together: give both, or neither")


def certificate_of(network: NetworkConfig) -> Certificate | None:
    """Return the certificate for the network's address; raises `StartError`."""
    if network.host is None:
        return None
    try:
        if network.certificate is not None and network.key is not None:
            return load_certificate(network.certificate, network.key)
        folder = state_folder() / "https"
        return own_certificate(folder, reachable_addresses(network.host), datetime.now(UTC))
    except RecordError as problem:
        raise StartError(str(problem)) from problem


def local_person() -> Person:
    """Return the person of requests over loopback: the user of this computer.

    An administrator: programs of this user can end the station and write its files anyway.
    """
    try:
        name = getpass.getuser()
    except (OSError, KeyError, ImportError):
        return LOCAL_PERSON
    return Person(name, Role.ADMIN, THIS_COMPUTER) if is_name(name) else LOCAL_PERSON


def loopback_server(app: ASGIApp, login: Login, host: str) -> HttpServer:
    """Return the server of a loopback address."""
    return HttpServer(_config(AccessCheck(app, Access.loopback(login, local_person(), host))))


def network_server(app: ASGIApp, login: Login, certificate: Certificate) -> HttpsServer:
    """Return the server of the address for other computers."""
    config = _config(AccessCheck(app, Access.network(login)))
    return HttpsServer(config, certificate.context)


def url_of(host: str, sock: socket.socket, scheme: str = "http") -> str:
    """Return the URL of a host on a listening socket."""
    return f"{scheme}://{in_url(host)}:{sock.getsockname()[1]}"


def shared_address(
    config: NetworkConfig, certificate: Certificate | None, sock: socket.socket | None
) -> SharedAddress | None:
    """Return what other computers use, None when they reach nothing."""
    if config.host is None or certificate is None or sock is None:
        return None
    hosts = reachable_addresses(config.host)
    urls = tuple(url_of(host, sock, "https") for host in hosts)
    return SharedAddress(urls, certificate.fingerprint)


def listen(host: str, port: int, option: str) -> socket.socket:
    """Return a listening socket; raises `StartError`."""
    family = socket.AF_INET6 if ":" in host else socket.AF_INET
    sock = socket.socket(family, socket.SOCK_STREAM)
    try:
        sock.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        sock.bind((host, port))
        # Listen at once: the address must be open when it is printed, and a second station started
        # at the same moment must find the port in use.
        sock.listen(HTTP_BACKLOG)
    except (OSError, OverflowError) as problem:
        sock.close()
        raise cannot_listen(host, port, option, problem) from problem
    return sock


def cannot_listen(host: str, port: int, option: str, problem: Exception) -> StartError:
    """Return the error of an address that cannot be bound."""
    if isinstance(problem, OSError) and problem.errno == errno.EADDRINUSE:
        return StartError(
            f"port {port} of {host} is in use, perhaps by another station; stop that one, or "
            f"choose another port with {option}"
        )
    reason = problem.strerror if isinstance(problem, OSError) else problem
    return StartError(f"cannot listen on {host} port {port}: {reason}; see {option}")


def stop_on_signals(servers: Sequence[uvicorn.Server]) -> None:
    """End the servers on SIGINT and SIGTERM; the second one does not wait for open requests.

    It holds until the process ends: a signal repeated meanwhile would interrupt the end of links
    and record.
    """

    def stop() -> None:
        for server in servers:
            server.force_exit = server.should_exit
            server.should_exit = True

    on_stop(stop)


def _users(path: Path) -> bool:
    try:
        return bool(read_users(path))
    except RecordError as problem:
        raise StartError(str(problem)) from problem


def _config(app: ASGIApp) -> uvicorn.Config:
    return uvicorn.Config(
        app,
        log_level="warning",
        access_log=False,
        server_header=False,
        # An address in a header is a claim; the audit names the connection's.
        proxy_headers=False,
        http=HttpConnection,
        # Its send waits while the reader's socket takes no more: see api/streams.py.
        ws=StreamConnection,
        ws_max_size=64 * 1024,
        ws_ping_interval=PING_S,
        ws_ping_timeout=PING_S,
        timeout_graceful_shutdown=SHUTDOWN_S,
        lifespan="off",
    )
