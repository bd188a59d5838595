"""What a damaged, slow or withheld packet costs: an image at most, never its link or its age."""

import numpy as np
import pytest
from tests.link.approved import LINK_ID, MS, ack, approved, core, extended, mission
from tests.link.test_session import IMAGE_HEAD, answers, session

from recon import wire
from recon.link.session import Session
from recon.model.event import CommandAnswered, Event, PacketReceived
from recon.model.report import CoreReport, ExtendedReport, ImageReport

SECOND = 1000 * MS
READ = 32 * 1024
FHD = (1080, 1920)
UHD = (2160, 3840)


def head(rows: int, cols: int) -> bytes:
    size = (17 + 3 * rows * cols).to_bytes(4, "big")
    return b"\xda\xa7" + size + b"\x02" + bytes(4) + rows.to_bytes(2, "big") + cols.to_bytes(2)


def damaged_image(rows: int, cols: int) -> bytes:
    """A frame of the right size and a wrong hash."""
    return head(rows, cols) + bytes(3 * rows * cols) + b"\xff\xff"


def small_image() -> bytes:
    """A good image of 90 KB: three reads."""
    return wire.encode(wire.Image(target_fps_hz=1.0, pixels=np.zeros((150, 200, 3), np.uint8)))


def feed(s: Session, data: bytes, now_ns: int) -> list[Event]:
    events: list[Event] = []
    for start in range(0, len(data), READ):
        events += s.receive(data[start : start + READ], now_ns)
        while s.is_busy:
            events += s.resume()
    return events


def arrivals(events: list[Event]) -> list[tuple[type, int | None]]:
    return [(type(e.report), e.arrived_at_ns) for e in events if isinstance(e, PacketReceived)]


class TestDamage:
    @pytest.mark.parametrize("images", [[UHD], [FHD, FHD], [UHD, UHD]])
    def test_damaged_images_close_no_identified_link(self, images: list[tuple[int, int]]) -> None:
        s = session()
        feed(s, extended(), 0)
        for rows, cols in images:
            feed(s, damaged_image(rows, cols), MS)
        assert s.closing_reason is None
        assert arrivals(feed(s, core(), 2 * MS)) == [(CoreReport, 2 * MS)]

    def test_a_pause_in_the_middle_of_an_image_closes_no_link(self) -> None:
        s = session()
        image = damaged_image(*UHD)
        feed(s, extended() + image[:1_000_000], 0)
        for at_ms in range(50, 2600, 50):
            s.tick(at_ms * MS)
        assert s.counters.abandoned >= 1
        feed(s, image[1_000_000:], 2600 * MS)
        assert s.closing_reason is None
        assert arrivals(feed(s, core(), 2700 * MS)) == [(CoreReport, 2700 * MS)]

    def test_damage_without_end_closes_the_link(self) -> None:
        s = session(damaged_limit_bytes=10_000_000)
        feed(s, extended(), 0)
        feed(s, damaged_image(*FHD), MS)
        assert s.closing_reason is None
        feed(s, damaged_image(*FHD), MS)
        assert s.closing_reason == "12441634 bytes of damaged packets without one valid packet"


class TestStationPaused:
    """The station did not run for 3 s; the rest of a good image lay in the kernel."""

    @pytest.mark.parametrize("ticks_first", [True, False])
    def test_a_good_image_is_kept(self, ticks_first: bool) -> None:
        s = session()
        image = small_image()
        feed(s, extended() + image[:READ], 0)
        s.tick(50 * MS)
        if ticks_first:
            assert s.tick(3050 * MS, has_unread=True) == []
        events = feed(s, image[READ:], 3050 * MS)
        assert arrivals(events) == [(ImageReport, 3050 * MS)]

    def test_the_age_of_an_image_leaves_the_pause_out(self) -> None:
        s = session()
        image = small_image()
        feed(s, image[:READ], 0)
        for second in range(1, 9):
            s.tick(second * SECOND - MS)
            feed(s, image[READ + second - 1 : READ + second], second * SECOND)
        feed(s, image[READ + 8 : -1], 12 * SECOND)
        s.tick(12_500 * MS)
        events = feed(s, image[-1:], 12_600 * MS)
        assert arrivals(events) == [(ImageReport, 12_600 * MS)]

    def test_an_app_that_pauses_by_itself_loses_its_image(self) -> None:
        s = session()
        image = small_image()
        feed(s, image[:READ], 0)
        for at_ms in range(50, 3050, 50):
            s.tick(at_ms * MS)
        assert s.counters.abandoned == 1
        assert arrivals(feed(s, image[READ:], 3050 * MS)) == []


class TestWithheld:
    def test_packets_inside_a_claimed_image_keep_the_time_they_came(self) -> None:
        s = session()
        assert feed(s, IMAGE_HEAD + extended() + core(), 20 * MS) == []
        events: list[Event] = []
        for at_ms in range(50, 2100, 50):
            events += s.tick(at_ms * MS)
        assert arrivals(events) == [(ExtendedReport, 20 * MS), (CoreReport, 20 * MS)]

    def test_drip_fed_bytes_withhold_no_age(self) -> None:
        s = session()
        feed(s, IMAGE_HEAD + core(), 20 * MS)
        events: list[Event] = []
        for at_ms in range(50, 10_100, 50):
            if at_ms % 1500 == 0:
                events += feed(s, b"\x00", at_ms * MS)
            events += s.tick(at_ms * MS)
        assert arrivals(events) == [(CoreReport, 20 * MS)]

    def test_an_acknowledgment_from_before_a_command_does_not_answer_it(self) -> None:
        s = session()
        assert feed(s, IMAGE_HEAD + ack(253), 0) == []
        s.submit(approved(1, mission(), SECOND))
        assert s.next_packet(SECOND) is not None
        assert answers(s.tick(2 * SECOND)) == []
        assert answers(feed(s, ack(253), 2 * SECOND)) == [CommandAnswered(LINK_ID, 1, True)]
        assert s.acks.unexpected == 1


class TestWork:
    def test_a_hostile_frame_is_searched_in_turns(self) -> None:
        """25 MB of headers, each of which claims all that follows."""
        rows, cols = UHD
        hostile = bytearray(head(rows, cols))
        size = 17 + 3 * rows * cols
        while len(hostile) + 15 < size:
            hostile += head((size - len(hostile) - 17) // (3 * cols), cols)
        hostile += bytes(size - len(hostile))
        reads = [bytes(hostile[start : start + READ]) for start in range(0, size, READ)]
        s = session()
        for read in reads[:-1]:
            s.receive(read, 0)
        turns, most, done = 0, 0, s.work_done
        s.receive(reads[-1], MS)
        while s.is_busy:
            turns, most, done = turns + 1, max(most, s.work_done - done), s.work_done
            s.resume()
        print(f"hostile frame of 25 MB: {turns} turns, at most {most} bytes of work each")
        assert turns > 40
        assert most < 5 * 2**20
        assert s.buffered_bytes < 2**20
