"""A world in virtual time in which vehicles are steered: every packet to an app is written down."""

from collections.abc import Callable
from dataclasses import dataclass, field, replace
from math import hypot
from typing import cast

from tests.station.station_world import World, world

from recon import wire
from recon.geo.distance import moved_m
from recon.model.command import Body, GoTo, Phase
from recon.model.event import OperatorOrder, OwnerConnected, OwnerDisconnected
from recon.model.geo import LatLon
from recon.sim.app.app import MAIN_LINK, SimulatedApp
from recon.sim.fake_link import FakeLink
from recon.sim.flight.aircraft import Aircraft
from recon.station.state.setpoint_stream import SetpointStream
from recon.station.steering.stream_ends import RULE

SERIAL = "SIM-1"
OWNER = "a-stream-of-a-program"
HEIGHT_M = 40.0
"""Of SIM-1 at the start."""


@dataclass
class Tap:
    """Stands between a link and its app, and writes down what the station sends."""

    app: SimulatedApp
    received: list[tuple[float, wire.Packet]] = field(default_factory=list)
    """Seconds of station time, packet."""

    def receive(self, data: bytes, now_ns: int, link: int = MAIN_LINK) -> None:
        for packet in wire.Deframer().feed(data):
            self.received.append((now_ns / 1e9, packet))
        self.app.receive(data, now_ns, link)

    def advance(self, now_ns: int, link: int = MAIN_LINK) -> list[bytes]:
        return self.app.advance(now_ns, link)

    @property
    def next_due_ns(self) -> int:
        return self.app.next_due_ns


@dataclass
class Steered:
    """The world, its one vehicle, and what came over its link."""

    w: World
    tap: Tap

    @property
    def now_s(self) -> float:
        return self.w.driver.now_ns / 1e9

    def there(self, north_m: float, east_m: float = 0.0) -> LatLon:
        """A place so far north and east of the vehicle's home, over which it starts."""
        home = self.tap.app.settings.home
        return moved_m(LatLon(home.latitude_deg, home.longitude_deg), north_m, east_m)

    @property
    def aircraft(self) -> Aircraft:
        return self.tap.app.aircraft

    @property
    def stream(self) -> SetpointStream | None:
        return self.w.driver.station.control(SERIAL).stream

    def order(self, body: Body, owner: str | None = None, person: str = "") -> int:
        number = self.w._next_order
        self.w._next_order += 1
        order = OperatorOrder(number, body, "test", SERIAL, owner=owner, person=person)
        self.w.driver.handle(order)
        return number

    def goto(
        self,
        north_m: float,
        east_m: float = 0.0,
        *,
        height_m: float = HEIGHT_M,
        speed_mps: float = 8.0,
    ) -> int:
        """Order a goto held by an open stream."""
        self.w.driver.handle(OwnerConnected(OWNER))
        body = GoTo(self.there(north_m, east_m), height_m, speed_mps)
        return self.order(body, OWNER)

    def holder_goes(self) -> None:
        self.w.driver.handle(OwnerDisconnected(OWNER))

    def run_for(self, seconds: float) -> None:
        self.w.run_for(seconds)

    def run_until(self, is_reached: Callable[[], bool], at_most_s: float = 60.0) -> None:
        assert self.w.run_until(is_reached, at_most_s)

    def gust(self, *, north_mps: float = 0.0, east_mps: float = 0.0) -> None:
        """From now on wind carries it along, whatever the sticks say."""
        self.tap.app.aircraft.settings = replace(
            self.tap.app.aircraft.settings,
            stick_drift_north_mps=north_mps,
            stick_drift_east_mps=east_mps,
        )

    def reconnects(self, seconds: float) -> None:
        """The app's connection ends and comes back, with a tap on it again."""
        self.w.driver.disconnect(self.w.connected[SERIAL].link_id)
        self.run_for(seconds)
        self.w.connect(self.tap.app)
        self.w.connected[SERIAL].connection.app = cast(SimulatedApp, self.tap)

    def phase(self, order: int) -> Phase:
        return self.w.record(order).phase

    def note(self, order: int) -> str:
        return self.w.record(order).note

    def refusal_rule(self, order: int) -> str | None:
        """The rule that refused an order or one of its setpoints."""
        refusal = self.w.record(order).refusal
        return None if refusal is None else refusal.rule

    def distance_m(self, north_m: float, east_m: float = 0.0) -> float:
        """True distance of the vehicle from a place north and east of its start."""
        motion = self.aircraft.motion
        return hypot(motion.north_m - north_m, motion.east_m - east_m)

    def sticks(self, since_s: float = 0.0) -> list[tuple[float, wire.VirtualStickCommand]]:
        return [
            (at_s, packet)
            for at_s, packet in self.tap.received
            if at_s > since_s and isinstance(packet, wire.VirtualStickCommand)
        ]

    def moving_sticks(self, since_s: float) -> list[float]:
        """When sticks with any velocity reached the app."""
        return [at_s for at_s, packet in self.sticks(since_s) if _speed_mps(packet) > 0.0]

    def zeros(self, since_s: float) -> list[float]:
        return [at_s for at_s, packet in self.sticks(since_s) if _speed_mps(packet) == 0.0]

    def hovers(self, since_s: float = 0.0) -> list[float]:
        return [
            at_s
            for at_s, packet in self.tap.received
            if at_s > since_s and isinstance(packet, wire.EmergencyCommand) and packet.action == 0
        ]

    def alarm_texts(self) -> list[str]:
        book = self.w.driver.station.alarms.alarms.values()
        return [a.condition.text for a in book if a.condition.rule == RULE]


def steered(
    *,
    faults: tuple[str, ...] = (),
    make_link: Callable[[], FakeLink] = FakeLink,
    wind: tuple[float, float] = (0.0, 0.0),
    seed: int = 0,
) -> Steered:
    """Return one vehicle that hovers at 40 m over its start, three seconds after connecting."""
    w = world(faults=faults, make_link=make_link, seed=seed, keeps_log=False)
    tap = Tap(w.app(SERIAL))
    w.connected[SERIAL].connection.app = cast(SimulatedApp, tap)
    s = Steered(w, tap)
    s.gust(north_mps=wind[0], east_mps=wind[1])
    w.run_for(3.0)
    return s


def _speed_mps(packet: wire.VirtualStickCommand) -> float:
    return hypot(packet.velocity_x_mps, packet.velocity_y_mps)
