"""The session with a clock that is a number: pacing, urgency, answers, limits, the end."""

import pytest
from tests.link.approved import LINK_ID, MS, ack, approved, core, extended, mission, stick

from recon import wire
from recon.link.session import Session
from recon.link.settings import LinkSettings
from recon.model.command import (
    FlyMission,
    Hover,
    LandNow,
    Phase,
    ReturnHome,
    StartCamera,
    StopCamera,
)
from recon.model.event import CommandAnswered, CommandDropped, Event, PacketReceived
from recon.model.report import CoreReport

SECOND = 1000 * MS
EMERGENCY, CAMERA, MISSION, STICK = 255, 254, 253, 252

IMAGE_HEAD = (
    bytes.fromhex("daa7")
    + (17 + 3 * 1920 * 1080).to_bytes(4, "big")
    + b"\x02"
    + bytes(4)
    + (1080).to_bytes(2, "big")
    + (1920).to_bytes(2, "big")
)
"""The beginning of an image whose pixels never come."""


def session(**settings: float) -> Session:
    return Session(LINK_ID, LinkSettings(**settings), 0)  # type: ignore[arg-type]


def sent_ids(session: Session, now_ns: int) -> list[int]:
    ids = []
    while (outgoing := session.next_packet(now_ns)) is not None:
        ids.append(outgoing.event.command_id)
    return ids


def answers(events: list[Event]) -> list[CommandAnswered]:
    return [event for event in events if isinstance(event, CommandAnswered)]


class TestPacing:
    def test_two_packets_are_100_ms_apart(self) -> None:
        s = session()
        s.submit(approved(1, stick()))
        s.submit(approved(2, StartCamera(1.0)))
        assert sent_ids(s, 0) == [1]
        assert sent_ids(s, 100 * MS - 1) == []
        assert sent_ids(s, 100 * MS) == [2]

    @pytest.mark.parametrize("gap_s", [0.0, 0.02, 0.5])
    def test_a_profile_sets_its_own_gap(self, gap_s: float) -> None:
        s = session()
        s.submit(approved(1, stick(), packet_gap_s=gap_s))
        s.submit(approved(2, StopCamera(), packet_gap_s=gap_s))
        assert sent_ids(s, 0)[:1] == [1]
        if gap_s > 0.0:
            assert sent_ids(s, int(gap_s * 1e9) - 1) == []
            assert sent_ids(s, int(gap_s * 1e9)) == [2]

    def test_each_outgoing_is_one_whole_packet(self) -> None:
        s = session()
        s.submit(approved(1, mission(25)))
        outgoing = s.next_packet(0)
        assert outgoing is not None
        assert len(outgoing.data) == 1011
        assert isinstance(wire.decode(outgoing.data), wire.ExecuteWaypointMission)

    def test_others_keep_the_gap_after_an_emergency(self) -> None:
        s = session()
        s.submit(approved(1, Hover()))
        s.submit(approved(2, mission()))
        assert sent_ids(s, 0) == [1]
        assert sent_ids(s, 100 * MS) == [2]


class TestWhomItIsFor:
    def test_what_waits_for_one_aircraft_is_not_sent_to_another(self) -> None:
        s = session()
        s.receive(extended(b"A"), 0)
        s.submit(approved(1, stick()))
        s.submit(approved(2, Hover()))
        s.submit(approved(3, StartCamera(1.0)))
        dropped = [e for e in s.receive(extended(b"B"), MS) if isinstance(e, CommandDropped)]
        assert {(e.command_id, e.phase) for e in dropped} == {(2, Phase.FAILED), (3, Phase.FAILED)}
        assert sent_ids(s, SECOND) == []

    def test_the_first_serial_and_the_same_again_drop_nothing(self) -> None:
        s = session()
        s.submit(approved(1, Hover()))
        for serial in (b"A", b"00000", b"", b"A"):
            events = s.receive(extended(serial), 0)
            assert not any(isinstance(e, CommandDropped) for e in events)
        assert sent_ids(s, SECOND) == [1]


