"""HOST:PORT on the command line."""

from recon.sim.errors import SimulationError


def parse_place(option: str, text: str, lowest_port: int = 1) -> tuple[str, int]:
    """Return host and port of `HOST:PORT` ([..] around an IPv6 address); `SimulationError`."""
    host, colon, port = text.rpartition(":")
    host = host.removeprefix("[").removesuffix("]")
    is_number = port.isascii() and port.isdigit()
    if not (colon and host and is_number and lowest_port <= int(port) < 65_536):
        raise SimulationError(f"{option}: expected HOST:PORT like 127.0.0.1:3001, got {text!r}")
    return host, int(port)
