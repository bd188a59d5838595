"""When a station announces itself: only where phones reach it, and never in its own way."""

import asyncio
from collections.abc import Sequence
from contextlib import AsyncExitStack
from typing import Any

import pytest
import zeroconf

from recon.station.host.announcing import announce, require_announceable
from recon.station.host.http_servers import StartError


class Made:
    """In the place of zeroconf: what would have been announced."""

    made: list["Made"] = []  # noqa: RUF012

    def __init__(self, interfaces: Sequence[str]) -> None:
        self.interfaces = interfaces
        self.services: list[Any] = []
        self.made.append(self)

    def register_service(self, info: Any, allow_name_change: bool) -> None:
        assert allow_name_change
        self.services.append(info)

    def close(self) -> None:
        self.services.clear()


@pytest.fixture
def made(monkeypatch: pytest.MonkeyPatch) -> list[Made]:
    monkeypatch.setattr(Made, "made", [])
    monkeypatch.setattr(zeroconf, "Zeroconf", Made)
    monkeypatch.setattr("recon.api.addresses.own_addresses", lambda: ("192.0.2.5", "2001:db8::7"))
    return Made.made


def announced(*bound: str) -> None:
    """Begin and end an announcement of a station that is bound to addresses."""

    async def run() -> None:
        async with AsyncExitStack() as last:
            announce("creek", bound, 3001, last)

    asyncio.run(run())


@pytest.mark.parametrize("host", ["127.0.0.1", "127.0.0.2", "::1", "localhost"])
def test_loopback_is_refused_before_anything_starts(host: str) -> None:
    with pytest.raises(StartError, match=r"--announce needs .* add --link-host 0\.0\.0\.0"):
        require_announceable(host)
    require_announceable("0.0.0.0")


def test_a_name_that_turns_out_to_be_loopback_is_not_announced(
    made: list[Made], capsys: pytest.CaptureFixture[str]
) -> None:
    announced("127.0.1.1", "::1")
    assert made == []
    assert "no network address that phones reach; type its address" in capsys.readouterr().out


@pytest.mark.parametrize(
    ("bound", "at"),
    [
        (("0.0.0.0",), ["192.0.2.5"]),
        (("::",), ["2001:db8::7"]),
        (("192.0.2.9", "127.0.0.1"), ["192.0.2.9"]),
    ],
)
def test_it_is_announced_where_it_is_reached(
    made: list[Made], monkeypatch: pytest.MonkeyPatch, bound: tuple[str, ...], at: list[str]
) -> None:
    services = []
    monkeypatch.setattr(Made, "close", lambda self: services.extend(self.services))
    announced(*bound)
    assert [each.interfaces for each in made] == [at]
    (service,) = services
    assert service.parsed_addresses() == at
    assert service.port == 3001
    assert service.name.startswith("creek on ")


@pytest.mark.parametrize(
    ("problem", "text"),
    [
        (zeroconf.NonUniqueNameException(), "NonUniqueName"),
        (OSError(19, "No such device"), "device"),
    ],
)
def test_a_failure_beside_the_station_is_a_logged_sentence(
    made: list[Made],
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
    problem: Exception,
    text: str,
) -> None:
    def fail(*_: Any, **__: Any) -> None:
        raise problem

    monkeypatch.setattr(Made, "register_service", fail)
    announced("0.0.0.0")
    (line,) = capsys.readouterr().out.splitlines()
    assert "cannot announce the station by mDNS: " in line
    assert text in line