class TestUrgency:
    def test_an_emergency_waits_for_no_gap(self) -> None:
        s = session()
        s.submit(approved(1, stick()))
        assert sent_ids(s, 0) == [1]
        s.submit(approved(2, Hover()))
        assert sent_ids(s, 1) == [2]

    def test_an_emergency_waits_for_no_answer(self) -> None:
        s = session()
        s.submit(approved(1, mission()))
        s.submit(approved(2, LandNow()))
        s.submit(approved(3, StartCamera(1.0)))
        assert sent_ids(s, 0) == [2]
        for number, body in enumerate((Hover(), ReturnHome(), LandNow()), start=4):
            s.submit(approved(number, body))
            assert sent_ids(s, number) == [number]

    def test_it_takes_unsent_motion_with_it(self) -> None:
        s = session()
        s.submit(approved(1, stick()))
        sent_ids(s, 0)
        s.submit(approved(2, mission()))
        dropped = s.submit(approved(3, Hover()))
        assert [(d.command_id, d.phase) for d in dropped] == [(2, Phase.SUPERSEDED)]
        assert sent_ids(s, SECOND) == [3]

    def test_a_newer_emergency_supersedes_an_unsent_one(self) -> None:
        s = session()
        s.submit(approved(1, Hover()))
        dropped = s.submit(approved(2, LandNow()))
        assert dropped == [
            CommandDropped(LINK_ID, 1, Phase.SUPERSEDED, "Replaced by order 2 before sending")
        ]
        assert sent_ids(s, 0) == [2]

    def test_a_repeat_is_no_new_order(self) -> None:
        s = session()
        s.submit(approved(1, Hover()))
        assert s.submit(approved(1, Hover())) == []
        assert s.commands_queued == 1


class TestSuperseding:
    @pytest.mark.parametrize(
        ("older", "newer"),
        [(stick(), stick()), (mission(), stick()), (stick(), mission()), (mission(), mission(3))],
    )
    def test_the_newest_unsent_motion_counts(self, older: FlyMission, newer: FlyMission) -> None:
        s = session()
        s.submit(approved(1, older))
        dropped = s.submit(approved(2, newer))
        assert [d.command_id for d in dropped] == [1]
        assert sent_ids(s, 0) == [2]

    def test_a_stick_flood_leaves_one(self) -> None:
        s = session()
        dropped = [d for number in range(1000) for d in s.submit(approved(number, stick()))]
        assert [d.command_id for d in dropped] == list(range(999))
        assert s.commands_queued == 1

    def test_expiry_is_reported(self) -> None:
        s = session()
        s.submit(approved(1, stick()))
        sent_ids(s, 0)
        s.submit(approved(2, mission(), expires_after_s=0.05))
        assert sent_ids(s, 50 * MS) == []
        events = s.tick(50 * MS)
        assert events == [CommandDropped(LINK_ID, 2, Phase.EXPIRED, "not sent in time")]

    def test_an_expired_order_is_never_sent_even_without_a_tick(self) -> None:
        s = session()
        s.submit(approved(1, Hover(), expires_after_s=1.0))
        assert sent_ids(s, SECOND) == []


class TestAnswers:
    def test_one_unanswered_mission(self) -> None:
        s = session()
        s.submit(approved(1, mission()))
        assert sent_ids(s, 0) == [1]
        s.submit(approved(2, mission(3)))
        assert sent_ids(s, SECOND) == []
        events = s.receive(ack(MISSION), SECOND)
        assert answers(events) == [CommandAnswered(LINK_ID, 1, True)]
        assert sent_ids(s, SECOND) == [2]

    def test_one_unanswered_camera_command(self) -> None:
        s = session()
        s.submit(approved(1, StartCamera(1.0)))
        assert sent_ids(s, 0) == [1]
        s.submit(approved(2, StopCamera()))
        assert sent_ids(s, SECOND) == []
        s.receive(ack(CAMERA, positive=0), SECOND)
        assert sent_ids(s, SECOND) == [2]

    def test_a_stick_is_never_blocked(self) -> None:
        s = session()
        s.submit(approved(1, mission()))
        sent_ids(s, 0)
        for number in range(2, 12):
            s.submit(approved(number, stick()))
            assert sent_ids(s, number * 100 * MS) == [number]

    def test_stick_answers_are_only_counted(self) -> None:
        s = session()
        s.submit(approved(1, stick()))
        sent_ids(s, 0)
        assert answers(s.receive(ack(STICK), MS)) == []
        assert s.acks.unexpected == 0

    def test_answers_match_by_kind_in_order(self) -> None:
        s = session()
        s.submit(approved(1, Hover()))
        sent_ids(s, 0)
        s.submit(approved(2, LandNow()))
        sent_ids(s, MS)
        s.submit(approved(3, StartCamera(1.0)))
        sent_ids(s, SECOND)
        data = ack(CAMERA) + ack(EMERGENCY) + ack(EMERGENCY, positive=0)
        assert answers(s.receive(data, SECOND)) == [
            CommandAnswered(LINK_ID, 3, True),
            CommandAnswered(LINK_ID, 1, True),
            CommandAnswered(LINK_ID, 2, False),
        ]

    def test_an_answer_to_nothing_is_counted(self) -> None:
        s = session()
        assert answers(s.receive(ack(MISSION), 0)) == []
        assert s.acks.unexpected == 1

    def test_a_missed_answer_is_reported_and_frees_its_lane(self) -> None:
        s = session()
        s.submit(approved(1, mission()))
        sent_ids(s, 0)
        s.submit(approved(2, mission(3)))
        assert answers(s.tick(2 * SECOND - 1)) == []
        assert answers(s.tick(2 * SECOND)) == [CommandAnswered(LINK_ID, 1, None)]
        assert sent_ids(s, 2 * SECOND) == [2]

    def test_a_late_answer_is_not_believed_of_the_next(self) -> None:
        s = session()
        s.submit(approved(1, mission()))
        sent_ids(s, 0)
        s.tick(2 * SECOND)
        s.submit(approved(2, mission(3), 2 * SECOND))
        sent_ids(s, 2 * SECOND)
        assert answers(s.receive(ack(MISSION, positive=0), 3 * SECOND)) == []
        assert s.acks.ignored_late == 1
        assert answers(s.receive(ack(MISSION), 3 * SECOND)) == [CommandAnswered(LINK_ID, 2, True)]

    def test_after_ten_seconds_a_late_answer_comes_no_more(self) -> None:
        s = session()
        s.submit(approved(1, mission()))
        sent_ids(s, 0)
        s.tick(2 * SECOND)
        s.submit(approved(2, mission(3), 13 * SECOND))
        sent_ids(s, 13 * SECOND)
        assert answers(s.receive(ack(MISSION), 13 * SECOND)) == [CommandAnswered(LINK_ID, 2, True)]

    def test_an_app_that_never_answers_costs_no_memory(self) -> None:
        s = session()
        for number in range(2000):
            now_ns = number * 100 * MS
            s.submit(approved(number, Hover(), now_ns))
            sent_ids(s, now_ns)
            s.tick(now_ns)
        misses = s.acks._missed_at_ns.values()
        assert sum(len(times_ns) for times_ns in misses) <= 110


