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
    coming, gone = (folder.with_name(f"{folder.name}.{end}") for end in ("new", "old"))
    if gone.exists() and not folder.exists():
        gone.rename(folder)  # An earlier run was ended between its two renames.
    _remove(coming)
    _remove(gone)
    coming.mkdir(parents=True)
    try:
        for source, name in files:
            _link(source, coming / name)
    except OSError:
        _remove(coming)
        raise
    if folder.exists():
        folder.rename(gone)
    coming.rename(folder)
    _remove(gone)


def _remove(folder: Path) -> None:
    if folder.exists():
        shutil.rmtree(folder)


def _link(source: Path, target: Path) -> None:
    try:
        os.link(source, target)
    except OSError:
        shutil.copyfile(source, target)
