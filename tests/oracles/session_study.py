"""The session under loss of links, delay, damage, dropouts and reconnects.

An operator commands counting apps over bad links. It must hold that no command is carried out
twice; that the station sent whatever an app carried out; that what the station counts as confirmed
was carried out; that every order ends or is in an alarm; and that no stick moves a vehicle after
its order has ended.
"""

import random
from collections import Counter
from collections.abc import Callable
from dataclasses import dataclass, field, replace

from tests.oracles.counting_app import CountingApp

from recon.model.command import (
    Body,
    FlyMission,
    GoTo,
    Hover,
    LandNow,
    Phase,
    ReturnHome,
    StartCamera,
    StickFrame,
    StopCamera,
    VirtualStick,
)
from recon.model.control import AuthorityHolder
from recon.model.event import (
    AuthorityTaken,
    CommandSent,
    OperatorOrder,
    PreflightOverridden,
)
from recon.model.geo import GeoPoint, LatLon
from recon.model.mission import Mission, Waypoint
from recon.model.units import seconds_to_ns
from recon.model.vehicle import AltitudeReference, Failsafe, VehicleProfile
from recon.sim.app.app import NEVER_NS
from recon.sim.fake_link import FakeLink
from recon.site import Site
from recon.station.kernel.build import first_state
from recon.station.kernel.virtual import VirtualDriver
from recon.station.state.orders import OrderRecord
from recon.station.state.steps import StepTaken

HOME = GeoPoint(41.9, -93.6, 275.0)
APART_DEG = 0.004
"""Vehicles are 330 m apart: the subject is the session, not separation."""
DONE_OR_UNDER_WAY = (Phase.CONFIRMED, Phase.STARTED, Phase.DONE)
OPEN_FOR_S = 240.0
"""An order still open after this time must be in an alarm."""
STICK_GRACE_S = 3.0
"""A stick's own duration and the longest delay: after that no stick of an ended order may move."""
MOST_SENDINGS = 4
"""Of an emergency order on one link: once, and three repeats."""


@dataclass(slots=True)
class Tally:
    """What happened, and which rules were broken."""

    seconds: float = 0.0
    orders: Counter[str] = field(default_factory=Counter)
    ends: Counter[str] = field(default_factory=Counter)
    faults: Counter[str] = field(default_factory=Counter)
    executed: int = 0
    emergencies: int = 0
    moving_sticks: int = 0
    broken: list[str] = field(default_factory=list)


@dataclass(slots=True)
class _Connection:
    """One of an app's connections; an abandoned one neither reads nor writes."""

    app: CountingApp
    is_current: bool = True

    def receive(self, data: bytes, now_ns: int) -> None:
        """Pass bytes from the station to the app."""
        if self.is_current:
            self.app.receive(data, now_ns)

    def advance(self, now_ns: int) -> list[bytes]:
        """Return the bytes that the app sends now."""
        return self.app.advance(now_ns) if self.is_current else []

    @property
    def next_due_ns(self) -> int:
        """When the app has something to do next."""
        return self.app.next_due_ns if self.is_current else NEVER_NS


@dataclass(slots=True)
class _Vehicle:
    app: CountingApp
    connection: _Connection
    link: FakeLink
    link_id: int
    next_order_ns: int = 0
    next_fault_ns: int = 0
    reconnect_ns: int | None = None


@dataclass(slots=True)
class _Order:
    vehicle: _Vehicle
    body: Body
    mark: tuple[str, float] | None
    placed_ns: int
    ended_ns: int | None = None
    record: OrderRecord | None = None


