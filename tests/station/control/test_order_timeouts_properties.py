"""Whatever happens: every order has one end, and nothing that starts motion is sent
automatically."""

from dataclasses import replace

from hypothesis import given, settings
from hypothesis import strategies as st
from tests.examples import examples
from tests.fleet.reports import S
from tests.safety.cases import STICK, mission
from tests.station.commanded import AIRSPACE, CLOCK, PROFILES
from tests.station.flown import NORTHWARD, STANDING, at, row, to_land

from recon.fleet.state import Fleet
from recon.model.command import (
    Body,
    FlyMission,
    Hover,
    LandNow,
    Phase,
    ReturnHome,
    StartCamera,
    VirtualStick,
)
from recon.model.control import AuthorityHolder
from recon.model.event import (
    AuthorityTaken,
    CommandAnswered,
    CommandDropped,
    CommandSent,
    Event,
    LinkClosed,
    LinkOpened,
    OperatorOrder,
    PacketReceived,
    Tick,
)
from recon.model.vehicle import FlightMode
from recon.station.kernel.step import step
from recon.station.state.orders import OrderRecord
from recon.station.state.station import Station
from recon.station.state.steps import Output, SendCommand

MODES = [
    FlightMode.GPS_ATTI,
    FlightMode.GPS_WAYPOINT,
    FlightMode.GPS_WAYPOINT,
    FlightMode.GO_HOME,
    FlightMode.AUTO_LANDING,
    FlightMode.JOYSTICK,
    FlightMode.GPS_SPORT,
    FlightMode.OTHER,
]
REPORTS = st.builds(
    at,
    st.sampled_from([0.0, 10.0, 20.0, 30.0, 40.0, 60.0]),
    st.sampled_from(MODES),
    flying=st.sampled_from([True, True, True, False]),
    velocity=st.sampled_from([STANDING, NORTHWARD]),
)
BODIES = st.sampled_from(
    [
        row(7),
        row(7),
        mission(),
        to_land(mission()),
        Hover(),
        LandNow(),
        ReturnHome(),
        STICK,
        StartCamera(1.0),
    ]
)
DOES = st.one_of(
    st.tuples(st.just("receives"), REPORTS),
    st.tuples(st.just("receives"), REPORTS),
    st.tuples(st.just("receives"), REPORTS),
    st.tuples(st.just("order"), BODIES),
    st.tuples(st.just("order"), BODIES),
    st.tuples(st.just("sends"), st.booleans()),
    st.tuples(st.just("sends"), st.booleans()),
    st.tuples(st.just("answers"), st.sampled_from([True, True, False, None])),
    st.tuples(st.just("reconnects"), st.none()),
    st.tuples(st.just("taken"), st.sampled_from(list(AuthorityHolder))),
    st.tuples(st.just("waits"), st.sampled_from([0.1, 0.5, 1.0, 4.0, 9.0, 35.0])),
)


