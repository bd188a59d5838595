"""Whatever happens in whatever order: every command ends in exactly one way, packets keep apart."""

from collections import Counter
from dataclasses import dataclass, field

from hypothesis import given
from hypothesis import strategies as st
from tests.link.approved import LINK_ID, MS, ack, approved, core, mission, stick

from recon.link.session import Session
from recon.link.settings import LinkSettings
from recon.model.command import (
    Body,
    Hover,
    LandNow,
    ReturnHome,
    StartCamera,
    StopCamera,
)
from recon.model.event import CommandAnswered, CommandDropped, Event

BODIES: tuple[Body, ...] = (
    Hover(),
    LandNow(),
    ReturnHome(),
    StartCamera(2.0),
    StopCamera(),
    mission(),
    stick(),
)
EMERGENCIES = (Hover, LandNow, ReturnHome)

operations = st.lists(
    st.one_of(
        st.tuples(st.just("submit"), st.integers(0, len(BODIES) - 1)),
        st.tuples(st.just("wait"), st.sampled_from([1, 49, 50, 99, 100, 700, 2000, 5000, 11_000])),
        st.tuples(st.just("tick"), st.just(0)),
        st.tuples(st.just("pump"), st.just(0)),
        st.tuples(st.just("ack"), st.sampled_from([252, 253, 254, 255, 0])),
        st.tuples(st.just("refuse"), st.sampled_from([252, 253, 254, 255])),
        st.tuples(st.just("noise"), st.integers(0, 2**32 - 1)),
        st.tuples(st.just("core"), st.just(0)),
    ),
    max_size=60,
)


@dataclass
class World:
    """A session, its clock, and what came out of it."""

    session: Session = field(default_factory=lambda: Session(LINK_ID, LinkSettings(), 0))
    now_ns: int = 0
    bodies: dict[int, Body] = field(default_factory=dict)
    sent: list[tuple[int, int]] = field(default_factory=list)
    dropped: list[int] = field(default_factory=list)
    answered: list[tuple[int, bool | None]] = field(default_factory=list)
    queued_most: int = 0

    def do(self, operation: str, value: int) -> None:
        match operation:
            case "submit":
                command_id = len(self.bodies) + 1
                self.bodies[command_id] = BODIES[value]
                self.take(self.session.submit(approved(command_id, BODIES[value], self.now_ns)))
            case "wait":
                self.now_ns += value * MS
            case "tick":
                self.take(self.session.tick(self.now_ns))
            case "pump":
                self.pump()
            case "ack":
                self.take(self.session.receive(ack(value), self.now_ns))
            case "refuse":
                self.take(self.session.receive(ack(value, positive=0), self.now_ns))
            case "noise":
                data = value.to_bytes(4, "big") * (value % 64)
                self.take(self.session.receive(data, self.now_ns))
            case "core":
                self.take(self.session.receive(core(), self.now_ns))
        self.queued_most = max(self.queued_most, self.session.commands_queued)

    def pump(self) -> None:
        while (outgoing := self.session.next_packet(self.now_ns)) is not None:
            self.sent.append((self.now_ns, outgoing.event.command_id))

    def take(self, events: list[Event] | list[CommandDropped]) -> None:
        for event in events:
            if isinstance(event, CommandDropped):
                self.dropped.append(event.command_id)
            if isinstance(event, CommandAnswered):
                self.answered.append((event.command_id, event.positive))


def lived(steps: list[tuple[str, int]]) -> World:
    world = World()
    for operation, value in steps:
        world.do(operation, value)
    world.take(world.session.finish("over"))
    return world


@given(operations)
def test_every_command_is_sent_or_dropped_exactly_once(steps: list[tuple[str, int]]) -> None:
    world = lived(steps)
    ends = Counter([command_id for _, command_id in world.sent] + world.dropped)
    assert ends == Counter(list(world.bodies))


@given(operations)
def test_only_emergencies_follow_without_a_gap(steps: list[tuple[str, int]]) -> None:
    world = lived(steps)
    for (earlier_ns, _), (later_ns, later_id) in zip(world.sent, world.sent[1:], strict=False):
        if not isinstance(world.bodies[later_id], EMERGENCIES):
            assert later_ns - earlier_ns >= 100 * MS


@given(operations)
def test_each_is_answered_at_most_once_and_only_if_sent(steps: list[tuple[str, int]]) -> None:
    world = lived(steps)
    answered = [command_id for command_id, _ in world.answered]
    assert len(answered) == len(set(answered))
    assert set(answered) <= {command_id for _, command_id in world.sent}


@given(operations)
def test_the_queue_is_bounded(steps: list[tuple[str, int]]) -> None:
    assert lived(steps).queued_most <= 3


@given(operations)
def test_an_emergency_goes_at_the_next_pump(steps: list[tuple[str, int]]) -> None:
    world = World()
    for operation, value in steps:
        world.do(operation, value)
    command_id = len(world.bodies) + 1
    world.take(world.session.submit(approved(command_id, Hover(), world.now_ns)))
    outgoing = world.session.next_packet(world.now_ns)
    assert outgoing is not None
    assert outgoing.event.command_id == command_id
