"""The photos of a flight: `recon tag`, `recon mosaic` and `recon report`, one after the other.

Each command is a process in the background: a hostile photo, a card that is pulled out or a full
disk ends that process, and its step says so. What earlier steps have made stays, in a folder beside
the flight records; the cards are only read. The commands report progress and results as lines of
JSON (`photo_progress.py`). One job at a time.
"""

import asyncio
import contextlib
import os
import shutil
import signal
import sys
import time
from collections.abc import Callable, Sequence
from pathlib import Path
from threading import Thread
from typing import Any

from pydantic import ValidationError

from recon.api import schema
from recon.api.photo_routes import PhotoBusyError, PhotoRequestError
from recon.record.files.atomic_file import replace_file
from recon.station.host.background_process import background_process, lines_of
from recon.station.host.json_lines import LINE_MARK, LINES_WANTED
from recon.station.host.photo_folder import photo_folder
from recon.station.host.photo_progress import (
    LONGEST_SENTENCE,
    MADE,
    WARNING,
    after_line,
    begun,
    marked,
    running,
)

RECON = (sys.executable, "-m", "recon")
FOLDER_END = "-photos"
KEPT = "photos.json"
LARGEST_KEPT_BYTES = 1_000_000
LEAST_FREE_BYTES = 1_000_000_000
"""Left to the flight records, which are on the same disk."""
WITHIN_S = 6 * 3600.0
ANSWERS_WITHIN_S = 5.0
"""A card or a network's disk that does not answer for so long is refused."""
AGAIN = "start again, and it continues from there"


class _EndedError(Exception):
    """The running command is ended; the text states why, and what to do."""


