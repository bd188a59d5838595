"""What the station and its guard say to each other: one line of JSON each, over a socket pair.

Station to guard: a duplicate of an app's socket (it comes with the line), a closed link, a picture
of all links (the heartbeat), the receipt of what the guard did. Guard to station: that it has taken
a picture, and what it did.
Times are sent as ages: the two processes' clocks need not agree.
"""

import json
from collections.abc import Iterable, Iterator
from dataclasses import asdict, dataclass
from typing import Any

from recon.guard.watch import Intervention, Picture, Watched
from recon.model.units import NS_PER_S, Stamped
from recon.model.vehicle import VehicleState

ALIVE, INTERVENED = "alive", "intervention"
SOCKET, CLOSED, PICTURE, NOTED, OVER = "socket", "closed", "picture", "noted", "over"


@dataclass(frozen=True, slots=True)
class LinkPicture:
    """What the station believes of one link: ages in seconds, None where nothing is known."""

    link_id: int
    serial: str | None
    name: str
    is_flying: bool | None
    reported_is_flying: bool | None
    age_s: float | None
    is_steered: bool


def socket_line(link_id: int) -> bytes:
    """The line that a duplicate of a link's socket comes with."""
    return _line({"is": SOCKET, "link": link_id})


def closed_line(link_id: int) -> bytes:
    """A link has closed."""
    return _line({"is": CLOSED, "link": link_id})


def noted_line() -> bytes:
    """The station has taken note of every intervention."""
    return _line({"is": NOTED})


def over_line() -> bytes:
    """The station ends in order; the guard ends too."""
    return _line({"is": OVER})


def picture_line(links: Iterable[LinkPicture]) -> bytes:
    """The picture of all links."""
    return _line({"is": PICTURE, "links": [asdict(link) for link in links]})


def picture_of(message: dict[str, Any], now_ns: int) -> Picture:
    """Return a picture with its times in the guard's clock."""
    links = [LinkPicture(**link) for link in message["links"]]
    return Picture({link.link_id: _watched(link, now_ns) for link in links})


def _watched(link: LinkPicture, now_ns: int) -> Watched:
    at_ns = None if link.age_s is None else now_ns - round(link.age_s * NS_PER_S)
    vehicle = VehicleState(
        serial=link.serial,
        link_id=link.link_id,
        is_flying=Stamped(link.is_flying, at_ns),
        reported_is_flying=Stamped(link.reported_is_flying, at_ns),
        core_received_at_ns=at_ns,
    )
    return Watched(link.name, vehicle, link.is_steered)


def alive_line() -> bytes:
    """The guard has taken a picture."""
    return _line({"is": ALIVE})


def intervention_line(intervention: Intervention) -> bytes:
    """Something the guard did."""
    return _line({"is": INTERVENED} | asdict(intervention))


def intervention_of(message: dict[str, Any]) -> Intervention:
    """Return what the guard did."""
    serials, names, refused = (tuple(message[key]) for key in ("serials", "names", "refused"))
    return Intervention(message["why"], serials, names, refused, message["by"])


class Lines:
    """Takes bytes as they come and returns whole messages."""

    def __init__(self) -> None:
        self._rest = b""

    def feed(self, data: bytes) -> Iterator[dict[str, Any]]:
        """Yield the messages that are whole."""
        *lines, self._rest = (self._rest + data).split(b"\n")
        for line in lines:
            yield json.loads(line)


def _line(message: dict[str, Any]) -> bytes:
    return json.dumps(message, separators=(",", ":")).encode() + b"\n"
