"""The thread that writes the snapshot: at once when it matters, never in the event loop's way."""

import itertools
import threading
from dataclasses import replace
from pathlib import Path

import pytest
from tests.fleet.reports import core, extended
from tests.record.audits import PATIENCE_S, until
from tests.station.commanded import CommandedStation

from recon.model.command import Hover
from recon.model.control import AuthorityHolder
from recon.model.event import (
    AllStopped,
    AuthorityTaken,
    Event,
    HazardDismissed,
    StopReleased,
    Tick,
)
from recon.model.geo import LatLon
from recon.record.files.snapshot_file import CURRENT, read_snapshot
from recon.station.recovery import snapshot_writer
from recon.station.recovery.restart import LastRun
from recon.station.recovery.snapshot import RecoverySnapshot, decode_snapshot
from recon.station.recovery.snapshot_writer import SnapshotWriter, is_urgent, load_last_run
from recon.station.state.station import Station
from recon.station.state.steps import StepTaken


def written(folder: Path) -> RecoverySnapshot | None:
    return read_snapshot(folder, decode_snapshot).value


def clock(start_ns: int = 1) -> "itertools.count[int]":
    return itertools.count(start_ns)


class Scene(CommandedStation):
    """Two vehicles in flight, one without a serial; every step goes to a writer."""

    def __init__(self, writer: SnapshotWriter | None = None) -> None:
        super().__init__()
        self.writer = writer
        self.urgent: list[str] = []

    def happens(self, event: Event) -> CommandedStation:
        before = self.station
        super().happens(event)
        if is_urgent(before, self.station):
            self.urgent.append(type(event).__name__)
        if self.writer is not None:
            self.writer.observe(StepTaken(event, 0, before, self.station, ()))
        return self


class TestUrgent:
    def test_an_order_is_when_it_begins_and_when_it_ends(self) -> None:
        scene = Scene()
        scene.opens(1, core(), extended()).keeps_receiving(1, core(), extended()).passes(0.5)
        scene.urgent.clear()
        scene.order(Hover())
        assert scene.urgent == ["OperatorOrder"]
        scene.urgent.clear()
        scene.passes(15.0)
        assert len(scene.urgent) == 1

    def test_telemetry_and_time_are_not(self) -> None:
        scene = Scene()
        scene.opens(1, core(), extended()).keeps_receiving(1, core(), extended()).passes(5.0)
        assert scene.urgent == []

    def test_authority_a_lost_vehicle_and_its_dismissal_are(self) -> None:
        scene = Scene()
        elsewhere = core(position=LatLon(42.1, -93.6))
        scene.opens(1, core(), extended()).opens(7, elsewhere, extended(None))
        scene.happens(AuthorityTaken("A", AuthorityHolder.PILOT, "p"))
        scene.closes(7)
        scene.happens(HazardDismissed("link-7", "Ann"))
        scene.closes(1).passes(20.0).happens(HazardDismissed("A", "Ann"))
        assert scene.urgent == [
            "AuthorityTaken",
            "LinkClosed",
            "HazardDismissed",
            "HazardDismissed",
        ]

    def test_an_all_stop_and_its_release_are_also_with_nothing_in_flight(self) -> None:
        scene = Scene()
        scene.happens(AllStopped("Ann")).happens(StopReleased(None, "Ann"))
        assert scene.urgent == ["AllStopped", "StopReleased"]