class PhotoJob:
    """Implements the API's `PhotoWork` for the flight records of a folder."""

    def __init__(
        self,
        records: Path,
        record: Callable[[str], Path | None],
        command: Sequence[str] = RECON,
        site: Callable[[], Path | None] = lambda: None,
    ) -> None:
        """Take the records' folder; `record` returns the file of a flight's name, and `site` the
        folder of a site with an elevation model."""
        self._records = records
        self._record = record
        self._command = command
        self._site = site
        self._job = _last_job(records)
        self._is_busy = self._is_cancelled = False
        self._thread: Thread | None = None

    def close(self) -> None:
        """End a running job, and wait for its process."""
        self._is_cancelled = True
        if self._thread is not None:
            self._thread.join(2.0)

    def view(self) -> schema.PhotosView:
        """Return how far the job is, or what the last one found."""
        return schema.PhotosView(job=self._job)

    async def start(self, asked: schema.PhotoRequest) -> schema.PhotosView:
        """Begin a job; raises `PhotoBusyError` and `PhotoRequestError`."""
        if self._is_busy:
            raise PhotoBusyError("The station works on photos: wait for it, or cancel it")
        self._is_busy, self._is_cancelled = True, False
        loop = asyncio.get_running_loop()
        begun: asyncio.Future[str] = loop.create_future()

        def settle(problem: str) -> None:
            if not begun.done():
                begun.set_result(problem)

        def answer(problem: str) -> None:
            with contextlib.suppress(RuntimeError):
                loop.call_soon_threadsafe(settle, problem)

        # Not one of the loop's own threads: a disk that hangs would keep the station from ending.
        self._thread = Thread(target=self._begin, args=(asked, answer), daemon=True)
        self._thread.start()
        try:
            problem = await asyncio.wait_for(begun, ANSWERS_WITHIN_S)
        except TimeoutError:
            self._is_cancelled = True
            problem = "The folder does not answer: pull the card out, put it in and try again"
        if problem:
            raise PhotoRequestError(problem)
        return self.view()

    def cancel(self) -> schema.PhotosView:
        """End a running job; what it has found stays."""
        self._is_cancelled = True
        return self.view()

    def file(self, name: schema.PhotoFileName) -> Path | None:
        """Return a file of the job; None before there is one."""
        job = self._job
        if job is None or name not in job.files:
            return None
        path = self._out(job.flight) / MADE[name][1]
        return path if path.is_file() else None

    def _out(self, flight: str) -> Path:
        return self._records / f"{flight}{FOLDER_END}"

    def _checked(self, asked: schema.PhotoRequest) -> tuple[Path, list[str]]:
        """Return the record and the folders; raises `PhotoRequestError`. May wait for a disk."""
        record = self._record(asked.flight)
        if record is None:
            raise PhotoRequestError(f"No flight record {asked.flight!r} in the station's folder")
        folders = [photo_folder(text, self._records) for text in asked.folders]
        try:
            self._out(asked.flight).mkdir(mode=0o700, exist_ok=True)
        except OSError as problem:
            text = f"{self._out(asked.flight)} cannot be made: {problem.strerror}"
            raise PhotoRequestError(text) from problem
        return record, folders

    def _begin(self, asked: schema.PhotoRequest, answer: Callable[[str], None]) -> None:
        """Answer why there is no job, or with an empty text, and do the work."""
        try:
            record, folders = self._checked(asked)
        except PhotoRequestError as problem:
            # Before the answer: what is asked next must not find the station busy.
            self._is_busy = False
            answer(str(problem))
            return
        try:
            if not self._is_cancelled:
                self._job = begun(asked.flight, folders, str(self._out(asked.flight)))
                answer("")
                self._work(asked, record, folders)
        finally:
            self._is_busy = False

    def _work(self, asked: schema.PhotoRequest, record: Path, folders: list[str]) -> None:
        out = self._out(asked.flight)
        camera = [
            f"{option}={value!r}"
            for option, value in (
                ("--clock-offset", asked.clock_offset_s),
                ("--field", asked.field_deg),
            )
            if value is not None
        ]
        tagged, mosaic = str(out / "tagged"), str(out / "mosaic")
        flight = ("--flight", str(record), "--out", tagged, "--no-odm")
        try:
            if self._has_done("clock", ("tag", *folders, *flight, *camera)):
                site = self._site()
                ground = () if site is None else ("--site", str(site))
                words = ("mosaic", str(record), *folders, "--out", mosaic, *ground, *camera)
                shown = ("--mosaic", mosaic) if self._has_done("mosaic", words) else ()
                page = ("--out", str(out / "report.html"), "--tagged", tagged, *shown)
                self._has_done("report", ("report", str(record), *page))
        finally:
            self._end(out)

    def _end(self, out: Path) -> None:
        has_failed = any(step.state == "failed" for step in self._now.steps)
        state = "cancelled" if self._is_cancelled else "failed" if has_failed else "done"
        self._change(state=state, doing="", share=None)
        with contextlib.suppress(OSError):
            replace_file(out / KEPT, self._now.model_dump_json().encode())

    def _has_done(self, first: schema.PhotoStepName, words: Sequence[str]) -> bool:
        """Run a command, whose steps begin with `first`; return whether it succeeded."""
        if self._is_cancelled:
            return False
        self._job = marked(self._now, first, "running")
        try:
            problem = self._run(words)
        except _EndedError as ended:
            problem = str(ended)
        except OSError as failed:
            problem = f"It could not be started: {failed.strerror}"
        state = "failed" if problem else "done"
        self._job = marked(self._now, running(self._now) or first, state, problem)
        self._change(doing="", share=None)
        return not problem

    def _run(self, words: Sequence[str]) -> str:
        """Return why a command failed; empty if it has not. Raises `_EndedError`."""
        environment = {**os.environ, LINES_WANTED: "1", "PYTHONUNBUFFERED": "1"}
        last, begun = "", time.monotonic()
        with background_process((*self._command, *words), environment, merged=True) as process:
            for line in lines_of(process):
                self._job = after_line(self._now, line)
                if line.strip() and not line.startswith((LINE_MARK, WARNING)):
                    last = line
                self._require_room(begun)
            code = process.wait()
        return "" if code == 0 else _sentence(code, last)

    def _require_room(self, begun_s: float) -> None:
        """Raise `_EndedError` when the command must not go on."""
        if self._is_cancelled:
            raise _EndedError(f"Cancelled: {AGAIN}")
        if time.monotonic() - begun_s > WITHIN_S:
            raise _EndedError(
                f"It took longer than {WITHIN_S / 3600.0:g} h: take fewer photos at once"
            )
        if shutil.disk_usage(self._records).free < LEAST_FREE_BYTES:
            raise _EndedError(
                f"Less than {LEAST_FREE_BYTES / 1e9:g} GB is free on the disk of {self._records}, "
                f"which the flight records need: free some, then {AGAIN}"
            )

    @property
    def _now(self) -> schema.PhotoJobView:
        assert self._job is not None, "a job has begun"
        return self._job

    def _change(self, **changes: Any) -> None:
        self._job = self._now.model_copy(update=changes)


def _sentence(code: int, last: str) -> str:
    """Return why a command failed, by its exit code and last line."""
    if code == -signal.SIGKILL or "MemoryError" in last:
        return f"There was not enough memory: close other programs and {AGAIN}"
    text = last.strip().removeprefix("recon: ")[:LONGEST_SENTENCE]
    return text if code > 0 and text else f"It ended without a reason (code {code}): {AGAIN}"


def _last_job(records: Path) -> schema.PhotoJobView | None:
    """Return the newest job that an earlier run of the station has finished here."""
    with contextlib.suppress(OSError, ValidationError):
        kept = list(records.glob(f"*{FOLDER_END}/{KEPT}"))
        newest = max(kept, key=lambda path: path.stat().st_mtime_ns, default=None)
        if newest is not None and newest.stat().st_size <= LARGEST_KEPT_BYTES:
            return schema.PhotoJobView.model_validate_json(newest.read_bytes())
    return None
