"""Every app's connections over random links, and a tap on the bytes of both directions."""

from collections.abc import Callable, Iterable
from dataclasses import dataclass, field
from functools import partial
from random import Random

from recon import wire
from recon.model.units import seconds_to_ns
from recon.sim.app.app import MAIN_LINK, NEVER_NS, LinkOrder, LinkOrderKind, SimulatedApp
from recon.sim.fake_link import FakeLink
from recon.station.kernel.virtual import VirtualDriver

SECOND_LINK = 1
RECONNECTS_AFTER_S = 2.0
SLOWEST_ALIVE_S = 0.35
"""A downlink with a longer delay than this does not count as living: no hold arrives in time."""

OnPacket = Callable[[str, wire.Packet, float], None]
"""A packet that reached an app: serial, packet, the link's longest delay then in seconds."""
OnCore = Callable[[str, tuple[float, float]], None]
"""Core telemetry that left an app: serial, latitude and longitude."""
OnDamage = Callable[[str], None]
"""Bytes of a vehicle were changed on their way to the station: its serial."""


@dataclass(slots=True)
class TappedConnection:
    """One connection of an app; an abandoned one stays open, but neither reads nor writes."""

    app: SimulatedApp
    link: FakeLink
    number: int
    splits: Random | None
    on_packet: OnPacket
    on_core: OnCore
    is_abandoned: bool = False
    slow_until_ns: int = 0
    longest_delay_s: float = 0.0
    """Of what may still be under way."""
    _deframer: wire.Deframer = field(default_factory=wire.Deframer)

    def receive(self, data: bytes, now_ns: int) -> None:
        """Pass bytes from the station to the app, perhaps in two pieces."""
        if self.is_abandoned:
            return
        for packet in self._deframer.feed(data):
            self.on_packet(self.app.settings.serial, packet, self.delay_s(now_ns))
        pieces = self._split(data)
        for piece in pieces:
            self.app.receive(piece, now_ns, self.number)

    def advance(self, now_ns: int) -> list[bytes]:
        """Return the bytes that the app sends now, perhaps in more pieces."""
        if self.is_abandoned:
            return []
        sent = self.app.advance(now_ns, self.number)
        pieces: list[bytes] = []
        for chunk in sent:
            self._note(chunk)
            pieces += self._split(chunk)
        return pieces

    @property
    def next_due_ns(self) -> int:
        """When the app has something to do next."""
        return NEVER_NS if self.is_abandoned else self.app.next_due_ns

    def delay_s(self, now_ns: int) -> float:
        """Return the longest delay of what arrives now."""
        own_s = self.link.delay_s + self.link.jitter_s
        if now_ns >= self.slow_until_ns:
            self.longest_delay_s = own_s
        return max(self.longest_delay_s, own_s)

    def slow(self, seconds: float, delay_s: float, now_ns: int) -> None:
        """Note that the link is slow from now on; what is under way arrives late afterwards."""
        self.longest_delay_s = max(self.longest_delay_s, delay_s + self.link.jitter_s)
        self.slow_until_ns = max(
            self.slow_until_ns, now_ns + seconds_to_ns(seconds + 2.0 * delay_s + 0.5)
        )

    def _note(self, chunk: bytes) -> None:
        try:
            packet = wire.decode(chunk)
        except wire.WireError:
            return  # damaged by a fault in the app
        if isinstance(packet, wire.CoreTelemetry):
            self.on_core(self.app.settings.serial, (packet.latitude_deg, packet.longitude_deg))

    def _split(self, data: bytes) -> list[bytes]:
        if self.splits is None or len(data) < 2 or self.splits.random() < 0.8:
            return [data]
        at = self.splits.randrange(1, len(data))
        return [data[:at], data[at:]]


@dataclass(slots=True)
class _Joined:
    """An app with its present main connection; no link while it waits to reconnect."""

    app: SimulatedApp
    connection: TappedConnection | None = None
    link_id: int | None = None
    newest: list[TappedConnection] = field(default_factory=list)