class SessionStudy:
    """A station, counting apps, bad links, and an operator that commands all the time."""

    def __init__(self, seed: int, vehicles: int = 3) -> None:
        self.rng = random.Random(seed)
        self.tally = Tally()
        serials = [f"STUDY-{number}" for number in range(1, vehicles + 1)]
        homes = [
            GeoPoint(HOME.latitude_deg, HOME.longitude_deg + APART_DEG * n, 275.0)
            for n in range(vehicles)
        ]
        profiles = {s: _profile(s, home) for s, home in zip(serials, homes, strict=True)}
        station = first_state(Site(name="study", profiles=profiles))
        self.driver = VirtualDriver(station, keeps_log=False)
        self.driver.observe = self._count
        self._sendings: Counter[tuple[int, int]] = Counter()
        """How often each command left on each link."""
        self.vehicles = [
            self._join(CountingApp(s, home, random.Random(self.rng.random())))
            for s, home in zip(serials, homes, strict=True)
        ]
        self._orders: dict[int, _Order] = {}
        self._open: dict[int, _Order] = {}

    def run(
        self,
        seconds: float,
        report: Callable[[Tally], None] | None = None,
        report_every_s: float = 1_000.0,
    ) -> Tally:
        """Run virtual time and check; `report` is called with the tally so far."""
        end_ns = self.driver.now_ns + seconds_to_ns(seconds)
        report_ns = self.driver.now_ns + seconds_to_ns(report_every_s)
        while self.driver.now_ns < end_ns:
            self.driver.run_for(0.5)
            self._follow()
            for vehicle in self.vehicles:
                self._act(vehicle)
            if report is not None and self.driver.now_ns >= report_ns:
                report_ns += seconds_to_ns(report_every_s)
                report(self._so_far())
        self.driver.run_for(20.0)
        self._follow()
        self._judge()
        self.tally.seconds = self.driver.now_ns / 1e9
        return self.tally

    def _so_far(self) -> Tally:
        """Return the tally with what apps have carried out; repeated marks count as broken."""
        apps = [vehicle.app for vehicle in self.vehicles]
        twice = [
            f"{app.serial}: {kind} {mark} was carried out {times} times"
            for app in apps
            for (kind, mark), times in app.executed.items()
            if times > 1
        ]
        return replace(
            self.tally,
            seconds=self.driver.now_ns / 1e9,
            executed=sum(sum(app.executed.values()) for app in apps),
            emergencies=sum(sum(app.emergencies.values()) for app in apps),
            moving_sticks=sum(len(app.stick_times_ns) for app in apps),
            broken=[*self.tally.broken, *twice],
        )

    def _join(self, app: CountingApp) -> _Vehicle:
        link = FakeLink(jitter_s=0.1, damage=_damage, seed=self.rng.getrandbits(32))
        app.connected()
        connection = _Connection(app)
        vehicle = _Vehicle(app, connection, link, self.driver.connect(connection, link))
        vehicle.next_order_ns = self.driver.now_ns + seconds_to_ns(5.0)
        vehicle.next_fault_ns = self.driver.now_ns + seconds_to_ns(20.0)
        return vehicle

    def _act(self, vehicle: _Vehicle) -> None:
        now_ns = self.driver.now_ns
        if vehicle.reconnect_ns is not None and now_ns >= vehicle.reconnect_ns:
            self._reconnect(vehicle)
        if now_ns >= vehicle.next_fault_ns:
            vehicle.next_fault_ns = now_ns + seconds_to_ns(self.rng.uniform(5.0, 60.0))
            self._disturb(vehicle)
        if now_ns >= vehicle.next_order_ns:
            vehicle.next_order_ns = now_ns + seconds_to_ns(self.rng.choice((0.5, 2.0, 10.0, 25.0)))
            self._order(vehicle)

    def _disturb(self, vehicle: _Vehicle) -> None:
        kind = self.rng.choice(("dropout", "slow", "fin", "half-open", "returns early"))
        self.tally.faults[kind] += 1
        now_ns, vehicle.link.delay_s = self.driver.now_ns, 0.02
        match kind:
            case "dropout":
                vehicle.app.silent_until_ns = now_ns + seconds_to_ns(self.rng.uniform(0.5, 6.0))
            case "slow":
                vehicle.link.delay_s = self.rng.uniform(0.3, 1.5)
            case "fin":
                self.driver.disconnect(vehicle.link_id)
                vehicle.reconnect_ns = now_ns + seconds_to_ns(self.rng.uniform(0.1, 8.0))
            case "half-open":
                vehicle.link.is_dead = True
                vehicle.reconnect_ns = now_ns + seconds_to_ns(self.rng.uniform(0.1, 8.0))
            case "returns early":  # a second connection while the first still looks alive
                vehicle.link.is_dead = True
                self._reconnect(vehicle)

    def _reconnect(self, vehicle: _Vehicle) -> None:
        vehicle.connection.is_current = False
        joined = self._join(vehicle.app)
        vehicle.connection, vehicle.link = joined.connection, joined.link
        vehicle.link_id, vehicle.reconnect_ns = joined.link_id, None

    def _order(self, vehicle: _Vehicle) -> None:
        number = len(self._orders) + 1
        body, mark = self._body(vehicle, number)
        serial, driver = vehicle.app.serial, self.driver
        driver.handle(AuthorityTaken(serial, AuthorityHolder.OPERATOR, "study"))
        driver.handle(PreflightOverridden(serial, "study", "the session is studied"))
        driver.handle(OperatorOrder(number, body, "study", serial=serial))
        order = _Order(vehicle, body, mark, driver.now_ns)
        self._orders[number] = self._open[number] = order
        self.tally.orders[type(body).__name__] += 1

    def _body(self, vehicle: _Vehicle, number: int) -> tuple[Body, tuple[str, float] | None]:
        kind = self.rng.choices(
            ("mission", "goto", "stick", "camera", "camera stop", "hover", "land", "return"),
            (40, 12, 10, 8, 4, 16, 3, 3),
        )[0]
        match kind:
            case "mission":
                mark = round(number * 1e-5, 6)
                return _mission(vehicle.app, self.rng, mark), ("mission", mark)
            case "goto":
                place = _near(vehicle.app, self.rng)
                return GoTo(place, 40.0, self.rng.uniform(1.0, 6.0)), None
            case "stick":
                return VirtualStick(StickFrame.GROUND, 0.0, 1.0, 0.0, 40.0, 1.0), None
            case "camera":
                mark = round(1.0 + number * 1e-4, 4)
                return StartCamera(mark), ("camera", mark)
            case "camera stop":
                return StopCamera(), None
        return {"hover": Hover(), "land": LandNow(), "return": ReturnHome()}[kind], None

    def _follow(self) -> None:
        """Record the ends of orders; an order open for long must be in an alarm."""
        records = self.driver.station.orders.records
        for number, order in tuple(self._open.items()):
            record = records.get(number)
            if record is None:
                self.tally.broken.append(f"order {number} was forgotten before its end")
                del self._open[number]
                continue
            order.record = record
            if not record.is_tracked:
                order.ended_ns = self.driver.now_ns
                del self._open[number]
            elif self.driver.now_ns - order.placed_ns > seconds_to_ns(OPEN_FOR_S):
                self._is_alarmed(number, record)

    def _is_alarmed(self, number: int, record: OrderRecord) -> None:
        is_steered = isinstance(record.command.body, GoTo)
        texts = [a.condition.key for a in self.driver.station.alarms.alarms.values()]
        if not is_steered and not any(str(number) in text for text in texts):
            text = f"order {number} ({record.command.name}): {record.phase.value} without an alarm"
            if text not in self.tally.broken:
                self.tally.broken.append(text)

    def _judge(self) -> None:
        for number, order in self._orders.items():
            assert order.record is not None
            self.tally.ends[f"{order.record.command.name}: {order.record.phase.value}"] += 1
            self._judge_marked(number, order, order.record)
            if order.record.command.is_emergency:
                self._judge_repeats(number)
        for vehicle in self.vehicles:
            self._judge_emergencies(vehicle)
            self._judge_sticks(vehicle)

    def _judge_repeats(self, number: int) -> None:
        """A stop is sent on each link that claims the vehicle, at most MOST_SENDINGS times."""
        for (sent, link_id), times in self._sendings.items():
            if sent == number and times > MOST_SENDINGS:
                self.tally.broken.append(f"order {number} was sent {times} times on link {link_id}")

    def _count(self, step: StepTaken) -> None:
        event = step.event
        if isinstance(event, CommandSent):
            self._sendings[event.command_id, event.link_id] += 1

    def _judge_marked(self, number: int, order: _Order, record: OrderRecord) -> None:
        if order.mark is None:
            return
        times = order.vehicle.app.executed[order.mark]
        self.tally.executed += times
        if times > 1:
            self.tally.broken.append(f"order {number} was carried out {times} times")
        if times and not record.times_sent:
            self.tally.broken.append(f"order {number} was carried out and never sent")
        if not times and isinstance(order.body, FlyMission) and record.phase in DONE_OR_UNDER_WAY:
            text = f"mission {number} is {record.phase.value} and was never carried out"
            self.tally.broken.append(text)

    def _judge_emergencies(self, vehicle: _Vehicle) -> None:
        sent = sum(
            order.record.times_sent
            for order in self._orders.values()
            if order.vehicle is vehicle and order.record and order.record.command.is_emergency
        )
        carried_out = sum(vehicle.app.emergencies.values())
        self.tally.emergencies += carried_out
        if carried_out > sent + self._station_made(vehicle):
            text = f"{vehicle.app.serial}: {carried_out} stops carried out, {sent} sent"
            self.tally.broken.append(text)

    def _station_made(self, vehicle: _Vehicle) -> int:
        """Stops that the station sends automatically; only the latest of them are on record."""
        return sum(
            MOST_SENDINGS
            for order in self._orders.values()
            if order.vehicle is vehicle and isinstance(order.body, GoTo)
        )

    def _judge_sticks(self, vehicle: _Vehicle) -> None:
        grace_ns = seconds_to_ns(STICK_GRACE_S)
        spans = [
            (order.placed_ns, self._steers_until_ns(vehicle, order) + grace_ns)
            for order in self._orders.values()
            if order.vehicle is vehicle and isinstance(order.body, (GoTo, VirtualStick))
        ]
        self.tally.moving_sticks += len(vehicle.app.stick_times_ns)
        for at_ns in vehicle.app.stick_times_ns:
            if not any(start <= at_ns <= end for start, end in spans):
                text = f"{vehicle.app.serial}: unordered stick moved it at {at_ns / 1e9:.1f} s"
                self.tally.broken.append(text)

    def _steers_until_ns(self, vehicle: _Vehicle, order: _Order) -> int:
        """A finished goto holds position by sticks until the next motion order is accepted."""
        assert order.record is not None
        if order.record.phase is not Phase.DONE:
            return order.ended_ns or self.driver.now_ns
        later = (
            other.placed_ns
            for other in self._orders.values()
            if other.vehicle is vehicle
            and other.placed_ns > order.placed_ns
            and not isinstance(other.body, (StartCamera, StopCamera))
            and other.record is not None
            and other.record.phase is not Phase.REFUSED_BY_STATION
        )
        return min(later, default=self.driver.now_ns)


