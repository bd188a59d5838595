"""Any sequence of events: no exception, and no vehicle on the ground is set in motion."""

from hypothesis import given, settings
from hypothesis import strategies as st
from tests.examples import examples
from tests.fleet.reports import S, core, extended
from tests.safety.cases import STICK, mission
from tests.station.commanded import AIRSPACE, CLOCK, PROFILES

from recon.fleet.state import Fleet
from recon.model.command import Hover, LandNow, Phase, ReturnHome, StartCamera, StopCamera
from recon.model.event import (
    AlarmAcknowledged,
    CommandAnswered,
    CommandDropped,
    CommandSent,
    LinkClosed,
    LinkOpened,
    OperatorOrder,
    PacketReceived,
    Tick,
)
from recon.model.report import AckReport, AnsweredKind, ImageReport, MessageReport, MessageSeverity
from recon.model.vehicle import FlightMode
from recon.station.kernel.step import step
from recon.station.state.settings import StationSettings
from recon.station.state.station import Station
from recon.station.state.steps import SendCommand

LINKS = st.integers(1, 4)
IDS = st.integers(1, 12)
BODIES = st.sampled_from(
    [Hover(), LandNow(), ReturnHome(), mission(), STICK, StartCamera(1.0), StopCamera()]
)
REPORTS = st.one_of(
    st.builds(core, flying=st.sampled_from([True, False, None])),
    st.builds(
        extended,
        st.sampled_from([None, "A", "B"]),
        mode=st.sampled_from([None, *FlightMode]),
    ),
    st.just(ImageReport(target_fps_hz=1.0, jpeg=b"x")),
    st.builds(AckReport, st.sampled_from(list(AnsweredKind)), st.booleans()),
    st.builds(MessageReport, st.sampled_from(list(MessageSeverity)), st.text(max_size=3)),
)
EVENTS = st.one_of(
    st.builds(LinkOpened, LINKS, st.just("x")),
    st.builds(LinkClosed, LINKS, st.just("x")),
    st.builds(PacketReceived, LINKS, REPORTS),
    st.builds(PacketReceived, LINKS, REPORTS),
    st.builds(OperatorOrder, IDS, BODIES, st.just("t"), st.sampled_from(["A", "B", None]), LINKS),
    st.builds(CommandSent, LINKS, IDS),
    st.builds(CommandAnswered, LINKS, IDS, st.sampled_from([True, False, None])),
    st.builds(
        CommandDropped, LINKS, IDS, st.sampled_from([Phase.FAILED, Phase.EXPIRED]), st.just("x")
    ),
    st.builds(AlarmAcknowledged, IDS, st.just("t")),
    st.just(Tick()),
    st.just(Tick()),
)


@settings(max_examples=examples(300), deadline=None)
@given(st.lists(st.tuples(st.sampled_from([0, 50, 700, 4000]), EVENTS), max_size=60))
def test_any_sequence_of_events(events: list[tuple[int, object]]) -> None:
    limits = StationSettings(orders_kept=20, alarms_kept=20)
    station, now_ns = (
        Station(settings=limits, fleet=Fleet(profiles=PROFILES), airspace=AIRSPACE, clock=CLOCK),
        0,
    )
    for wait_ms, event in events:
        now_ns += wait_ms * S // 1000
        before = station
        station, outputs = step(station, event, now_ns)  # type: ignore[arg-type]
        again = step(before, event, now_ns)  # type: ignore[arg-type]
        assert repr(again[0]) == repr(station)
        for output in outputs:
            if isinstance(output, SendCommand):
                _judge(station, output, now_ns)
        assert len(station.frames) <= len(station.fleet.vehicles)
        assert all(r.history for r in station.orders.records.values())


def _judge(station: Station, output: SendCommand, now_ns: int) -> None:
    """Check by the state alone: open links only, no hover or return to a vehicle on the ground."""
    approved = output.approved
    assert approved.link_ids
    assert now_ns < approved.command.expires_at_ns
    for link_id in approved.link_ids:
        assert station.fleet.links[link_id].is_open
        state = station.fleet.vehicle_of_link(link_id)
        assert state is not None
        if isinstance(approved.command.body, Hover | ReturnHome):
            assert state.is_flying.value is not False