class TestWriting:
    @pytest.fixture
    def slow(self, monkeypatch: pytest.MonkeyPatch) -> None:
        """Nothing is written unless it is urgent."""
        monkeypatch.setattr(snapshot_writer, "WRITE_EVERY_S", 10 * PATIENCE_S)

    def test_a_start_is_written_at_once(self, tmp_path: Path, slow: None) -> None:
        writer = SnapshotWriter(tmp_path, clock().__next__, last_order_id=2_000)
        writer.start(Station())
        until(lambda: written(tmp_path) is not None)
        snapshot = written(tmp_path)
        assert snapshot is not None
        assert snapshot.last_order_id == 2_000
        writer.close()

    def test_an_order_is_written_at_once(self, tmp_path: Path, slow: None) -> None:
        writer = SnapshotWriter(tmp_path, clock().__next__)
        writer.start(Station())
        scene = Scene(writer)
        scene.opens(1, core(), extended())
        number = scene.order(Hover())
        until(lambda: (found := written(tmp_path)) is not None and bool(found.orders))
        snapshot = written(tmp_path)
        assert snapshot is not None
        assert [order.id for order in snapshot.orders] == [number]
        assert set(snapshot.vehicles) == {"A"}
        writer.close()

    def test_telemetry_is_written_without_being_urgent(self, tmp_path: Path) -> None:
        writer = SnapshotWriter(tmp_path, clock().__next__)
        writer.start(Station())
        scene = Scene(writer)
        scene.opens(1, core(), extended())
        assert scene.urgent == []
        until(lambda: (found := written(tmp_path)) is not None and "A" in found.vehicles)
        writer.close()

    def test_the_last_state_is_written_on_closing(self, tmp_path: Path, slow: None) -> None:
        writer = SnapshotWriter(tmp_path, clock().__next__)
        writer.start(Station())
        until(lambda: written(tmp_path) is not None)
        scene = Scene(writer)
        scene.opens(1, core(), extended())
        writer.close()
        snapshot = written(tmp_path)
        assert snapshot is not None
        assert set(snapshot.vehicles) == {"A"}

    def test_a_disk_that_hangs_holds_nothing_up(
        self, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
    ) -> None:
        goes_on, is_reached = threading.Event(), threading.Event()
        write = snapshot_writer.write_snapshot

        def hangs(folder: Path, payload: bytes, *, keep_current: bool) -> None:
            is_reached.set()
            assert goes_on.wait(PATIENCE_S)
            write(folder, payload, keep_current=keep_current)

        monkeypatch.setattr(snapshot_writer, "write_snapshot", hangs)
        writer = SnapshotWriter(tmp_path, clock().__next__)
        writer.start(Station())
        assert is_reached.wait(PATIENCE_S)
        scene = Scene(writer)
        scene.opens(1, core(), extended())
        for _ in range(50):
            scene.order(Hover())
        goes_on.set()
        # The newest state alone comes next.
        until(lambda: (found := written(tmp_path)) is not None and found.last_order_id == 50)
        writer.close()

    def test_a_folder_that_cannot_be_written_is_a_problem_until_it_can(
        self, tmp_path: Path
    ) -> None:
        folder = tmp_path / "audit"
        folder.write_text("not a folder")
        writer = SnapshotWriter(folder, clock().__next__)
        writer.start(Station())
        until(lambda: writer.problem is not None)
        assert "recovery snapshot cannot be written" in str(writer.problem)
        assert str(folder) in str(writer.problem)
        folder.unlink()
        until(lambda: writer.problem is None)
        writer.close()
        assert written(folder) is not None

    def test_a_fault_while_taking_one_is_a_problem_and_the_next_one_is_written(
        self, tmp_path: Path
    ) -> None:
        broken = replace(Station(), fleet=None)  # type: ignore[arg-type]
        writer = SnapshotWriter(tmp_path, clock().__next__)
        writer.start(broken)
        until(lambda: writer.problem is not None)
        assert "cannot be taken" in str(writer.problem)
        writer.observe(StepTaken(Tick(), 0, broken, Station(), ()))
        until(lambda: written(tmp_path) is not None)
        writer.close()
        assert writer.problem is None

    def test_the_good_file_of_the_last_run_stays_as_the_previous_one(self, tmp_path: Path) -> None:
        for last_order_id in (1, 2):
            last_run, keep_current = load_last_run(tmp_path, 0)
            writer = SnapshotWriter(
                tmp_path,
                clock(9).__next__,
                last_order_id=last_order_id,
                keep_current=keep_current,
            )
            writer.start(Station())
            writer.close()
        assert last_run.snapshot is not None
        assert last_run.snapshot.last_order_id == 1
        (tmp_path / CURRENT).write_bytes(b"garbage")
        again, keep_current = load_last_run(tmp_path, 2)
        assert again.snapshot is not None
        assert again.snapshot.last_order_id == 1
        assert len(again.troubles) == 1
        assert not keep_current


class TestLoading:
    def test_an_empty_folder_is_a_first_run(self, tmp_path: Path) -> None:
        assert load_last_run(tmp_path, 0) == (LastRun(), False)

    def test_a_snapshot_that_is_missing_after_earlier_runs_is_a_trouble(
        self, tmp_path: Path
    ) -> None:
        last_run, _ = load_last_run(tmp_path, 3)
        (trouble,) = last_run.troubles
        assert "no recovery snapshot" in trouble
        assert last_run.first_ids[0] > 3_000_000
