"""Network addresses as options take them."""

from recon.model.errors import ReconError


def host_and_port(option: str, text: str, lowest_port: int = 1) -> tuple[str, int]:
    """Return host and port of `HOST:PORT` ([..] around an IPv6 address); raises `ReconError`."""
    host, colon, port = text.rpartition(":")
    host = host.removeprefix("[").removesuffix("]")
    is_number = port.isascii() and port.isdigit()
    if not (colon and host and is_number and lowest_port <= int(port) < 65_536):
        raise ReconError(f"{option}: expected HOST:PORT like 127.0.0.1:3001, got {text[:80]!r}")
    return host, int(port)
