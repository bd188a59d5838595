"""Several files change together: a crash at any write leaves the old ones or the new ones."""

from collections.abc import Callable
from pathlib import Path

import pytest

from recon.model.errors import RecordError
from recon.record.files import atomic_file, file_set
from recon.record.files.file_set import finish_interrupted, last_change, replace_files, undo

OLD = {"a.txt": b"old a", "b.txt": b"old b", "c.txt": None}
NEW = {"a.txt": b"new a", "b.txt": None, "c.txt": b"new c"}
ABOUT = {"what": "boundary", "by": "anna", "utc": "2026-05-01T12:00:00+00:00"}


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    for name, content in OLD.items():
        if content is not None:
            (tmp_path / name).write_bytes(content)
    return tmp_path


def contents(folder: Path) -> dict[str, bytes | None]:
    paths = {name: folder / name for name in OLD}
    return {name: path.read_bytes() if path.exists() else None for name, path in paths.items()}


def test_a_change_is_undone_and_an_older_one_after_it(folder: Path) -> None:
    replace_files(folder, NEW, **ABOUT)
    replace_files(folder, {"a.txt": b"newest a"}, **ABOUT)
    assert contents(folder) == NEW | {"a.txt": b"newest a"}
    for expected in (NEW, OLD):
        change = last_change(folder)
        assert change is not None
        undo(folder, change)
        assert contents(folder) == expected
    assert last_change(folder) is None


class Crash(BaseException):
    """The process ends here."""


def crash_at(count: int) -> Callable[..., None]:
    """A rename that works this often."""
    left, rename = count, atomic_file.os.replace

    def replace(*names: object) -> None:
        nonlocal left
        left -= 1
        if left < 0:
            raise Crash
        rename(*names)  # type: ignore[arg-type]

    return replace


@pytest.mark.parametrize("count", range(8))
def test_after_a_crash_at_any_rename_the_files_belong_together(
    folder: Path, count: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    is_whole = False
    with monkeypatch.context() as patch:
        patch.setattr("os.replace", crash_at(count))
        try:
            replace_files(folder, NEW, **ABOUT)
            is_whole = True
        except Crash:
            pass
    finish_interrupted(folder)
    assert contents(folder) == (NEW if is_whole else OLD)
    assert is_whole == (last_change(folder) is not None)
    # 2 old files, the manifest, the entry, 2 new files and the end: eight calls or fewer.
    assert is_whole == (count >= 7)


def test_a_disk_error_changes_nothing(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    write = file_set.replace_file

    def fails(path: Path, data: bytes, mode: int) -> None:
        if path.name == "c.txt":
            raise OSError(28, "No space left on device")
        write(path, data, mode)

    monkeypatch.setattr(file_set, "replace_file", fails)
    with pytest.raises(OSError, match="No space"):
        replace_files(folder, NEW, **ABOUT)
    assert contents(folder) == OLD
    assert last_change(folder) is None


def test_only_the_newest_changes_are_kept(folder: Path) -> None:
    for number in range(file_set.CHANGES_KEPT + 3):
        replace_files(folder, {"a.txt": str(number).encode()}, **ABOUT)
    kept = list((folder / file_set.HISTORY_FOLDER).iterdir())
    assert len(kept) == file_set.CHANGES_KEPT


def test_an_entry_changed_by_hand_writes_nothing_outside(folder: Path, tmp_path: Path) -> None:
    inner = folder / "site"
    inner.mkdir()
    (inner / "a.txt").write_bytes(b"a")
    replace_files(inner, {"a.txt": b"b"}, **ABOUT)
    change = last_change(inner)
    assert change is not None
    manifest = inner / "history" / "0001" / file_set.MANIFEST
    manifest.write_text(manifest.read_text().replace("a.txt", "../a.txt"))
    for act in (undo, file_set.files_before, file_set.changed_since):
        with pytest.raises(RecordError, match="inside the folder"):
            act(inner, change)
    assert contents(tmp_path) == OLD
    assert not finish_interrupted(inner)


def test_files_edited_since_a_change_are_named(folder: Path) -> None:
    replace_files(folder, NEW, **ABOUT)
    change = last_change(folder)
    assert change is not None
    assert file_set.changed_since(folder, change) == []
    (folder / "a.txt").write_bytes(b"by hand")
    (folder / "b.txt").write_bytes(b"by hand")
    assert file_set.changed_since(folder, change) == ["a.txt", "b.txt"]
