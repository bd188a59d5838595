"""The addresses at which other computers reach this one."""

import contextlib
import socket
import struct
import sys
from collections.abc import Iterable
from dataclasses import dataclass
from ipaddress import ip_address

if sys.platform == "linux":
    import fcntl

_SIOCGIFADDR = 0x8915
"""Linux: the IPv4 address of an interface (netdevice(7))."""

EVERY_ADDRESS = frozenset({"0.0.0.0", "::"})


@dataclass(frozen=True, slots=True)
class SharedAddress:
    """What other computers use: addresses of the console, and the certificate's fingerprint."""

    urls: tuple[str, ...]
    fingerprint: str

    @property
    def login_url(self) -> str:
        """The first address, with the fingerprint for the login page and for `--station`."""
        return f"{self.urls[0]}/#fingerprint={self.fingerprint.replace(':', '')}"


def is_loopback(host: str) -> bool:
    """Return whether a host to bind is reached from this computer only."""
    if host == "localhost":
        return True
    try:
        return ip_address(host).is_loopback
    except ValueError:
        return False


def reachable_addresses(bound_host: str) -> tuple[str, ...]:
    """Return the addresses of a bound host, of 0.0.0.0 and :: each one of this computer."""
    return (
        own_addresses() or (socket.gethostname(),) if bound_host in EVERY_ADDRESS else (bound_host,)
    )


def own_addresses() -> tuple[str, ...]:
    """Return this computer's addresses besides loopback, by its interfaces and its name."""
    found = dict.fromkeys([*_of_interfaces(), *_of_name()])
    return tuple(address for address in found if not _is_local_only(address))


def app_hosts(bound: Iterable[str]) -> tuple[str, ...]:
    """Return where apps on other devices reach bound IP addresses; none for loopback."""
    found: dict[str, None] = {}
    for host in bound:
        if host in EVERY_ADDRESS:
            # A socket of one version does not accept the other.
            version = ip_address(host).version
            own = own_addresses()
            found |= dict.fromkeys(each for each in own if ip_address(each).version == version)
        elif not is_loopback(host):
            found[host] = None
    return tuple(found)


def app_url(host: str, port: int) -> str:
    """Return an address for companion apps as their QR codes have it."""
    return f"recon://{in_url(host)}:{port}"


def in_url(host: str) -> str:
    """Return a host as a URL has it: an IPv6 address in brackets."""
    return f"[{host}]" if ":" in host else host


def _is_local_only(address: str) -> bool:
    parsed = ip_address(address.partition("%")[0])
    return parsed.is_loopback or parsed.is_link_local


def _of_name() -> list[str]:
    with contextlib.suppress(OSError):
        return [str(info[4][0]) for info in socket.getaddrinfo(socket.gethostname(), None)]
    return []


def _of_interfaces() -> list[str]:
    """Return the IPv4 addresses of the interfaces; other systems than Linux answer by name only."""
    if sys.platform != "linux":
        return []
    found = []
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as asking:
        for _, name in socket.if_nameindex():
            request = struct.pack("256s", name.encode()[:15])
            with contextlib.suppress(OSError):
                answer = fcntl.ioctl(asking.fileno(), _SIOCGIFADDR, request)
                found.append(socket.inet_ntoa(answer[20:24]))
    return found