class Life:
    """A station with one vehicle whose app takes three waypoints; checked at every step."""

    def __init__(self) -> None:
        profile = replace(PROFILES["A"], max_waypoints=3)
        fleet = Fleet(profiles={"A": profile})
        self.station = Station(fleet=fleet, airspace=AIRSPACE, clock=CLOCK)
        self.now_ns, self.link, self.orders = 0, 0, 0
        self.handed: list[int] = []
        """Orders handed to the link and not yet sent, answered or dropped."""
        self.unanswered: list[int] = []
        self.parts_sent: dict[int, int] = {}
        self.reconnects()

    def happens(self, event: Event) -> None:
        before = self.station
        self.station, outputs = step(before, event, self.now_ns)
        for output in outputs:
            self._judge(before, event, output)
        for record in self.station.orders.records.values():
            _has_one_end(record)
            assert (record in self.station.orders.tracked) == record.is_tracked

    def _judge(self, before: Station, event: Event, output: Output) -> None:
        assert not isinstance(event, LinkOpened | LinkClosed)
        if not isinstance(output, SendCommand):
            return
        command = output.approved.command
        if command.id > 0:
            self.handed.append(command.id)
        is_asked = isinstance(event, OperatorOrder) and event.command_id == command.id
        if isinstance(command.body, FlyMission):
            self._judge_part(before, command.id, command.body, is_asked)
        elif isinstance(command.body, VirtualStick):
            is_zero = command.body.velocity_x_mps == command.body.velocity_y_mps == 0.0
            assert is_asked or is_zero

    def _judge_part(self, before: Station, number: int, body: FlyMission, is_asked: bool) -> None:
        """Only an order sends a first part; a next one goes once, over a whole chain."""
        sent = self.parts_sent.get(number, 0)
        self.parts_sent[number] = sent + 1
        plan = self.station.orders.records[number].plan
        assert plan is not None
        assert body.mission == plan.parts[sent]
        if is_asked:
            assert sent == 0
            return
        was = before.orders.records[number]
        assert was.phase is Phase.STARTED
        assert was.plan is not None
        assert (was.plan.index, was.plan.broken) == (sent - 1, None)
        assert before.fleet.vehicles["A"].link_id == was.plan.link_id == self.link
        assert before.control("A").authority == was.plan.authority

    def receives(self, reports: object) -> None:
        for report in reports:  # type: ignore[attr-defined]
            self.happens(PacketReceived(self.link, report))

    def order(self, body: Body) -> None:
        self.orders += 1
        self.happens(OperatorOrder(self.orders, body, "test", serial="A"))

    def sends(self, does: bool) -> None:
        for number in self.handed:
            if does:
                self.happens(CommandSent(self.link, number))
                self.unanswered.append(number)
            else:
                self.happens(CommandDropped(self.link, number, Phase.FAILED, "dropped"))
        self.handed = []

    def answers(self, positive: bool | None) -> None:
        for number in self.unanswered:
            self.happens(CommandAnswered(self.link, number, positive))
        self.unanswered = []

    def reconnects(self, _: object = None) -> None:
        if self.link:
            self.sends(False)
            self.happens(LinkClosed(self.link, "gone"))
        self.link += 1
        self.happens(LinkOpened(self.link, "x"))
        self.receives(at(0.0, FlightMode.GPS_ATTI))

    def taken(self, holder: AuthorityHolder) -> None:
        self.happens(AuthorityTaken("A", holder, "test"))

    def waits(self, seconds: float) -> None:
        for _ in range(max(1, round(seconds / 0.5))):
            self.now_ns += round(min(seconds, 0.5) * S)
            self.happens(Tick())


def _has_one_end(record: OrderRecord) -> None:
    phases = [change.phase for change in record.history]
    ends = [phase for phase in phases if phase.is_final]
    assert len(set(ends)) <= 1
    if ends:
        assert all(phase is ends[0] for phase in phases[phases.index(ends[0]) :])


@settings(max_examples=examples(200), deadline=None)
@given(st.lists(DOES, max_size=40))
def test_every_order_has_one_end_and_no_motion_goes_by_itself(
    does: list[tuple[str, object]],
) -> None:
    life = Life()
    for name, what in does:
        life.now_ns += S // 10
        getattr(life, name)(what)
    for _ in range(80):  # no telemetry
        life.now_ns += 10 * S
        life.happens(Tick())
    assert all(record.phase.is_final for record in life.station.orders.records.values())


def test_a_whole_mission_in_parts_is_among_what_can_happen() -> None:
    """The property above would be empty if no second part were ever sent."""
    life = Life()
    life.order(row(5))
    for north_m in (0.0, 10.0, 20.0):
        life.sends(True)
        life.now_ns += S
        life.receives(at(north_m, FlightMode.GPS_WAYPOINT, velocity=NORTHWARD))
    life.now_ns += S
    life.receives(at(20.0, FlightMode.GPS_ATTI))
    assert life.parts_sent == {1: 2}