def _profile(serial: str, home: GeoPoint) -> VehicleProfile:
    return VehicleProfile(
        serial,
        waypoint_altitude=AltitudeReference.TAKEOFF,
        pad=home,
        endurance_s=1800.0,
        go_home_height_m=40.0,
        failsafe=Failsafe.GO_HOME,
        camera_interval_s=2.0,
    )


def _near(app: CountingApp, rng: random.Random) -> LatLon:
    spread_deg = APART_DEG / 4.0
    return LatLon(
        app.home.latitude_deg + rng.uniform(-spread_deg, spread_deg),
        app.home.longitude_deg + rng.uniform(-spread_deg, spread_deg),
    )


def _mission(app: CountingApp, rng: random.Random, mark: float) -> FlyMission:
    """Two waypoints; the loiter time at the second is the mark that the app counts."""
    speed_mps = rng.uniform(5.0, 12.0)
    start, end = _near(app, rng), _near(app, rng)
    waypoints = (
        Waypoint(start.latitude_deg, start.longitude_deg, 40.0, speed_mps),
        Waypoint(end.latitude_deg, end.longitude_deg, 40.0, speed_mps, loiter_s=mark),
    )
    return FlyMission(Mission(waypoints))


def _damage(chunk: bytes, rng: random.Random) -> bytes:
    """One chunk in a hundred is damaged, one in two hundred is lost."""
    luck = rng.random()
    if luck < 0.01:
        place = rng.randrange(len(chunk))
        return chunk[:place] + bytes([chunk[place] ^ 0x10]) + chunk[place + 1 :]
    return b"" if luck < 0.015 else chunk
