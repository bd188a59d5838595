"""The users of a running station follow their file; a file that cannot be used changes nothing."""

from dataclasses import dataclass, field
from pathlib import Path

import pytest
from tests.persons import user

from recon.api.login import Login
from recon.model.event import LoginRefused, UsersChanged
from recon.model.person import Role, User
from recon.record.files.users_file import change_users
from recon.site import default_site
from recon.station.audit.entries import Auditing, audit
from recon.station.host.users_watch import UsersWatch
from recon.station.kernel.build import first_state
from recon.station.kernel.step import step


@dataclass
class Bench:
    """A users file, and what its watch reported."""

    path: Path
    login: Login = field(default_factory=Login)
    reported: list[UsersChanged] = field(default_factory=list)

    def __post_init__(self) -> None:
        self.watch = UsersWatch(self.path, self.login, self.reported.append)

    def write(self, *users: User) -> None:
        change_users(self.path, lambda known: users)
        self.watch.read()


@pytest.fixture
def bench(tmp_path: Path) -> Bench:
    return Bench(tmp_path / "users.toml")


def test_each_change_is_reported_once(bench: Bench) -> None:
    bench.watch.read()
    assert bench.reported == []
    bench.write(user("anna", Role.PILOT, "1"), user("ben", Role.ADMIN, "2"))
    bench.watch.read()
    bench.write(user("anna", Role.OPERATOR, "3"))
    assert [each.change for each in bench.reported] == [
        "users: anna added as pilot; ben added as admin",
        "users: ben removed; anna is now operator; anna has a new token",
    ]
    assert [each.name for each in bench.login.users] == ["anna"]


def test_a_file_that_cannot_be_used_changes_nothing(bench: Bench) -> None:
    bench.write(user("anna"))
    bench.path.write_text("no users here")
    for _ in range(3):
        bench.watch.read()
    assert [each.name for each in bench.login.users] == ["anna"]
    assert len(bench.reported) == 2
    assert "expected users as" in (bench.reported[-1].problem or "")
    bench.path.unlink()
    bench.watch.read()
    assert [each.name for each in bench.login.users] == ["anna"]
    assert "is gone" in (bench.reported[-1].problem or "")
    bench.write(user("ben"))
    assert [each.name for each in bench.login.users] == ["ben"]


def test_the_last_user_can_be_removed(bench: Bench) -> None:
    bench.write(user("anna"))
    bench.write()
    assert bench.login.users == ()


def test_repeated_wrong_tokens_and_a_bad_file_are_alarms() -> None:
    station = first_state(default_site())
    once = LoginRefused("192.0.2.9", 1, is_repeated=False)
    station, _ = step(station, once, 1)
    assert not station.alarms.alarms
    events = (LoginRefused("192.0.2.9", 5, is_repeated=True), UsersChanged("", "file is damaged"))
    for event in (*events, *events):
        before = station
        station, _ = step(before, event, 2)
        _, entries = audit(Auditing(), before, event, station, 2)
        assert entries[0].kind in ("login.refused", "users.changed")
    texts = sorted(alarm.condition.text for alarm in station.alarms.alarms.values())
    assert len(texts) == 2
    assert texts[0].startswith("5 wrong tokens from 192.0.2.9 within a minute")
    assert texts[1] == "users stay as they were: file is damaged"
