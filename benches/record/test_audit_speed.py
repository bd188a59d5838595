"""What the audit costs whoever puts an entry, and how soon the entry is in the file.

Beside it, in the same run, what writing each line at once would cost: into the system's memory, and
with a sync onto the disk. The limits asserted are far above what is measured.
"""

import os
import time
from pathlib import Path

import numpy as np
import pytest

from recon.record.audit.audit import AuditEntry, NumberedEntry, encode_line
from recon.record.audit.audit_log import AuditLog

ENTRIES = 2_000
SYNCED = 50
PUT_P99_LIMIT_MS = 5.0
WRITTEN_P99_LIMIT_MS = 500.0

ENTRY = AuditEntry(
    "order.sent", "Anna: hover: sent", "api 127.0.0.1", "1ZN", "Anna", {"id": 7, "phase": "sent"}
)


def p99_ms(times_s: list[float]) -> float:
    return 1e3 * float(np.percentile(times_s, 99))


def report(capsys: pytest.CaptureFixture[str], name: str, times_s: list[float]) -> None:
    p50, p99, most = (1e3 * float(np.percentile(times_s, p)) for p in (50, 99, 100))
    with capsys.disabled():
        line = f"{name:<32} p50 {p50:7.3f} ms   p99 {p99:7.3f} ms   most {most:7.3f} ms"
        print(f"\n{line}", end="", flush=True)


def test_putting_costs_little_and_lines_are_soon_in_the_file(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    log = AuditLog(tmp_path)
    log.start()
    put_s: list[float] = []
    written_s: list[float] = []
    for _ in range(ENTRIES):
        begin_s = time.perf_counter()
        stamped = log.put(ENTRY, 0)
        put_s.append(time.perf_counter() - begin_s)
        while log.written_n < stamped.n:
            os.sched_yield()
        written_s.append(time.perf_counter() - begin_s)
    log.close()
    plain_s, synced_s = writing_at_once(tmp_path / "plain")
    report(capsys, "audit: an entry put", put_s)
    report(capsys, "audit: until it is in the file", written_s)
    report(capsys, "write at once, no sync", plain_s)
    report(capsys, "write and sync at once", synced_s)
    assert p99_ms(put_s) < PUT_P99_LIMIT_MS
    assert p99_ms(written_s) < WRITTEN_P99_LIMIT_MS


def writing_at_once(path: Path) -> tuple[list[float], list[float]]:
    """Return what each line costs its writer without and with a sync."""
    line = encode_line(NumberedEntry(1, 0, 0, ENTRY), "0" * 64) + b"\n"
    plain_s: list[float] = []
    synced_s: list[float] = []
    file = os.open(path, os.O_WRONLY | os.O_CREAT | os.O_APPEND)
    for number in range(ENTRIES):
        begin_s = time.perf_counter()
        os.write(file, line)
        plain_s.append(time.perf_counter() - begin_s)
        if number < SYNCED:
            os.fsync(file)
            synced_s.append(time.perf_counter() - begin_s)
    os.close(file)
    return plain_s, synced_s
