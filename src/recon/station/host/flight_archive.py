"""The records of a folder, and files made of them.

Files are made by `recon export` and `recon report` in a process of their own, one at a time and
with low priority: reading a long record takes a core for seconds, and this process must answer an
all stop meanwhile. A few files are kept until their record changes.
"""

import asyncio
import contextlib
import os
import subprocess
import sys
from collections import OrderedDict
from collections.abc import Callable, Sequence
from pathlib import Path
from tempfile import TemporaryDirectory

from pydantic import ValidationError

from recon.api import schema
from recon.api.flight_routes import FlightBusyError, FlightFileError
from recon.station.host.background_process import background_process

SUFFIX = ".mcap"
MOST_LISTED = 1_000
MOST_WAITING = 4
"""Most requests that wait for the file being made."""
MOST_KEPT = 12
WITHIN_S = 600.0
LONGEST_SENTENCE = 500
RECON = (sys.executable, "-m", "recon")


class RecordedFlights:
    """Implements the API's `FlightArchive` for a folder."""

    def __init__(
        self,
        folder: Path,
        recording: Callable[[], Path | None] = lambda: None,
        command: Sequence[str] = RECON,
    ) -> None:
        """Take the folder; `recording` returns this run's record."""
        self._folder = folder
        self._recording = recording
        self._command = command
        self._made_folder = TemporaryDirectory(prefix="recon-flights-")
        self._made: OrderedDict[tuple[str, str, int, int], Path] = OrderedDict()
        self._count = self._waiting = 0
        self._one = asyncio.Lock()
        self._process: subprocess.Popen[bytes] | None = None

    def close(self) -> None:
        """End what is being made, and remove what was."""
        if self._process is not None:
            self._process.kill()
        self._made_folder.cleanup()

    def flights(self) -> list[schema.FlightView]:
        """Return the records, the newest first."""
        found = []
        recording = self._recording()
        for name, path in self._records().items():
            with contextlib.suppress(OSError):
                stat = path.stat()
                changed_ms = stat.st_mtime_ns // 1_000_000
                found.append(
                    schema.FlightView(
                        name=name,
                        size_bytes=stat.st_size,
                        changed_at_unix_ms=changed_ms,
                        is_recording=path == recording,
                    )
                )
        newest = sorted(found, key=lambda each: each.changed_at_unix_ms, reverse=True)
        return newest[:MOST_LISTED]

    def record(self, name: str) -> Path | None:
        """Return a record's file; None for an unknown name."""
        return self._records().get(name)

    async def figures(self, name: str) -> schema.FlightFiguresView | None:
        """Return a flight's figures; raises `FlightBusyError` and `FlightFileError`."""
        path = await self._file(name, "figures.json")
        if path is None:
            return None
        try:
            return schema.FlightFiguresView.model_validate_json(path.read_bytes())
        except (ValidationError, OSError) as problem:
            raise FlightFileError(f"{name}: its figures cannot be read") from problem

    async def file(self, name: str, file: schema.FlightFileName) -> Path | None:
        """Return a file made of a record; raises as `figures`."""
        return await self._file(name, file)

    def _records(self) -> dict[str, Path]:
        """Return the files of the folder by name: no links, nothing outside."""
        try:
            with os.scandir(self._folder) as entries:
                return {
                    entry.name.removesuffix(SUFFIX): self._folder / entry.name
                    for entry in entries
                    if entry.name.endswith(SUFFIX) and entry.is_file(follow_symlinks=False)
                }
        except OSError:
            return {}

    async def _file(self, name: str, file: str) -> Path | None:
        record = self.record(name)
        if record is None:
            return None
        if self._waiting >= MOST_WAITING:
            raise FlightBusyError("Other files are being made of records; try again in a minute")
        self._waiting += 1
        try:
            async with self._one:
                stat = record.stat()
                key = (name, file, stat.st_size, stat.st_mtime_ns)
                if key not in self._made:
                    self._keep(key, await self._make(record, file))
                self._made.move_to_end(key)
                return self._made[key]
        except OSError as problem:
            raise FlightFileError(f"{name}: cannot be read: {problem.strerror}") from problem
        finally:
            self._waiting -= 1

    def _keep(self, key: tuple[str, str, int, int], path: Path) -> None:
        self._made[key] = path
        while len(self._made) > MOST_KEPT:
            _oldest, gone = self._made.popitem(last=False)
            # A download that is running has it open.
            gone.unlink(missing_ok=True)

    async def _make(self, record: Path, file: str) -> Path:
        self._count += 1
        out = Path(self._made_folder.name) / f"{self._count}-{file}"
        is_page = file.endswith(".html")
        words = ("report", str(record), "--out") if is_page else ("export", str(record))
        try:
            is_done, errors = await asyncio.to_thread(self._run, (*self._command, *words, str(out)))
        except subprocess.TimeoutExpired as problem:
            raise FlightFileError(
                f"{file} took longer than {WITHIN_S:g} s: run recon export on the record"
            ) from problem
        if not is_done or not out.is_file():
            raise FlightFileError(_sentence(errors, record))
        return out

    def _run(self, command: Sequence[str]) -> tuple[bool, bytes]:
        """Run a command; return whether it succeeded, and its errors."""
        with background_process(command) as process:
            self._process = process
            try:
                _out, errors = process.communicate(timeout=WITHIN_S)
            finally:
                self._process = None
        return process.returncode == 0, errors


def _sentence(errors: bytes, record: Path) -> str:
    """Return the last line of a command's errors, without the folders of this computer."""
    lines = errors.decode(errors="replace").strip().splitlines()
    last = lines[-1] if lines else "the file was not made"
    text = last.removeprefix("recon: ").replace(str(record), record.name)
    return text[:LONGEST_SENTENCE]