class TestLimits:
    def test_garbage_is_counted_and_ends_the_link(self) -> None:
        s = session(garbage_limit_bytes=10_000)
        s.receive(b"x" * 9_000, 0)
        assert s.closing_reason is None
        s.receive(b"x" * 9_000, MS)
        assert s.closing_reason is not None
        assert "without one valid packet" in s.closing_reason

    def test_a_packet_between_forgives_garbage(self) -> None:
        s = session(garbage_limit_bytes=10_000)
        for number in range(10):
            s.receive(b"x" * 9_000, number)
            s.receive(core(), number)
        assert s.closing_reason is None

    @pytest.mark.parametrize("data", [b"", ack(9), core()[:40]])
    def test_an_idle_link_that_never_identified_itself_is_closed(self, data: bytes) -> None:
        s = session()
        s.receive(data, 0)
        s.tick(10 * SECOND)
        assert s.closing_reason is None
        s.tick(10 * SECOND + 1)
        assert s.closing_reason == "no serial number, no telemetry and no valid packet for 10 s"

    @pytest.mark.parametrize("telemetry", [core(), extended()])
    def test_a_link_with_telemetry_is_an_aircraft_and_stays(self, telemetry: bytes) -> None:
        s = session()
        s.receive(telemetry, SECOND)
        s.tick(3600 * SECOND)
        assert s.closing_reason is None

    @pytest.mark.parametrize("blocked_at_ns", [0, SECOND])
    def test_an_app_that_does_not_read_is_closed(self, blocked_at_ns: int) -> None:
        s = session()
        s.receive(core(), 0)
        s.note_socket(False, blocked_at_ns)
        s.note_socket(False, blocked_at_ns + 5 * SECOND)
        s.tick(blocked_at_ns + 5 * SECOND)
        assert s.closing_reason is None
        s.tick(blocked_at_ns + 5 * SECOND + 1)
        assert s.closing_reason == "the app has not read for 5 s"

    def test_a_socket_that_clears_is_forgiven(self) -> None:
        s = session()
        s.receive(core(), 0)
        for second in range(0, 40, 4):
            s.note_socket(False, second * SECOND)
            s.note_socket(True, (second + 3) * SECOND)
            s.tick((second + 4) * SECOND)
        assert s.closing_reason is None

    def test_half_a_packet_does_not_hide_the_next_for_long(self) -> None:
        s = session()
        assert s.receive(IMAGE_HEAD + core(), 0) == []
        events = s.tick(2 * SECOND + MS)
        assert [type(e.report) for e in events if isinstance(e, PacketReceived)] == [CoreReport]


