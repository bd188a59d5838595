"""A cut or changed audit is found; a torn last line is tolerated and reported."""

from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from tests.examples import examples
from tests.record.audits import entry, written

from recon.model.errors import RecordError
from recon.record.audit.audit import STOPPED_KIND
from recon.record.audit.audit_check import check_audit
from recon.record.audit.audit_files import audit_files, read_run_end
from recon.record.audit.audit_log import AuditLog


def lines_of(path: Path) -> list[bytes]:
    return path.read_bytes().splitlines(keepends=True)


class TestWhole:
    def test_two_runs_hang_together(self, tmp_path: Path) -> None:
        first, second = written(tmp_path, 5), written(tmp_path, 3)
        verdict = check_audit(first)
        assert verdict.is_whole
        assert verdict.is_end_known
        assert verdict.lines == 6
        assert check_audit(second).is_whole
        assert not check_audit(second).is_end_known

    def test_an_end_in_order_is_reported(self, tmp_path: Path) -> None:
        path = written(tmp_path, 1, lambda log: log.put(entry(kind=STOPPED_KIND), 1) and None)
        assert check_audit(path).is_closed
        assert not check_audit(written(tmp_path, 2)).is_closed

    def test_a_torn_last_line_is_tolerated_and_reported(self, tmp_path: Path) -> None:
        path = written(tmp_path, 5)
        path.write_bytes(path.read_bytes()[:-30])
        verdict = check_audit(path)
        assert verdict.is_whole
        assert verdict.torn_bytes > 0
        assert verdict.lines == 5

    def test_a_run_after_a_torn_one_follows_its_last_whole_line(self, tmp_path: Path) -> None:
        first = written(tmp_path, 5)
        first.write_bytes(first.read_bytes()[:-30])
        second = written(tmp_path, 2)
        assert check_audit(first).is_whole
        assert check_audit(first).is_end_known
        assert check_audit(second).is_whole


class TestDamage:
    def test_a_changed_line_is_found(self, tmp_path: Path) -> None:
        path = written(tmp_path, 5)
        path.write_bytes(path.read_bytes().replace(b"entry 2", b"entry 7"))
        (fault,) = check_audit(path).faults
        assert "line 5" in fault

    def test_a_line_taken_out_is_found(self, tmp_path: Path) -> None:
        path = written(tmp_path, 5)
        lines = lines_of(path)
        path.write_bytes(b"".join(lines[:2] + lines[3:]))
        assert not check_audit(path).is_whole

    def test_a_cut_beginning_is_found(self, tmp_path: Path) -> None:
        path = written(tmp_path, 5)
        path.write_bytes(b"".join(lines_of(path)[1:]))
        assert "the beginning is cut" in " ".join(check_audit(path).faults)

    def test_a_cut_end_is_found_by_what_the_next_run_noted(self, tmp_path: Path) -> None:
        path = written(tmp_path, 5)
        written(tmp_path, 1)
        path.write_bytes(b"".join(lines_of(path)[:-1]))
        (fault,) = check_audit(path).faults
        assert "the end is cut" in fault

    def test_a_changed_last_line_is_found_by_what_the_next_run_noted(self, tmp_path: Path) -> None:
        path = written(tmp_path, 5)
        written(tmp_path, 1)
        path.write_bytes(path.read_bytes().replace(b"entry 4", b"entry 5"))
        assert not check_audit(path).is_whole

    def test_a_run_taken_out_is_missed(self, tmp_path: Path) -> None:
        paths = [written(tmp_path, 2) for _ in range(3)]
        paths[1].unlink()
        assert check_audit(paths[2]).missing_before == paths[1].name
        assert check_audit(paths[0]).missing_before is None

    def test_an_empty_file_is_no_audit(self, tmp_path: Path) -> None:
        path = tmp_path / "empty.jsonl"
        path.touch()
        assert check_audit(path).faults == ("expected lines of an audit, got none",)

    def test_a_file_that_is_not_there_is_one_sentence(self, tmp_path: Path) -> None:
        with pytest.raises(RecordError, match="cannot read the audit"):
            check_audit(tmp_path / "none.jsonl")

    @settings(max_examples=examples(60), deadline=None)
    @given(data=st.data())
    def test_any_changed_byte_is_found(self, tmp_path_factory: object, data: st.DataObject) -> None:
        """Once a later run has noted the end; torn is what lost its last line break."""
        whole = _WHOLE
        at = data.draw(st.integers(0, len(whole) - 2))
        byte = data.draw(st.integers(0, 255).filter(lambda b: b != whole[at]))
        _FIRST.write_bytes(whole[:at] + bytes([byte]) + whole[at + 1 :])
        assert not check_audit(_FIRST).is_whole

    @settings(max_examples=examples(30), deadline=None)
    @given(kept=st.integers(0, 3000))
    def test_any_cut_is_found(self, kept: int) -> None:
        _FIRST.write_bytes(_WHOLE[: min(kept, len(_WHOLE) - 2)])
        assert not check_audit(_FIRST).is_whole


_FIRST = Path()
_WHOLE = b""


@pytest.fixture(scope="module", autouse=True)
def two_runs(tmp_path_factory: pytest.TempPathFactory) -> None:
    global _FIRST, _WHOLE
    folder = tmp_path_factory.mktemp("audit")
    _FIRST = written(folder, 6)
    _WHOLE = _FIRST.read_bytes()
    written(folder, 1)


class TestReading:
    def test_only_the_tail_of_a_huge_file_is_read(self, tmp_path: Path) -> None:
        path = written(tmp_path, 200)
        lines = lines_of(path)
        path.write_bytes(b"".join([b"garbage\n", *lines[1:]]))
        end = read_run_end(path, at_most_bytes=5_000)
        assert end.last is not None
        assert end.last.n == 200
        assert end.bad_lines == 0
        assert read_run_end(path).bad_lines == 1

    def test_garbage_between_is_counted_and_passed_over(self, tmp_path: Path) -> None:
        path = written(tmp_path, 3)
        lines = lines_of(path)
        noise = [b"\xff\xfe\n", b"y" * 300_000 + b"\n", b"[" * 60_000 + b"\n"]
        path.write_bytes(b"".join([*lines[:2], *noise, *lines[2:], b"torn"]))
        end = read_run_end(path)
        assert (end.bad_lines, end.torn_bytes) == (3, 4)
        assert end.last is not None
        assert end.last.n == 3

    def test_a_file_without_a_line_break_takes_no_memory(self, tmp_path: Path) -> None:
        path = tmp_path / "recon-audit-000001-20250601T000000Z.jsonl"
        path.write_bytes(b"z" * 10_000_000)
        end = read_run_end(path, at_most_bytes=20_000_000)
        assert end.last is None
        assert end.bad_lines == 1
        assert read_run_end(path).last is None

    def test_other_files_in_the_folder_are_left_alone(self, tmp_path: Path) -> None:
        (tmp_path / "notes.txt").write_text("mine")
        path = written(tmp_path, 1)
        assert audit_files(tmp_path) == [path]
        assert audit_files(tmp_path / "nowhere") == []

    def test_a_run_after_one_that_cannot_be_read_begins_a_chain_of_its_own(
        self, tmp_path: Path
    ) -> None:
        garbage = tmp_path / "recon-audit-000041-20250601T000000Z.jsonl"
        garbage.write_bytes(b"garbage\n")
        log = AuditLog(tmp_path)
        log.follow(read_run_end(garbage))
        log.start()
        log.put(entry(), 1)
        log.close()
        assert log.path is not None
        assert log.path.name.startswith("recon-audit-000042-")
        assert check_audit(log.path).is_whole
