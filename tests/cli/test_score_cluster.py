"""`recon score --cluster`: the same to the byte, though a worker is lost and the command killed."""

import signal
import socket
import subprocess
import sys
from collections.abc import Iterator
from contextlib import ExitStack
from pathlib import Path
from time import monotonic, sleep

import pytest
from tests.cli.processes import started
from tests.score.scenes import BRIEF, written
from typer.testing import CliRunner

from recon.cli.commands import app

PATIENCE_S = 120.0
SEEDS = 8


class Cluster:
    """A scheduler and two workers of one core each, on this computer."""

    def __init__(self, folder: Path, stack: ExitStack) -> None:
        with socket.socket() as one:
            one.bind(("127.0.0.1", 0))
            self.address = f"127.0.0.1:{one.getsockname()[1]}"
        self._folder, self._stack = folder, stack
        host, _, port = self.address.partition(":")
        self._start("scheduler", "--host", host, "--port", port)
        until_s = monotonic() + PATIENCE_S
        while not _answers(host, int(port)):
            assert monotonic() < until_s, "no scheduler"
            sleep(0.1)
        self.workers = [
            self._start("worker", self.address, "--nthreads", "1", "--no-nanny") for _ in range(2)
        ]

    def _start(self, *words: str) -> subprocess.Popen[bytes]:
        command = [sys.executable, "-m", "dask", *words, "--no-dashboard"]
        quiet = subprocess.DEVNULL
        process = subprocess.Popen(command, cwd=self._folder, stdout=quiet, stderr=quiet)
        self._stack.callback(process.wait, PATIENCE_S)
        self._stack.callback(process.kill)
        return process


def _answers(host: str, port: int) -> bool:
    with socket.socket() as one:
        return one.connect_ex((host, port)) == 0


@pytest.fixture
def cluster(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Cluster]:
    monkeypatch.setenv("XDG_STATE_HOME", str(tmp_path / "state"))
    with ExitStack() as stack:
        yield Cluster(tmp_path, stack)


@pytest.mark.flight
def test_a_lost_worker_and_a_killed_command_change_no_byte(
    cluster: Cluster, tmp_path: Path
) -> None:
    path = str(written(tmp_path, BRIEF))
    command = ["score", path, "--seeds", str(SEEDS), "--cluster", cluster.address]
    with started(*command) as running:
        running.line_with(f"1 of {SEEDS} runs")
        cluster.workers[0].kill()  # in the middle of its next run
        running.line_with(f"3 of {SEEDS} runs")
        running.end(signal.SIGKILL)
    resumed = CliRunner().invoke(app, command)
    assert resumed.exit_code == 0, resumed.stderr
    assert f"of {SEEDS} runs were flown before" in resumed.stderr
    alone = CliRunner().invoke(
        app, ["score", path, "--seeds", str(SEEDS), "--fresh", "--jobs", "1"]
    )
    assert resumed.stdout_bytes == alone.stdout_bytes
    assert f"; {SEEDS} seeds" in alone.stdout


def test_without_a_scheduler_it_is_a_sentence(tmp_path: Path) -> None:
    path = str(written(tmp_path, BRIEF))
    command = ["score", path, "--seeds", "1", "--fresh", "--cluster", "tcp://127.0.0.1:x"]
    done = CliRunner().invoke(app, command)
    assert done.exit_code == 2
    assert "expected a Dask scheduler at tcp://127.0.0.1:x, got" in done.stderr
