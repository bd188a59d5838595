"""How a run's audit begins: where, after which run, and never in another station's way."""

from pathlib import Path

import pytest
from tests.record.audits import entry, until, written

from recon.model.errors import RecordError
from recon.record.audit.audit import FAILED_KIND, STOPPED_KIND
from recon.record.audit.audit_check import check_audit
from recon.record.audit.audit_files import audit_files
from recon.record.audit.audit_log import AuditLog
from recon.station.audit.start import (
    MAX_FILES_READ,
    AuditPlace,
    begin_audit,
    default_place,
    ended_entry,
    started_entry,
)
from recon.station.state.settings import StationSettings


class TestPlace:
    def test_each_port_has_a_folder_and_a_free_port_one_to_write_to(self) -> None:
        environment = {"XDG_STATE_HOME": "/state"}
        place = default_place(3001, environment)
        assert place == AuditPlace(Path("/state/recon/audit/port-3001"))
        assert default_place(0, environment) == AuditPlace(
            Path("/state/recon/audit/any-port"), is_shared=True
        )

    def test_by_default_it_is_in_the_users_state_folder(self) -> None:
        assert default_place(3001, {}).folder.is_relative_to(Path.home() / ".local" / "state")


class TestBegin:
    def test_an_empty_folder_is_a_first_run(self, tmp_path: Path) -> None:
        begun = begin_audit(AuditPlace(tmp_path / "new"))
        assert (begun.runs_before, begun.ended_in_order) == (0, False)
        assert begun.troubles == ()

    def test_the_chain_of_the_last_run_continues(self, tmp_path: Path) -> None:
        written(tmp_path, 2)
        first = written(tmp_path, 3)
        begun = begin_audit(AuditPlace(tmp_path))
        assert begun.runs_before == 2
        begun.log.start()
        begun.log.put(entry(), 1)
        begun.log.close()
        assert check_audit(first).is_end_known
        assert all(check_audit(path).is_whole for path in audit_files(tmp_path))

    def test_whether_the_last_run_was_stopped_or_killed_is_read(self, tmp_path: Path) -> None:
        written(tmp_path, 1, lambda log: log.put(ended_entry(None), 1))
        assert begin_audit(AuditPlace(tmp_path)).ended_in_order
        written(tmp_path, 1)
        assert not begin_audit(AuditPlace(tmp_path)).ended_in_order

    def test_the_chain_continues_over_a_run_that_was_killed_at_once(self, tmp_path: Path) -> None:
        first = written(tmp_path, 1)
        killed = written(tmp_path, 1)
        killed.write_bytes(killed.read_bytes().splitlines(keepends=True)[0])
        (tmp_path / "recon-audit-000003-20250601T000000Z.jsonl").touch()
        begun = begin_audit(AuditPlace(tmp_path))
        assert begun.runs_before == 3
        begun.log.start()
        begun.log.put(entry(), 1)
        begun.log.close()
        # The empty file is skipped.
        assert check_audit(first).is_end_known
        assert check_audit(killed).is_end_known

    def test_only_a_few_files_are_read(self, tmp_path: Path) -> None:
        written(tmp_path, 1, lambda log: log.put(ended_entry(None), 1))
        for number in range(2, 3 + MAX_FILES_READ):
            (tmp_path / f"recon-audit-{number:06d}-20250601T000000Z.jsonl").touch()
        begun = begin_audit(AuditPlace(tmp_path))
        assert not begun.ended_in_order
        assert begun.runs_before == 2 + MAX_FILES_READ

    def test_damage_is_reported_and_the_station_starts(self, tmp_path: Path) -> None:
        path = written(tmp_path, 5)
        data = path.read_bytes()
        path.write_bytes(b"garbage\n" + data[:-20])
        begun = begin_audit(AuditPlace(tmp_path))
        troubles = " ".join(begun.troubles)
        assert "damaged" in troubles
        assert "incomplete" in troubles

    def test_a_shared_folder_is_not_read(self, tmp_path: Path) -> None:
        written(tmp_path, 1)
        assert begin_audit(AuditPlace(tmp_path, is_shared=True)).runs_before == 0

    def test_a_running_stations_folder_is_refused(self, tmp_path: Path) -> None:
        running = AuditLog(tmp_path)
        running.start()
        running.put(entry(), 1)
        until(lambda: running.path is not None)
        with pytest.raises(RecordError, match="another running station"):
            begin_audit(AuditPlace(tmp_path))
        running.close()

    def test_a_file_in_place_of_a_shared_folder_does_not_stop_the_start(
        self, tmp_path: Path
    ) -> None:
        place = tmp_path / "audit"
        place.write_text("not a folder")
        assert begin_audit(AuditPlace(place, is_shared=True)).troubles == ()


class TestFirstAndLastEntry:
    def test_a_start_has_version_settings_site_and_ids(self) -> None:
        site = {"name": "field", "sha256": "ab"}
        started = started_entry(StationSettings(), site, True, (2001, -9), ("x",))
        assert started.details["site"]["sha256"] == "ab"
        assert started.details["settings"]["order_expiry_s"] == 5.0
        assert (started.details["first_id"], started.details["next_own_id"]) == (2001, -9)
        assert started.details["last_run_ended_in_order"] is True
        assert started.details["troubles"] == ["x"]

    def test_an_end_by_a_fault_is_not_a_stop(self) -> None:
        assert ended_entry(None).kind == STOPPED_KIND
        failed = ended_entry(ValueError("shapes (5,) (4,)"))
        assert failed.kind == FAILED_KIND
        assert "shapes (5,) (4,)" in failed.text
