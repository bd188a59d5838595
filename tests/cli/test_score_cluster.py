"""`recon score --cluster`: the how-to's commands, with a scheduler and two workers of their own."""

import re
import shlex
import socket
import subprocess
import sys
from collections.abc import Iterator
from contextlib import ExitStack
from pathlib import Path
from time import monotonic, sleep

import pytest
from distributed import Client
from tests.score.scenes import BRIEF, written
from typer.testing import CliRunner

from recon.cli.commands import app

HOW_TO = Path(__file__).parents[2] / "docs" / "how-to" / "score-a-method.md"
BLOCK = re.compile(r"```\n(dask scheduler.*?)```", re.DOTALL)
PATIENCE_S = 120.0


@pytest.fixture(autouse=True)
def _kept_here(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("XDG_STATE_HOME", str(tmp_path / "state"))


@pytest.fixture
def address(tmp_path: Path) -> Iterator[str]:
    """A scheduler and two workers, started as the how-to shows it."""
    found = BLOCK.search(HOW_TO.read_text(encoding="utf-8"))
    assert found is not None
    commands = [shlex.split(line.partition("#")[0]) for line in found[1].splitlines()]
    *started, scored = commands
    assert [each[:2] for each in started] == [["dask", "scheduler"], *[["dask", "worker"]] * 2]
    assert scored[:2] == ["recon", "score"]
    assert scored[scored.index("--cluster") + 1] == "192.168.1.20:8786"
    port = free_port()
    here = f"127.0.0.1:{port}"
    with ExitStack() as stack:
        for words in started:
            local = [word.replace("192.168.1.20:8786", here) for word in words]
            local = [{"192.168.1.20": "127.0.0.1", "8786": str(port)}.get(w, w) for w in local]
            command = [sys.executable, "-m", "dask", *local[1:]]
            process = subprocess.Popen(
                command, cwd=tmp_path, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL
            )
            stack.callback(process.wait, PATIENCE_S)
            stack.callback(process.terminate)
            if words[1] == "scheduler":
                wait_for(port)
        with Client(here, timeout=PATIENCE_S) as client:
            client.wait_for_workers(2, timeout=PATIENCE_S)
        yield here


def free_port() -> int:
    with socket.socket() as one:
        one.bind(("127.0.0.1", 0))
        port: int = one.getsockname()[1]
        return port


def wait_for(port: int) -> None:
    until_s = monotonic() + PATIENCE_S
    while True:
        with socket.socket() as one:
            if one.connect_ex(("127.0.0.1", port)) == 0:
                return
        assert monotonic() < until_s, "no scheduler"
        sleep(0.1)


def test_a_cluster_flies_what_one_process_flies_to_the_byte(tmp_path: Path, address: str) -> None:
    path = str(written(tmp_path, BRIEF))
    command = ["score", path, "--seeds", "2", "--fresh"]
    spread = CliRunner().invoke(app, [*command, "--cluster", address])
    assert spread.exit_code == 0, spread.stderr
    here = CliRunner().invoke(app, [*command, "--jobs", "1"])
    assert spread.stdout_bytes == here.stdout_bytes
    assert "2 of 2 runs" in spread.stderr
