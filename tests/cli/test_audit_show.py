"""`recon audit show`: which of the entries are printed."""

from datetime import UTC, datetime, timedelta
from pathlib import Path

import pytest
from typer.testing import CliRunner

from recon.cli.audit import audit_app
from recon.record.audit.audit import AuditEntry
from recon.record.audit.audit_log import AuditLog

AGES_MIN = (300, 100, 30, 5)


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """An audit with entries some minutes old."""
    place = tmp_path_factory.mktemp("audit")
    now = datetime.now(UTC)
    ages_min = [AGES_MIN[0]]
    log = AuditLog(place, lambda: int((now - timedelta(minutes=ages_min[-1])).timestamp() * 1e9))
    log.start()
    for age_min in AGES_MIN:
        ages_min.append(age_min)
        log.put(AuditEntry("order.sent", f"{age_min} min ago"), 0)
    log.close()
    return place


def shown(folder: Path, *words: str) -> list[str]:
    ended = CliRunner().invoke(audit_app, ["show", str(folder), "--kind", "order.", *words])
    assert ended.exit_code == 0, ended.output
    return [line.rsplit("  ", 1)[1] for line in ended.output.splitlines()]


@pytest.mark.parametrize(
    ("words", "expected"),
    [
        ((), AGES_MIN),
        (("--since", "2h"), (100, 30, 5)),
        (("--since", "40min"), (30, 5)),
        (("--since", "1d", "--tail", "2"), (30, 5)),
        (("--tail", "1"), (5,)),
        (("--tail", "99"), AGES_MIN),
        (("--since", "1s"), ()),
    ],
)
def test_since_and_tail(folder: Path, words: tuple[str, ...], expected: tuple[int, ...]) -> None:
    assert shown(folder, *words) == [f"{age} min ago" for age in expected]


def test_since_a_time_in_another_zone(folder: Path) -> None:
    there = datetime.now(UTC).astimezone(None) - timedelta(minutes=40)
    assert shown(folder, "--since", there.isoformat()) == ["30 min ago", "5 min ago"]


@pytest.mark.parametrize("since", ["yesterday", "", "25:00", "2h30", "-5min"])
def test_an_unclear_time_is_refused(folder: Path, since: str) -> None:
    ended = CliRunner().invoke(audit_app, ["show", str(folder), f"--since={since}"])
    assert ended.exit_code == 2
    assert "expected 90min, 2h" in ended.output
