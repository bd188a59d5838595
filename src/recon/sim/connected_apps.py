"""Simulated apps on a driver in virtual time, with the link faults that the apps ask for."""

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, field
from typing import Protocol, TypeAlias

from recon.model.units import seconds_to_ns
from recon.sim.app.app import MAIN_LINK, NEVER_NS, LinkOrder, LinkOrderKind, SimulatedApp
from recon.sim.fake_link import FakeLink

SECOND_LINK = 1


class Driver(Protocol):
    """What carries the bytes between apps and station, in virtual time."""

    now_ns: int

    def connect(self, peer: "AppConnection", link: FakeLink) -> int:
        """Open a connection for a peer; return its link id."""

    def disconnect(self, link_id: int) -> None:
        """End a connection, unless it has ended."""

    def run_for(self, seconds: float) -> None:
        """Let virtual time pass."""


@dataclass(slots=True)
class AppConnection:
    """One connection of an app; an abandoned one stays open, but neither reads nor writes."""

    app: SimulatedApp
    link: int = MAIN_LINK
    is_abandoned: bool = False

    def receive(self, data: bytes, now_ns: int) -> None:
        """Pass bytes from the station to the app."""
        if not self.is_abandoned:
            self.app.receive(data, now_ns, self.link)

    def advance(self, now_ns: int) -> list[bytes]:
        """Return the bytes that the app sends now."""
        return [] if self.is_abandoned else self.app.advance(now_ns, self.link)

    @property
    def next_due_ns(self) -> int:
        """Return when the app has something to do next."""
        return NEVER_NS if self.is_abandoned else self.app.next_due_ns


@dataclass(slots=True)
class ConnectedApp:
    """An app with its present main connection."""

    app: SimulatedApp
    connection: AppConnection
    link_id: int


@dataclass(slots=True)
class EndLink:
    """The end of a link, which may be an app's second one."""

    link_id: int
    second_of: SimulatedApp | None = None


Later: TypeAlias = SimulatedApp | EndLink
"""An app that connects again, or a link that ends."""


@dataclass(slots=True)
class ConnectedApps:
    """The apps of a run, by serial. Reconnects, abandoned and second links are carried out here."""

    driver: Driver
    make_link: Callable[[], FakeLink] = FakeLink
    connected: dict[str, ConnectedApp] = field(default_factory=dict)
    _later: list[tuple[int, Later]] = field(default_factory=list)

    @property
    def apps(self) -> Sequence[SimulatedApp]:
        """All apps, in the order in which they were first connected."""
        return [each.app for each in self.connected.values()]

    def connect_all(self, apps: Iterable[SimulatedApp]) -> None:
        """Connect every app."""
        for app in apps:
            self.connect(app)

    def connect(self, app: SimulatedApp, link: FakeLink | None = None) -> int:
        """Open an app's main connection and return its link id."""
        app.connected(self.driver.now_ns)
        connection = AppConnection(app)
        link_id = self.driver.connect(connection, link or self.make_link())
        self.connected[app.settings.serial] = ConnectedApp(app, connection, link_id)
        return link_id

    def advance(self, seconds: float) -> None:
        """Run virtual time, then carry out link faults: they are late by up to `seconds`."""
        self.driver.run_for(seconds)
        now_ns = self.driver.now_ns
        due = [what for at_ns, what in self._later if at_ns <= now_ns]
        self._later = [item for item in self._later if item[0] > now_ns]
        for what in due:
            self._do(what)
        for each in tuple(self.connected.values()):
            for order in each.app.take_link_orders():
                self._carry_out(each, order)

    def _do(self, what: Later) -> None:
        if not isinstance(what, EndLink):
            self.connect(what)
            return
        if what.second_of is not None:
            what.second_of.disconnected(SECOND_LINK)
        self.driver.disconnect(what.link_id)

    def _carry_out(self, old: ConnectedApp, order: LinkOrder) -> None:
        app = old.app
        match order.kind:
            case LinkOrderKind.RECONNECT:
                self.driver.disconnect(old.link_id)
                self._after(order.seconds, app)
            case LinkOrderKind.ABANDON:
                old.connection.is_abandoned = True
                self._after(order.seconds, EndLink(old.link_id))
                self.connect(app)
            case LinkOrderKind.SECOND:
                app.connected(self.driver.now_ns, SECOND_LINK)
                second_id = self.driver.connect(AppConnection(app, SECOND_LINK), self.make_link())
                self._after(order.seconds, EndLink(second_id, app))

    def _after(self, seconds: float, what: Later) -> None:
        self._later.append((self.driver.now_ns + seconds_to_ns(seconds), what))
