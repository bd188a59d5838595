"""The station's announcement as an app finds it, by real mDNS packets on loopback."""

import queue
from collections.abc import Iterator

import pytest
from hypothesis import example, given
from hypothesis import strategies as st
from zeroconf import DNSIncoming, DNSOutgoing, DNSPointer, ServiceBrowser, ServiceListener, Zeroconf
from zeroconf.const import _CLASS_IN, _FLAGS_QR_RESPONSE, _TYPE_PTR

from recon.link.announcement import (
    SERVICE_TYPE,
    Announcement,
    AnnouncementError,
    instance_name,
)

LOOPBACK = "127.0.0.1"
PATIENCE_S = 60.0


class Seen(ServiceListener):
    """The names that appear (+) and disappear (-), as they come."""

    def __init__(self) -> None:
        self.changes: queue.Queue[str] = queue.Queue()

    def add_service(self, zc: Zeroconf, type_: str, name: str) -> None:
        self.changes.put(f"+{name}")

    def remove_service(self, zc: Zeroconf, type_: str, name: str) -> None:
        self.changes.put(f"-{name}")

    def update_service(self, zc: Zeroconf, type_: str, name: str) -> None:
        """An address more: the name stays."""

    def wait_for(self, change: str) -> None:
        while self.changes.get(timeout=PATIENCE_S) != change:
            pass


@pytest.fixture
def phone() -> Iterator[Zeroconf]:
    with Zeroconf(interfaces=[LOOPBACK]) as phone:
        yield phone


def test_an_app_finds_the_station_while_it_runs(phone: Zeroconf) -> None:
    announcement = Announcement("creek on laptop-7", [LOOPBACK], 3001)
    seen = Seen()
    ServiceBrowser(phone, SERVICE_TYPE, seen)
    announcement.start()
    name = f"{announcement.name}.{SERVICE_TYPE}"
    assert announcement.name.startswith("creek on laptop-7")
    seen.wait_for(f"+{name}")
    info = phone.get_service_info(SERVICE_TYPE, name, timeout=60_000)
    assert info is not None
    assert (info.parsed_addresses(), info.port) == ([LOOPBACK], 3001)
    announcement.stop()
    seen.wait_for(f"-{name}")


def test_without_a_network_address_it_is_one_sentence() -> None:
    for addresses in ([], ["fe80::1%eth0"]):
        announcement = Announcement("creek", addresses, 3001)
        with pytest.raises(AnnouncementError, match=r"no network address that phones reach; type"):
            announcement.start()
        announcement.stop()


@pytest.mark.parametrize(
    ("text", "name"),
    [
        ("Field by the creek on laptop", "Field by the creek on laptop"),
        ("laptop.local", "laptop local"),
        ("a\nb\x00\u202ec", "a b c"),
        ("", "station"),
        ("...", "station"),
        ("_sub._http", "sub _http"),
        ("ü" * 40, "ü" * 28),
    ],
)
def test_any_text_becomes_a_name_that_mdns_can_carry(text: str, name: str) -> None:
    assert instance_name(text) == name


@given(st.text(max_size=80))
@example("_sub")
@example("x._tcp.local.")
@example("\udce4" * 70)
@example("a\x1b[2Jb; rm -rf / <script>")
def test_a_hostile_name_is_one_label_of_the_record(text: str) -> None:
    """Read back from the packet as it was, under our type, and printable on a terminal."""
    name = instance_name(text)
    assert name.isprintable()
    packet = DNSOutgoing(_FLAGS_QR_RESPONSE)
    full = f"{name}-99.{SERVICE_TYPE}"
    packet.add_answer_at_time(DNSPointer(SERVICE_TYPE, _TYPE_PTR, _CLASS_IN, 60, full), 0)
    (sent,) = packet.packets()
    incoming = DNSIncoming(sent)
    assert incoming.valid
    (answer,) = incoming.answers()
    assert isinstance(answer, DNSPointer)
    assert (answer.name, answer.alias) == (SERVICE_TYPE, full)
    assert len(answer.alias.split(".")) == 5