class TestEnd:
    def test_what_is_unsent_fails_with_the_reason(self) -> None:
        s = session()
        s.submit(approved(1, stick()))
        sent_ids(s, 0)
        s.submit(approved(2, mission()))
        s.submit(approved(3, StartCamera(1.0)))
        dropped = s.finish("the app closed the connection")
        assert [(d.command_id, d.phase) for d in dropped if isinstance(d, CommandDropped)] == [
            (2, Phase.FAILED),
            (3, Phase.FAILED),
        ]
        assert all("the app closed the connection" in d.reason for d in dropped)  # type: ignore[union-attr]
        assert sent_ids(s, SECOND) == []

    def test_what_is_held_is_read(self) -> None:
        s = session()
        assert s.receive(IMAGE_HEAD + core(), 0) == []
        events = s.finish("gone")
        assert [type(e.report) for e in events if isinstance(e, PacketReceived)] == [CoreReport]


class TestDoor:
    def test_only_approved_commands_get_in(self) -> None:
        command = approved(1, Hover()).command
        with pytest.raises(TypeError, match="only approved commands"):
            session().submit(command)  # type: ignore[arg-type]

    def test_not_for_another_link(self) -> None:
        with pytest.raises(TypeError, match="not for 7"):
            session().submit(approved(1, Hover(), link_ids=(8,)))


class TestWithdrawal:
    def test_only_the_unsent_order_to_move_is_dropped(self) -> None:
        s = session()
        for number, body in enumerate((Hover(), mission(), StartCamera(1.0)), start=1):
            s.submit(approved(number, body))
        assert s.withdraw_motion("the pilot flies") == [
            CommandDropped(LINK_ID, 2, Phase.SUPERSEDED, "the pilot flies")
        ]
        assert s.withdraw_motion("again") == []
        assert sorted(sent_ids(s, 0) + sent_ids(s, SECOND)) == [1, 3]


class TestSticks:
    """A stream at 10 Hz: its beat wavers, and other orders want their turn."""

    def test_a_stick_that_comes_some_milliseconds_early_does_not_wait(self) -> None:
        s = session()
        for number in range(1, 30):
            now_ns = number * 100 * MS + (12 * MS if number % 2 else -12 * MS)
            s.submit(approved(number, stick(), now_ns))
            assert sent_ids(s, now_ns) == [number]

    def test_two_at_once_are_kept_apart_and_the_newer_goes(self) -> None:
        s = session()
        s.submit(approved(1, stick()))
        assert sent_ids(s, 0) == [1]
        s.submit(approved(2, stick()))
        s.submit(approved(3, stick()))
        assert sent_ids(s, 75 * MS - 1) == []
        assert sent_ids(s, 75 * MS) == [3]

    @pytest.mark.parametrize(("gap_s", "kept_ms"), [(0.02, 20), (0.15, 75), (0.2, 200), (0.5, 500)])
    def test_an_app_that_is_slow_keeps_its_gap(self, gap_s: float, kept_ms: int) -> None:
        s = session()
        s.submit(approved(1, stick(), packet_gap_s=gap_s))
        assert sent_ids(s, 0) == [1]
        s.submit(approved(2, stick(), packet_gap_s=gap_s))
        assert sent_ids(s, kept_ms * MS - 1) == []
        assert sent_ids(s, kept_ms * MS) == [2]

    def test_other_orders_keep_the_whole_gap_after_a_stick(self) -> None:
        s = session()
        s.submit(approved(1, stick()))
        assert sent_ids(s, 0) == [1]
        s.submit(approved(2, mission()))
        assert sent_ids(s, 100 * MS - 1) == []
        assert sent_ids(s, 100 * MS) == [2]

    def test_a_camera_order_has_its_turn_in_a_stream(self) -> None:
        s = session()
        sent: list[int] = []
        for number in range(1, 11):
            now_ns = number * 95 * MS
            s.submit(approved(number, stick(), now_ns))
            if number == 3:
                s.submit(approved(100, StartCamera(1.0), now_ns))
            for late_ms in (0, 50):
                sent += sent_ids(s, now_ns + late_ms * MS)
        assert 100 in sent
        assert sent.index(100) <= 4
        assert sent[-1] == 10
        assert len(sent) >= 9

    def test_a_camera_order_that_waits_for_an_answer_holds_no_stick_up(self) -> None:
        s = session()
        s.submit(approved(100, StartCamera(1.0)))
        assert sent_ids(s, 0) == [100]
        s.submit(approved(101, StopCamera(), 100 * MS))
        for number in range(1, 8):
            now_ns = number * 100 * MS
            s.submit(approved(number, stick(), now_ns))
            assert sent_ids(s, now_ns) == [number]

    def test_an_emergency_order_waits_for_no_stick(self) -> None:
        s = session()
        s.submit(approved(1, stick()))
        assert sent_ids(s, 0) == [1]
        s.submit(approved(2, stick()))
        dropped = s.submit(approved(3, Hover()))
        assert [d.command_id for d in dropped] == [2]
        assert sent_ids(s, MS) == [3]