@dataclass(slots=True)
class LinkedApps:
    """All apps of a run. Carries out what faults and chance want of their connections."""

    driver: VirtualDriver
    rng: Random
    is_bad: bool
    on_packet: OnPacket
    on_core: OnCore
    on_damage: OnDamage
    serial_of_link: dict[int, str] = field(default_factory=dict)
    is_out: bool = False
    """While the station is down nothing reconnects."""
    _joined: dict[str, _Joined] = field(default_factory=dict)
    _later: list[tuple[int, Callable[[], None]]] = field(default_factory=list)

    def join(self, apps: Iterable[SimulatedApp]) -> None:
        """Connect every app for the first time."""
        for app in apps:
            self._joined[app.settings.serial] = _Joined(app)
            self._connect(app.settings.serial)

    def step(self) -> None:
        """Carry out what is due; call after every stretch of virtual time."""
        now_ns = self.driver.now_ns
        due = [action for at_ns, action in self._later if at_ns <= now_ns]
        self._later = [item for item in self._later if item[0] > now_ns]
        for action in due:
            action()
        for serial, joined in self._joined.items():
            for order in joined.app.take_link_orders():
                self._carry_out(serial, order)
            if joined.link_id is not None and not self.driver.is_connected(joined.link_id):
                self._lost(serial, RECONNECTS_AFTER_S)  # the station closed it

    def has_downlink(self, serial: str) -> bool:
        """Whether what is sent to a vehicle now arrives soon."""
        connection = self._joined[serial].connection
        if connection is None or connection.is_abandoned or connection.link.is_dead:
            return False
        if self.driver.now_ns < connection.slow_until_ns:
            return False
        return connection.link.delay_s + connection.link.jitter_s <= SLOWEST_ALIVE_S

    def link_of(self, serial: str) -> int | None:
        """Return a vehicle's present link; None while it is not connected."""
        return self._joined[serial].link_id

    def delay_s(self, serial: str) -> float:
        """Return the longest delay of what arrives now over a vehicle's links, the latest ones."""
        now_ns = self.driver.now_ns
        return max((each.delay_s(now_ns) for each in self._joined[serial].newest), default=0.0)

    def disturb(self, serial: str) -> str:
        """Let something happen to a vehicle's link; return what, in words."""
        connection = self._joined[serial].connection
        if connection is None:
            return "link still gone"
        kind = self.rng.choice(("drops", "drops", "half-open", "slow", "stalls"))
        seconds = self.rng.choice((0.3, 1.0, 3.0, 8.0, 15.0)) * self.rng.uniform(0.5, 1.5)
        if kind == "drops":
            self._lost(serial, seconds)
        elif kind == "half-open":
            connection.link.is_dead = True
            self._after(seconds, lambda: self._renew(serial, connection))
        else:
            delay_s = self.rng.uniform(0.3, 0.9) if kind == "slow" else self.rng.uniform(1.0, 4.0)
            was_s = connection.link.delay_s
            connection.link.delay_s = delay_s
            connection.slow(seconds, delay_s, self.driver.now_ns)
            self._after(seconds, lambda: self._recover(connection, was_s))
        return f"link {kind} for {seconds:.1f} s"

    def drop_all(self) -> None:
        """End every connection: the station has died."""
        self.is_out = True
        for serial in self._joined:
            self._lost(serial, None)
        for link_id in self.serial_of_link:
            self.driver.disconnect(link_id)  # second and abandoned ones

    def return_all(self) -> None:
        """Let every app connect again."""
        self.is_out = False
        for serial in self._joined:
            self._connect(serial)

    def _connect(self, serial: str, number: int = MAIN_LINK) -> None:
        joined = self._joined[serial]
        if self.is_out or (number == MAIN_LINK and joined.link_id is not None):
            return
        link = self._link(serial)
        splits = Random(self.rng.random()) if self.is_bad else None
        joined.app.connected(self.driver.now_ns, number)
        connection = TappedConnection(
            joined.app, link, number, splits, self.on_packet, self.on_core
        )
        link_id = self.driver.connect(connection, link)
        self.serial_of_link[link_id] = serial
        joined.newest = [*joined.newest[-3:], connection]
        if number == MAIN_LINK:
            joined.connection, joined.link_id = connection, link_id
        else:
            self._after(self.rng.uniform(3.0, 30.0), lambda: self._end_second(serial, link_id))

    def _link(self, serial: str) -> FakeLink:
        seed = self.rng.getrandbits(32)
        if not self.is_bad:
            return FakeLink(self.rng.uniform(0.01, 0.05), 0.02, seed=seed)
        delay_s, jitter_s = self.rng.uniform(0.02, 0.15), self.rng.uniform(0.0, 0.15)
        damage = partial(self._damage, serial) if self.rng.random() < 0.3 else None
        return FakeLink(delay_s, jitter_s, damage, seed=seed)

    def _damage(self, serial: str, chunk: bytes, rng: Random) -> bytes:
        """One chunk in a hundred is damaged, one in two hundred is lost."""
        luck = rng.random()
        if luck < 0.01 and chunk:
            self.on_damage(serial)
            place = rng.randrange(len(chunk))
            return chunk[:place] + bytes([chunk[place] ^ 0x10]) + chunk[place + 1 :]
        return b"" if luck < 0.015 else chunk

    def _carry_out(self, serial: str, order: LinkOrder) -> None:
        joined = self._joined[serial]
        match order.kind:
            case LinkOrderKind.RECONNECT:
                self._lost(serial, order.seconds)
            case LinkOrderKind.ABANDON:
                old, old_id = joined.connection, joined.link_id
                if old is not None and old_id is not None:
                    old.is_abandoned = True
                    self._after(order.seconds, lambda: self.driver.disconnect(old_id))
                joined.connection = joined.link_id = None
                self._connect(serial)
            case LinkOrderKind.SECOND:
                self._connect(serial, SECOND_LINK)

    def _lost(self, serial: str, gone_s: float | None) -> None:
        joined = self._joined[serial]
        if joined.link_id is not None:
            self.driver.disconnect(joined.link_id)
            joined.app.disconnected()
            joined.connection = joined.link_id = None
        if gone_s is not None:
            self._after(gone_s, lambda: self._connect(serial))

    def _renew(self, serial: str, old: TappedConnection) -> None:
        """A link that died silently: the app opens a new one, the old socket closes later."""
        joined = self._joined[serial]
        if joined.connection is not old or joined.link_id is None:
            return
        old.is_abandoned, old_id = True, joined.link_id
        self._after(self.rng.uniform(0.5, 10.0), lambda: self.driver.disconnect(old_id))
        joined.connection = joined.link_id = None
        self._connect(serial)

    def _recover(self, connection: TappedConnection, delay_s: float) -> None:
        connection.link.delay_s = delay_s

    def _end_second(self, serial: str, link_id: int) -> None:
        self._joined[serial].app.disconnected(SECOND_LINK)
        self.driver.disconnect(link_id)

    def _after(self, seconds: float, action: Callable[[], None]) -> None:
        self._later.append((self.driver.now_ns + seconds_to_ns(seconds), action))
