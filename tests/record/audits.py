"""Audits made for tests."""

import os
import time
from collections.abc import Callable
from pathlib import Path

from recon.record.audit.audit import AuditEntry
from recon.record.audit.audit_files import audit_files, read_run_end
from recon.record.audit.audit_log import AuditLog

PATIENCE_S = 120.0


def entry(text: str = "it happened", kind: str = "test", **details: object) -> AuditEntry:
    return AuditEntry(kind, text, by="test", serial="A", vehicle="Anna", details=details)


def until(is_reached: Callable[[], bool]) -> None:
    """Wait for what another thread does."""
    end_s = time.monotonic() + PATIENCE_S
    while not is_reached():
        assert time.monotonic() < end_s, "it never came"
        os.sched_yield()


def written(folder: Path, count: int, put: Callable[[AuditLog], None] | None = None) -> Path:
    """Write a run of so many entries into a folder that may hold earlier runs; return its file."""
    log = AuditLog(folder)
    files = audit_files(folder)
    if files:
        log.follow(read_run_end(files[-1]))
    log.start()
    for number in range(count):
        log.put(entry(f"entry {number}"), number)
    if put is not None:
        put(log)
    log.close()
    assert log.path is not None
    return log.path
