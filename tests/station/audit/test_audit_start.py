"""How a run's audit begins: where, after which run, and never in another station's way."""

from pathlib import Path

import pytest
from tests.record.audits import entry, until, written

from recon.record.audit import FAILED_KIND, STOPPED_KIND, AuditEntry
from recon.record.audit_check import check_audit
from recon.record.audit_files import audit_files
from recon.record.audit_log import AuditLog
from recon.record.errors import RecordError
from recon.station.audit.start import (
    MOST_FILES_LOOKED_AT,
    AuditPlace,
    begin_audit,
    default_place,
    ended_entry,
    started_entry,
)
from recon.station.recovery.last_run import LastRun
from recon.station.state.settings import StationSettings

ORDER = {"id": 41, "phase": "queued", "order": "hover", "body": {}}


def put_order(log: AuditLog) -> None:
    log.put(AuditEntry("order.queued", "x", "y", "A", "Anna", ORDER), 1)


class TestPlace:
    def test_each_port_has_a_folder_and_a_free_port_one_to_write_to(self) -> None:
        environment = {"XDG_STATE_HOME": "/state"}
        place = default_place(3001, environment)
        assert place == AuditPlace(Path("/state/recon/audit/port-3001"))
        assert default_place(0, environment) == AuditPlace(
            Path("/state/recon/audit/any-port"), is_shared=True
        )

    def test_without_a_word_it_is_in_the_users_state_folder(self) -> None:
        assert default_place(3001, {}).folder.is_relative_to(Path.home() / ".local" / "state")


class TestBegin:
    def test_nothing_there_is_a_first_run(self, tmp_path: Path) -> None:
        begun = begin_audit(AuditPlace(tmp_path / "new"))
        assert begun.last == LastRun()
        assert begun.troubles == ()

    def test_the_last_run_is_read_and_its_chain_followed(self, tmp_path: Path) -> None:
        written(tmp_path, 2)
        first = written(tmp_path, 3, put_order)
        begun = begin_audit(AuditPlace(tmp_path))
        assert begun.last.last_id == 41
        begun.log.start()
        begun.log.put(entry(), 1)
        begun.log.close()
        assert check_audit(first).is_end_known
        assert all(check_audit(path).is_whole for path in audit_files(tmp_path))

    def test_a_run_that_was_killed_at_once_does_not_hide_the_one_before(
        self, tmp_path: Path
    ) -> None:
        first = written(tmp_path, 1, put_order)
        killed = written(tmp_path, 1)
        killed.write_bytes(killed.read_bytes().splitlines(keepends=True)[0])
        (tmp_path / "recon-audit-000003-20250601T000000Z.jsonl").touch()
        begun = begin_audit(AuditPlace(tmp_path))
        assert begun.last.last_id == 41
        begun.log.start()
        begun.log.put(entry(), 1)
        begun.log.close()
        # The chain leads on over the file that has nothing in it.
        assert check_audit(first).is_end_known
        assert check_audit(killed).is_end_known

    def test_only_a_few_files_are_looked_at(self, tmp_path: Path) -> None:
        written(tmp_path, 1, put_order)
        for number in range(2, 3 + MOST_FILES_LOOKED_AT):
            (tmp_path / f"recon-audit-{number:06d}-20250601T000000Z.jsonl").touch()
        assert begin_audit(AuditPlace(tmp_path)).last.last_id == 0

    def test_damage_is_told_and_no_reason_not_to_start(self, tmp_path: Path) -> None:
        path = written(tmp_path, 5, put_order)
        data = path.read_bytes()
        path.write_bytes(b"garbage\n" + data[:-20])
        begun = begin_audit(AuditPlace(tmp_path))
        told = " ".join(begun.troubles)
        assert "damaged" in told
        assert "cut short" in told

    def test_a_folder_that_is_shared_is_not_read(self, tmp_path: Path) -> None:
        written(tmp_path, 1, put_order)
        assert begin_audit(AuditPlace(tmp_path, is_shared=True)).last.last_id == 0

    def test_a_running_stations_folder_is_refused(self, tmp_path: Path) -> None:
        running = AuditLog(tmp_path)
        running.start()
        running.put(entry(), 1)
        until(lambda: running.path is not None)
        with pytest.raises(RecordError, match="another station"):
            begin_audit(AuditPlace(tmp_path))
        running.close()

    def test_a_folder_that_is_a_file_is_trouble_alone(self, tmp_path: Path) -> None:
        place = tmp_path / "audit"
        place.write_text("not a folder")
        assert begin_audit(AuditPlace(place, is_shared=True)).troubles == ()


class TestFirstAndLastWord:
    def test_the_start_tells_version_settings_site_and_numbers(self) -> None:
        last = LastRun(last_id=7, was_stopped=True, lines=9)
        told = started_entry(StationSettings(), {"name": "field", "sha256": "ab"}, last, ("x",))
        assert told.details["site"]["sha256"] == "ab"
        assert told.details["settings"]["order_expiry_s"] == 5.0
        assert told.details["first_id"] > 1_000
        assert told.details["last_run_ended_in_order"] is True

    def test_an_end_by_a_fault_is_no_end_in_order(self) -> None:
        assert ended_entry(None).kind == STOPPED_KIND
        failed = ended_entry(ValueError("shapes (5,) (4,)"))
        assert failed.kind == FAILED_KIND
        assert "shapes (5,) (4,)" in failed.text
