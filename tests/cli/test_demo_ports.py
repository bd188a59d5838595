"""A demonstration takes the usual port, or says which other one."""

import socket
from contextlib import closing

import pytest
from typer.testing import CliRunner

from recon.cli.commands import app
from recon.cli.demo_ports import HOST, free_port


def test_a_taken_port_gives_the_next_free_one(capsys: pytest.CaptureFixture[str]) -> None:
    with closing(socket.create_server((HOST, 0))) as taken:
        port = int(taken.getsockname()[1])
        found = free_port(port, "the console is")
        assert found > port
        assert capsys.readouterr().out == f"port {port} is taken: the console is at port {found}\n"
        # The port behind it is the guard's.
        before = free_port(port - 1, "the console is", together=2)
        assert before > port
    capsys.readouterr()
    assert free_port(port, "the console is") == port
    assert capsys.readouterr().out == ""


@pytest.mark.parametrize("command", ["run", "demo"])
def test_the_guards_port_is_not_taken_for_apps(command: str) -> None:
    words = [command, "--http-port", "18610", "--link-port", "18611"]
    result = CliRunner().invoke(app, words)
    assert "expected different ports for companion apps and the guard, got 18611" in result.output
    assert "Traceback" not in result.output
    assert result.exit_code != 0
