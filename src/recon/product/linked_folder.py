"""A folder of links to photos that takes the place of an earlier one when it is complete."""

import os
import shutil
from collections.abc import Sequence
from pathlib import Path


def replace_folder(folder: Path, files: Sequence[tuple[Path, str]]) -> None:
    """Write a folder of files, each from a path under a name; raises OSError.

    They are written beside an earlier folder, which stays until they are all there, and for good
    when that fails or is ended. They are hard links where the disk allows it, copies elsewhere.
    """
    coming = folder.with_name(f"{folder.name}.new")
    _recover(folder)
    _remove(coming)
    coming.mkdir(parents=True)
    try:
        for source, name in files:
            _link(source, coming / name)
    except OSError:
        _remove(coming)
        raise
    put_in_place(coming, folder)


def put_in_place(coming: Path, folder: Path) -> None:
    """Rename a complete folder to take the place of an earlier one; raises OSError."""
    _recover(folder)
    if folder.exists():
        folder.rename(_gone(folder))
    coming.rename(folder)
    _remove(_gone(folder))


def _gone(folder: Path) -> Path:
    return folder.with_name(f"{folder.name}.old")


def _recover(folder: Path) -> None:
    """Make good for a run that was ended between its two renames, or behind them."""
    if _gone(folder).exists() and not folder.exists():
        _gone(folder).rename(folder)
    _remove(_gone(folder))


def _remove(folder: Path) -> None:
    if folder.exists():
        shutil.rmtree(folder)


def _link(source: Path, target: Path) -> None:
    try:
        os.link(source, target)
    except OSError:
        shutil.copyfile(source, target)
