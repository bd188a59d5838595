"""The audit of a running station: nothing waits for it, and its troubles are alarms."""

import threading
from pathlib import Path

import pytest
from tests.record.audits import PATIENCE_S, entry, until

from recon.model.event import LinkOpened, Tick
from recon.record.audit.audit_log import AuditLog
from recon.station.audit import auditor as log_module
from recon.station.audit.auditor import WAITING_LINES, Auditor, LogPrinter
from recon.station.kernel.driver import AsyncioDriver
from recon.station.state.station import Station

NOW_NS = 1_800_000_000_000_000_000


def test_an_audit_that_cannot_be_written_is_an_alarm_until_it_can(tmp_path: Path) -> None:
    log = AuditLog(tmp_path)
    auditor = Auditor(log, LogPrinter(), lambda: NOW_NS)
    driver = AsyncioDriver(Station(), lambda: NOW_NS, auditor.observe)
    auditor.handle = driver.handle
    log.problem = "the audit cannot be written to /here: No space left on device"
    driver.handle(Tick())
    driver.handle(Tick())
    (alarm,) = driver.station.alarms.alarms.values()
    assert alarm.is_active
    assert alarm.condition.rule == "audit"
    assert "No space left" in alarm.condition.text
    driver.handle(LinkOpened(1, "10.0.0.1:5"))
    assert 1 in driver.station.fleet.links
    log.problem = None
    driver.handle(Tick())
    driver.handle(Tick())
    (alarm,) = driver.station.alarms.alarms.values()
    assert not alarm.is_active
    kinds = [stamped.entry.kind for stamped in log.after(0, 100)]
    assert kinds.count("audit.trouble") == 2
    assert kinds.count("alarm.raised") == 1


def test_a_recovery_snapshot_that_cannot_be_written_is_an_alarm_too(tmp_path: Path) -> None:
    auditor = Auditor(AuditLog(tmp_path), LogPrinter(), lambda: NOW_NS)
    driver = AsyncioDriver(Station(), lambda: NOW_NS, auditor.observe)
    auditor.handle = driver.handle
    auditor.snapshot_problem = lambda: "the recovery snapshot cannot be written to /here: full"
    driver.handle(Tick())
    driver.handle(Tick())
    (alarm,) = driver.station.alarms.alarms.values()
    assert "the recovery snapshot cannot be written to /here: full" in alarm.condition.text
    auditor.snapshot_problem = lambda: None
    driver.handle(Tick())
    driver.handle(Tick())
    (alarm,) = driver.station.alarms.alarms.values()
    assert not alarm.is_active


class Terminal:
    """Stands in for the log: blocks until it is released."""

    def __init__(self) -> None:
        self.goes_on = threading.Event()
        self.is_reached = threading.Event()
        self.lines: list[str] = []

    def print_line(self, text: str, _by: str = "") -> None:
        self.is_reached.set()
        assert self.goes_on.wait(PATIENCE_S)
        self.lines.append(text)

    def replace_in(self, monkeypatch: pytest.MonkeyPatch) -> None:
        for name in ("print_info", "print_warning"):
            monkeypatch.setattr(log_module, name, self.print_line)


def test_a_blocked_terminal_blocks_no_caller(monkeypatch: pytest.MonkeyPatch) -> None:
    terminal = Terminal()
    terminal.replace_in(monkeypatch)
    printer = LogPrinter()
    printer.start()
    printer.put(entry("first"))
    assert terminal.is_reached.wait(PATIENCE_S)
    for number in range(WAITING_LINES + 70):
        printer.put(entry(f"line {number}"))
    assert printer.dropped == 70
    terminal.goes_on.set()
    until(lambda: len(terminal.lines) == WAITING_LINES + 2)
    printer.close()
    assert terminal.lines[0] == "first"
    assert "70 lines dropped" in terminal.lines[1]


def test_text_from_the_wire_cannot_move_the_cursor(monkeypatch: pytest.MonkeyPatch) -> None:
    terminal = Terminal()
    terminal.goes_on.set()
    terminal.replace_in(monkeypatch)
    printer = LogPrinter()
    printer.start()
    printer.put(entry("a\x1b[2Jb\u202ec\nd"))
    printer.close()
    assert terminal.lines == ["a\\x1b[2Jb\\u202ec\\nd"]
