"""The announcement by mDNS of a station that is asked to make one, and listens beyond loopback."""

import asyncio
import socket
from collections.abc import Iterable
from contextlib import AsyncExitStack

from recon.api.addresses import app_hosts, is_loopback
from recon.link.announcement import Announcement, AnnouncementError
from recon.station.audit.log_line import print_info, print_warning
from recon.station.host.http_servers import StartError


def require_announceable(link_host: str) -> None:
    """Raise `StartError` if no phone could reach what is announced."""
    if is_loopback(link_host):
        raise StartError(
            f"--announce needs an address that phones reach; {link_host} is reached from this "
            "computer only: add --link-host 0.0.0.0"
        )


def announce(site: str, bound: Iterable[str], port: int, last: AsyncExitStack) -> None:
    """Announce a site's station at the addresses that phones reach of those it is bound to.

    It begins and ends beside the station, as each takes a second, and `last` must end after the
    links. A failure is logged: apps connect by the address.
    """
    announcement = Announcement(f"{site} on {socket.gethostname()}", app_hosts(bound), port)
    last.push_async_callback(asyncio.to_thread, announcement.stop)
    starting = asyncio.create_task(asyncio.to_thread(_start, announcement))
    last.push_async_callback(asyncio.wait, [starting])


def _start(announcement: Announcement) -> None:
    try:
        announcement.start()
    except AnnouncementError as problem:
        print_warning(str(problem))
    else:
        print_info(f"announced by mDNS: {announcement.name}")
