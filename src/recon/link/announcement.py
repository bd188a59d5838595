"""The station announces itself by mDNS, so that companion apps in the network find it by name.

A convenience: an announcement that fails, or that anyone in the network imitates, changes nothing
about who may connect. Our app shows the address of what it found, and a person chooses. The library
has a thread and an event loop of its own, and bounds what it keeps of other computers' packets.
"""

import re
import socket
from collections.abc import Sequence
from ipaddress import ip_address
from typing import TYPE_CHECKING

from recon.model.errors import ReconError

if TYPE_CHECKING:
    from zeroconf import ServiceInfo, Zeroconf

SERVICE_TYPE = "_recon._tcp.local."
MAX_NAME_BYTES = 56
"""A label has 63 (RFC 1035); the rest is for the number of a second station of the same name."""
_NOT_IN_HOST_NAMES = re.compile(r"[^A-Za-z0-9-]+")


class AnnouncementError(ReconError):
    """The station cannot be announced; apps still connect by its address."""

    is_failure = True


class Announcement:
    """The announcement of one station, from `start` to `stop`; both block: call them on a thread
    that runs no event loop."""

    def __init__(self, name: str, addresses: Sequence[str], port: int) -> None:
        """Take the IP addresses at which apps reach the station; it is announced there only."""
        self._wanted = f"{instance_name(name)}.{SERVICE_TYPE}"
        self._addresses, self._port = [each for each in addresses if _needs_no_zone(each)], port
        self._zeroconf: Zeroconf | None = None
        self._info: ServiceInfo | None = None

    @property
    def name(self) -> str:
        """The announced name: with a number if another station in the network has the same."""
        found = self._info.name if self._info is not None else self._wanted
        return found.removesuffix(f".{SERVICE_TYPE}")

    def start(self) -> None:
        """Announce the station. Raises `AnnouncementError`."""
        from zeroconf import Error, ServiceInfo, Zeroconf

        if not self._addresses:
            raise _failed("this computer has no network address that phones reach")
        try:
            self._zeroconf = Zeroconf(interfaces=self._addresses)
            self._info = ServiceInfo(
                SERVICE_TYPE,
                self._wanted,
                port=self._port,
                parsed_addresses=self._addresses,
                server=_host_label(socket.gethostname(), self._port),
            )
            self._zeroconf.register_service(self._info, allow_name_change=True)
        except (OSError, Error) as problem:
            self.stop()
            raise _failed(str(problem) or type(problem).__name__) from problem

    def stop(self) -> None:
        """Withdraw the announcement, so that apps drop the station from their lists at once."""
        zeroconf, self._zeroconf = self._zeroconf, None
        if zeroconf is not None:
            zeroconf.close()


def instance_name(text: str) -> str:
    """Return a text as a name in mDNS: one printable line without dots that fits a label."""
    plain = "".join(" " if char == "." or not char.isprintable() else char for char in text)
    # With an underscore in front it would be a type.
    line = " ".join(plain.split()).lstrip("_ ")
    return line.encode()[:MAX_NAME_BYTES].decode(errors="ignore").strip() or "station"


def _host_label(host_name: str, port: int) -> str:
    """Return a host of the announcement's own: the computer's name may be announced already."""
    plain = _NOT_IN_HOST_NAMES.sub("-", host_name.partition(".")[0])[:40].strip("-")
    return f"recon-{plain or 'station'}-{port}.local."


def _needs_no_zone(address: str) -> bool:
    """Return whether an address is enough: link-local ones of IPv6 need their interface too."""
    parsed = ip_address(address)
    return parsed.version == 4 or not parsed.is_link_local


def _failed(why: str) -> AnnouncementError:
    return AnnouncementError(
        f"cannot announce the station by mDNS: {why}; type its address in apps"
    )
