"""Ports of a demonstration: the usual ones, or the next that are free."""

import socket
from contextlib import closing

from recon.cli.foreground import print_now

HOST = "127.0.0.1"
MOST_TRIED = 100


def free_port(usual: int, what: str, *, together: int = 1) -> int:
    """Return the usual port, or the next free one and say so.

    `together` is how many ports from there on must be free. Without a free one near it is the
    usual port: the error of listening on it says what to do.
    """
    found = next(
        (
            port
            for port in range(usual, usual + MOST_TRIED)
            if all(_is_free(each) for each in range(port, port + together))
        ),
        usual,
    )
    if found != usual:
        print_now(f"port {usual} is taken: {what} at port {found}")
    return found


def _is_free(port: int) -> bool:
    with closing(socket.socket(socket.AF_INET, socket.SOCK_STREAM)) as sock:
        # As a server binds it: a port whose connections have just ended is free.
        sock.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        try:
            sock.bind((HOST, port))
            sock.listen(1)
        except OSError:
            return False
    return True
