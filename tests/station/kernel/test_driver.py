"""The drivers' one queue, and the asyncio driver's way of letting time pass."""

import asyncio
import threading
import time

import pytest
from tests.fleet.reports import core
from tests.station.imagers import imager_of, with_imagers

from recon.model.event import ClockGap, Event, LinkOpened, PacketReceived, Tick
from recon.model.units import NS_PER_S
from recon.site import default_site
from recon.station.imaging.frames import PROJECT_FRAME
from recon.station.kernel.build import first_state
from recon.station.kernel.driver import AsyncioDriver, station_clock
from recon.station.kernel.event_queue import EventQueue
from recon.station.state.steps import JobDropped

PATIENCE_S = 120.0


class TestQueue:
    def test_what_an_event_causes_waits_behind_those_already_there(self) -> None:
        handled: list[int] = []

        def handle(event: Event) -> None:
            assert isinstance(event, LinkOpened)
            handled.append(event.link_id)
            if event.link_id < 10:
                queue.put(LinkOpened(event.link_id * 10, ""))
                queue.put(LinkOpened(event.link_id * 10 + 1, ""))
                # Nothing of it has been handled inside this handling.
                assert handled[-1] == event.link_id

        queue = EventQueue(handle)
        queue.put(LinkOpened(1, ""))
        queue.put(LinkOpened(2, ""))
        assert handled == [1, 10, 11, 2, 20, 21]

    def test_after_an_error_it_goes_on_in_order(self) -> None:
        handled: list[Event] = []

        def handle(event: Event) -> None:
            handled.append(event)
            if len(handled) == 1:
                queue.put(LinkOpened(2, ""))
                raise RuntimeError("a fault")

        queue = EventQueue(handle)
        with pytest.raises(RuntimeError, match="a fault"):
            queue.put(LinkOpened(1, ""))
        queue.put(LinkOpened(3, ""))
        assert handled == [LinkOpened(n, "") for n in (1, 2, 3)]


class TestAsyncioDriver:
    def test_time_passes_and_events_of_other_threads_arrive(self) -> None:
        async def main() -> None:
            seen: list[Event] = []
            driver = AsyncioDriver(
                with_imagers(first_state(default_site()), "IMAGER"),
                station_clock(),
                lambda step: seen.append(step.event),
            )
            driver.handle_from_thread(JobDropped(0, PROJECT_FRAME))
            running = asyncio.create_task(driver.run())
            async with asyncio.timeout(PATIENCE_S):
                while not any(isinstance(event, Tick) for event in seen):
                    await asyncio.sleep(0)
            dropped = JobDropped(1, PROJECT_FRAME)
            thread = threading.Thread(target=driver.handle_from_thread, args=(dropped,))
            thread.start()
            async with asyncio.timeout(PATIENCE_S):
                while dropped not in seen:
                    await asyncio.sleep(0)
            thread.join()
            assert imager_of(driver.station).frames_dropped == 1
            running.cancel()
            with pytest.raises(asyncio.CancelledError):
                await running

        asyncio.run(main())

    def test_an_uncaught_error_in_the_loop_is_an_alarm_and_time_goes_on(
        self, capsys: pytest.CaptureFixture[str]
    ) -> None:
        async def main() -> None:
            driver = AsyncioDriver(first_state(default_site()), station_clock())
            running = asyncio.create_task(driver.run())
            await asyncio.sleep(0)
            loop = asyncio.get_running_loop()
            loop.call_soon(lambda: [][0])
            async with asyncio.timeout(PATIENCE_S):
                while not driver.station.alarms.alarms:
                    await asyncio.sleep(0)
            (alarm,) = driver.station.alarms.alarms.values()
            assert "in its event loop: IndexError: " in alarm.condition.text
            running.cancel()
            with pytest.raises(asyncio.CancelledError):
                await running

        asyncio.run(main())
        assert "Traceback" not in "".join(capsys.readouterr())

    def test_a_gap_between_its_ticks_comes_before_the_packets_that_waited(self) -> None:
        now_ns = [0]
        events: list[Event] = []
        driver = AsyncioDriver(
            first_state(default_site()),
            lambda: now_ns[0],
            lambda step: events.append(step.event),
        )
        driver.handle(LinkOpened(1, "127.0.0.1:1"))
        now_ns[0] += 30 * NS_PER_S  # a slow start is no gap
        for _ in range(3):
            driver.handle(Tick())
            now_ns[0] += NS_PER_S // 20
        assert not any(isinstance(event, ClockGap) for event in events)
        now_ns[0] += 60 * NS_PER_S
        waited = PacketReceived(1, core())
        driver.handle(waited)
        assert events[-2:] == [ClockGap(pytest.approx(60.05)), waited]
        link = driver.station.fleet.links[1]
        assert link.own_state.core_received_at_ns is None

    @pytest.mark.parametrize(
        "missing", [(), ("CLOCK_BOOTTIME",), ("CLOCK_BOOTTIME", "CLOCK_MONOTONIC")]
    )
    def test_every_system_has_a_clock(
        self, monkeypatch: pytest.MonkeyPatch, missing: tuple[str, ...]
    ) -> None:
        """Linux, macOS, Windows."""
        for name in missing:
            monkeypatch.delattr(time, name, raising=False)
        now_ns = station_clock()
        assert abs(now_ns() - time.time_ns()) < 60 * NS_PER_S

    def test_the_clock_begins_at_utc_and_never_runs_back(self) -> None:
        now_ns = station_clock()
        times = [now_ns() for _ in range(1000)]
        assert times == sorted(times)
        assert times[0] > 1_600_000_000 * 1_000_000_000
