"""`recon user`, and a station that other computers log in to (over loopback here)."""

import json
import re
import signal
import ssl
import subprocess
import sys
import urllib.error
import urllib.request
from pathlib import Path
from typing import Any

import pytest
from tests.cli.processes import PATIENCE_S, started

from recon.cli.audit import is_by
from recon.cli.qr import qr_lines
from recon.model.person import Role
from recon.record.files.users_file import read_users

SHARED = ("--link-port", "0", "--http-port", "0", "--https-host", "127.0.0.1", "--https-port", "0")


def recon(*words: object) -> tuple[int, str]:
    ended = subprocess.run(
        [sys.executable, "-m", "recon", *map(str, words)],
        capture_output=True,
        text=True,
        timeout=PATIENCE_S,
        check=False,
    )
    assert "Traceback" not in ended.stderr
    return ended.returncode, ended.stdout + ended.stderr


def token_in(text: str) -> str:
    found = re.search(r"token: (\S+)", text)
    assert found is not None
    return found.group(1)


def asked(url: str, token: str | None, path: str = "/api/state") -> Any:
    """Ask without checking the certificate; returns the status of a refusal."""
    context = ssl.SSLContext(ssl.PROTOCOL_TLS_CLIENT)
    context.check_hostname = False
    context.verify_mode = ssl.CERT_NONE
    headers = {} if token is None else {"Authorization": f"Bearer {token}"}
    request = urllib.request.Request(url + path, headers=headers)
    try:
        with urllib.request.urlopen(request, timeout=PATIENCE_S, context=context) as response:
            return json.load(response)
    except urllib.error.HTTPError as problem:
        return problem.code


def test_users_are_added_listed_renewed_and_removed(tmp_path: Path) -> None:
    file = tmp_path / "users.toml"
    code, text = recon("user", "add", "anna", "--role", "pilot", "--users", file)
    assert code == 0
    token = token_in(text)
    assert re.search(rf"open:  https://\S+:8443/#token={token}", text)
    assert token not in file.read_text()
    (anna,) = read_users(file)
    assert (anna.name, anna.role) == ("anna", Role.PILOT)

    code, text = recon("user", "add", "ANNA", "--role", "admin", "--users", file)
    assert (code, "exists" in text) == (2, True)
    at = ("--at", "https://station.example:9000/")
    code, text = recon("user", "renew", "anna", *at, "--users", file)
    assert code == 0
    assert f"https://station.example:9000/#token={token_in(text)}" in text
    assert token_in(text) != token
    assert read_users(file)[0].token_sha256 != anna.token_sha256

    assert "anna" in recon("user", "list", "--users", file)[1]
    code, text = recon("user", "remove", "bob", "--users", file)
    assert (code, "users: anna" in text) == (2, True)
    assert recon("user", "remove", "anna", "--users", file)[0] == 0
    assert "no users in" in recon("user", "list", "--users", file)[1]


@pytest.mark.parametrize("name", ["", "two words", "-x", "a" * 33, "ev\u0456l", "a\nb"])
def test_a_name_that_is_not_one_word_is_refused(name: str, tmp_path: Path) -> None:
    file = tmp_path / "users.toml"
    code, text = recon("user", "add", "--role", "pilot", "--users", file, "--", name)
    assert code != 0
    assert "name must be" in text
    assert not file.exists()


def test_other_computers_log_in_and_a_removed_user_is_out(tmp_path: Path) -> None:
    file = tmp_path / "users.toml"
    token = token_in(recon("user", "add", "anna", "--role", "pilot", "--users", file)[1])
    with started("run", *SHARED, "--users", str(file)) as station:
        plain = station.line_with("console: http://127.0.0.1:").partition(": ")[2]
        line = station.line_with("console for other computers")
        url = line.rpartition(" ")[2]
        assert url.startswith("https://127.0.0.1:")
        fingerprint = station.line_with("certificate SHA-256: ").rpartition(" ")[2]
        assert re.fullmatch(r"[0-9A-F]{2}(:[0-9A-F]{2}){31}", fingerprint)
        with urllib.request.urlopen(f"{plain}/api/state", timeout=PATIENCE_S) as response:
            assert json.load(response)["vehicles"] == []
        assert asked(url, None) == 401
        assert asked(url, "wrong") == 401
        assert asked(url, token)["vehicles"] == []
        station.line_with("logged in as pilot")
        assert recon("user", "remove", "anna", "--users", file)[0] == 0
        station.line_with("users: anna removed")
        assert asked(url, token) == 401
        assert station.end(signal.SIGTERM) == 0
    assert "Traceback" not in station.text
    assert token not in station.text


def test_a_users_file_that_cannot_be_used_stops_no_loopback_station(tmp_path: Path) -> None:
    file = tmp_path / "users.toml"
    file.write_text("not users")
    free = ("--link-port", "0", "--http-port", "0", "--users", str(file))
    with started("run", *free) as station:
        station.line_with("expected users as")
        station.line_with("console: http://127.0.0.1:")
        assert station.end(signal.SIGTERM) == 0
    with started("run", *SHARED, "--users", str(file)) as refused:
        assert refused.wait() != 0
        assert "expected users as" in refused.text
        assert "Traceback" not in refused.text


def test_a_qr_code_is_drawn_on_terminals_only() -> None:
    assert qr_lines("https://192.0.2.5:8443/#token=x", is_terminal=False) == []
    lines = qr_lines("https://192.0.2.5:8443/#token=" + 43 * "x", is_terminal=True)
    assert 15 < len(lines) < 40
    assert max(map(len, lines)) <= 80


@pytest.mark.parametrize("by", ["anna", "anna (192.0.2.7)", "anna (192.0.2.7): fleet return"])
def test_an_entry_is_a_persons_with_or_without_the_address(by: str) -> None:
    assert is_by(by, "anna")
    assert is_by(by, by)
    assert not is_by(by, "ann")
    assert not is_by(by, "192.0.2.7")
