"""All stop at a station's guard, when the station does not answer (`recon all-stop`)."""

import getpass
import json
from http.client import HTTPConnection, HTTPException
from urllib.parse import urlsplit

from recon.cli.output import Outcome

STATION_ANSWERS_WITHIN_S = 1.0
"""A station that runs answers within some tens of milliseconds."""
GUARD_ANSWERS_WITHIN_S = 5.0
MOST_BYTES = 64 * 1024
LOOPBACK = ("127.0.0.1", "localhost", "::1")
HELD = "hover sent by its guard; the station does not answer"
MISSED = "nothing recent shows it in flight, and the station does not answer: use its controller"


def guard_port_of(address: str) -> int | None:
    """Return the default port of the guard of a station on this computer; None: not here."""
    parts = urlsplit(address)
    try:
        port = parts.port
    except ValueError:
        return None
    return port + 1 if parts.hostname in LOOPBACK and port is not None else None


def stop_all_at_guard(port: int) -> list[Outcome] | None:
    """Hold every vehicle at a guard; None when there is no guard at this port."""
    connection = HTTPConnection("127.0.0.1", port, timeout=GUARD_ANSWERS_WITHIN_S)
    try:
        connection.request("POST", "/all-stop", json.dumps({"by": getpass.getuser()}))
        answer = json.loads(connection.getresponse().read(MOST_BYTES))
        held = [Outcome(None, None, str(name), True, False, note=HELD) for name in answer["held"]]
        return held + [
            Outcome(None, None, str(name), False, False, rule="flying", note=MISSED)
            for name in answer["refused"]
        ]
    except (OSError, ValueError, KeyError, TypeError, HTTPException):
        return None
    finally:
        connection.close()
