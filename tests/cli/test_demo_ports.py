"""A demonstration takes the usual port, or says which other one."""

import socket
from contextlib import closing

import pytest

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
