"""A ceiling on the records of demonstrations in a folder, and nothing else there."""

import json
import re
from itertools import islice
from pathlib import Path

from recon.model.errors import RecordError
from recon.record.mcap.mcap_file import ABOUT_NAME
from recon.record.mcap.mcap_read import McapReading, RecordAttachment
from recon.record.mcap.record_writer import if_unlocked

RECORD_NAME = re.compile(r"(ground|flight)-(\d{8}T\d{6}Z)(-\d+)?\.mcap")
FIRST_ITEMS = 2
"""A record begins with the station's state and what a person reads of it."""


def remove_oldest_demos(folder: Path, most_bytes: int) -> None:
    """Remove the oldest records of demonstrations until all of them take at most `most_bytes`.

    What is written or replayed stays, and so does what does not state that it is a demonstration's.
    A folder that cannot be read is left alone.
    """
    try:
        named = [each for each in folder.iterdir() if RECORD_NAME.fullmatch(each.name)]
        records = [each for each in named if not each.is_symlink() and _is_demo(each)]
        size_bytes = {each: each.stat().st_size for each in records}
    except OSError:
        return
    total_bytes = sum(size_bytes.values())
    for path in sorted(records, key=lambda each: each.name.partition("-")[2]):
        if total_bytes <= most_bytes:
            return
        if_unlocked(path, Path.unlink)
        if not path.exists():
            total_bytes -= size_bytes[path]


def _is_demo(path: Path) -> bool:
    """Return whether a record states, at its beginning, that it is a demonstration's."""
    try:
        with path.open("rb") as file:
            first = list(islice(McapReading(file).items(), FIRST_ITEMS))
        about = [e.data for e in first if isinstance(e, RecordAttachment) and e.name == ABOUT_NAME]
        found = json.loads(about[0]) if about else None
    except (OSError, RecordError, ValueError, RecursionError):
        return False
    return isinstance(found, dict) and found.get("is_demo") is True
