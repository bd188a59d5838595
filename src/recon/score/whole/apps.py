"""Simulated apps joined to the station's virtual driver; what faults ask of connections is done."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field

from recon.model.units import seconds_to_ns
from recon.sim.app.app import MAIN_LINK, LinkOrder, LinkOrderKind, SimulatedApp
from recon.station.kernel.virtual import FAR_NS, FakeLink, VirtualDriver

SECOND_LINK = 1


@dataclass(slots=True)
class AppConnection:
    """One of an app's connections; an abandoned one neither reads nor writes any more."""

    app: SimulatedApp
    link: int = MAIN_LINK
    is_abandoned: bool = False

    def receive(self, data: bytes, now_ns: int) -> None:
        """Pass on what the station says."""
        if not self.is_abandoned:
            self.app.receive(data, now_ns, self.link)

    def advance(self, now_ns: int) -> list[bytes]:
        """Return what the app says."""
        return [] if self.is_abandoned else self.app.advance(now_ns, self.link)

    @property
    def next_due_ns(self) -> int:
        """When the app has something to do next."""
        return FAR_NS if self.is_abandoned else self.app.next_due_ns


@dataclass(slots=True)
class ConnectedApps:
    """A fleet's apps, each with its present main connection."""

    driver: VirtualDriver
    apps: Sequence[SimulatedApp]
    make_link: Callable[[], FakeLink] = FakeLink
    connections: dict[str, tuple[AppConnection, int]] = field(default_factory=dict)
    _later: list[tuple[int, Callable[[], object]]] = field(default_factory=list)

    def __post_init__(self) -> None:
        for app in self.apps:
            self._connect(app)

    def run_for(self, seconds: float) -> None:
        """Let virtual time pass, then do what faults ask: as exact as the steps are short."""
        self.driver.run_for(seconds)
        now_ns = self.driver.now_ns
        due = [action for at_ns, action in self._later if at_ns <= now_ns]
        self._later = [item for item in self._later if item[0] > now_ns]
        for action in due:
            action()
        for app in self.apps:
            for order in app.take_link_orders():
                self._carry_out(app, order)

    def _connect(self, app: SimulatedApp) -> None:
        app.connected(self.driver.now_ns)
        connection = AppConnection(app)
        link_id = self.driver.connect(connection, self.make_link())
        self.connections[app.settings.serial] = connection, link_id

    def _carry_out(self, app: SimulatedApp, order: LinkOrder) -> None:
        connection, link_id = self.connections[app.settings.serial]
        match order.kind:
            case LinkOrderKind.RECONNECT:
                self.driver.disconnect(link_id)
                self._after(order.seconds, lambda: self._connect(app))
            case LinkOrderKind.ABANDON:
                connection.is_abandoned = True
                self._after(order.seconds, lambda: self.driver.disconnect(link_id))
                self._connect(app)
            case LinkOrderKind.SECOND:
                app.connected(self.driver.now_ns, SECOND_LINK)
                second = AppConnection(app, SECOND_LINK)
                second_id = self.driver.connect(second, self.make_link())
                self._after(order.seconds, lambda: self._end_second(app, second_id))

    def _end_second(self, app: SimulatedApp, link_id: int) -> None:
        app.disconnected(SECOND_LINK)
        self.driver.disconnect(link_id)

    def _after(self, seconds: float, action: Callable[[], object]) -> None:
        self._later.append((self.driver.now_ns + seconds_to_ns(seconds), action))
