"""Which companion apps may become vehicles: an optional list of serials and addresses.

Theory of operation. The protocol has no secret: an app proves nothing about itself. Without a list
any app that reports a serial is that vehicle. With one, an app is admitted when an entry agrees
with it: an entry names a serial, an address or network, or both. A serial that has entries is
accepted by these alone, so an entry for a whole network never opens a serial that is bound to
another address. An app that no entry admits waits (`fleet.pairing`). Entries of the session end
with the run.
"""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from ipaddress import IPv4Address, IPv4Network, IPv6Address, IPv6Network, ip_address, ip_network

Address = IPv4Address | IPv6Address
Network = IPv4Network | IPv6Network

MAX_ENTRIES = 256
"""Most entries of the list, and of a session: four times the vehicles of the largest site."""

NOT_LISTED = "its serial is not on the list"


@dataclass(frozen=True, slots=True)
class AllowedApp:
    """One entry. `serial` None: any serial without entries of its own; `network` None: any."""

    serial: str | None = None
    network: Network | None = None

    def takes_address(self, address: Address | None) -> bool:
        """Return whether the entry allows an address; an unknown one only without a network."""
        if self.network is None:
            return True
        return address is not None and address in self.network


@dataclass(frozen=True, slots=True)
class Admission:
    """The list in force, what was admitted for this run, and what was refused for a while.

    `listed` None: there is no list, and every app is admitted. `refused_until_ns` is by host and
    serial ("" before it reported one).
    """

    listed: tuple[AllowedApp, ...] | None = None
    session: tuple[AllowedApp, ...] = ()
    refused_until_ns: Mapping[tuple[str, str], int] = field(default_factory=dict)

    @property
    def is_in_force(self) -> bool:
        """Whether there is a list."""
        return self.listed is not None

    def objection(self, serial: str, address: Address | None) -> str | None:
        """Return why an app with this serial and address is not admitted, else None."""
        if self.listed is None:
            return None
        entries = (*self.listed, *self.session)
        own = [entry for entry in entries if entry.serial == serial]
        if any(entry.takes_address(address) for entry in own):
            return None
        if own:
            return f"its serial is expected from {_listed(own)}"
        anyone = (entry for entry in entries if entry.serial is None)
        return None if any(entry.takes_address(address) for entry in anyone) else NOT_LISTED

    def may_admit(self, address: Address | None) -> bool:
        """Return whether any serial at all is admitted from an address."""
        if self.listed is None:
            return True
        return any(entry.takes_address(address) for entry in (*self.listed, *self.session))

    def is_listed(self, serial: str) -> bool:
        """Return whether entries name this serial."""
        entries = (*(self.listed or ()), *self.session)
        return any(entry.serial == serial for entry in entries)


ANY_APP = Admission()


def host_of(remote_address: str) -> str:
    """Return the host of `host:port` or `[host]:port`."""
    return remote_address.rpartition(":")[0].strip("[]") or remote_address


def address_of(remote_address: str) -> Address | None:
    """Return the address of `host:port`; None when it is no IP address.

    An IPv4 address in an IPv6 socket's notation counts as IPv4, and a zone index is dropped.
    """
    try:
        address = ip_address(host_of(remote_address).partition("%")[0])
    except ValueError:
        return None
    mapped = address.ipv4_mapped if isinstance(address, IPv6Address) else None
    return mapped or address


def network_of_one(address: Address) -> Network:
    """Return the network that holds one address alone."""
    return ip_network(address)


def network_text(network: Network) -> str:
    """Return a network as an operator writes it; one address without its prefix length."""
    is_one = network.prefixlen == network.max_prefixlen
    return str(network.network_address) if is_one else str(network)


def _listed(entries: Iterable[AllowedApp]) -> str:
    return " or ".join(network_text(e.network) for e in entries if e.network is not None)
