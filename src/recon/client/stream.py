"""The stream of states, read in the background: only the newest one is kept.

Reading is not ordering: a stream that breaks off is opened again by itself, and the gap is seen by
the ages. What no second attempt can mend (a token, a foreign server) ends the reading for good.
"""

import asyncio
import time
from collections.abc import AsyncIterator, Callable
from contextlib import asynccontextmanager, suppress
from dataclasses import dataclass
from secrets import token_urlsafe

from websockets.asyncio.client import ClientConnection, connect
from websockets.exceptions import ConnectionClosed, InvalidStatus, WebSocketException

from recon.client.address import Address
from recon.client.errors import BadAnswerError, ClientError, RequestRefusedError
from recon.client.messages import StateMessage, decode
from recon.client.stream_clock import StreamClock
from recon.client.telemetry import Telemetry
from recon.model.units import ns_to_seconds

LONGEST_STATE_BYTES = 16 * 1024 * 1024
"""256 vehicles with their tracks take 2 MiB."""

SILENT_CONNECTION_S = 5.0
"""Ten states come each second; a connection without one for so long is dead, however open."""

BEAT_S = 0.5
"""The station gives a owner up after two seconds of silence."""

FIRST_PAUSE_S = 0.2
LONGEST_PAUSE_S = 2.0
_TOO_BIG = 1009


@dataclass(frozen=True, slots=True)
class Heard:
    """A state and when it was made, by this computer's monotonic clock."""

    number: int
    made_at_ns: int
    message: StateMessage

    def vehicle(self, serial: str) -> Telemetry | None:
        """Return one vehicle as the message tells of it."""
        return next((v for v in self.message.vehicles if v.serial == serial), None)


class Stream:
    """Reads states until stopped; any number of tasks may wait for the next one."""

    def __init__(self, address: Address, now_ns: Callable[[], int] = time.monotonic_ns) -> None:
        self.now_ns = now_ns
        self.newest: Heard | None = None
        self.owner: str | None = None
        """The name by which the present connection holds steered orders; each has its own."""
        self.trouble = "it has not answered yet"
        """Why nothing comes at present, for people."""
        self._address = address
        self._clock = StreamClock()
        self._failure: ClientError | None = None
        self._changed = asyncio.Event()
        self._reading: asyncio.Task[None] | None = None

    def start(self) -> None:
        """Begin to read."""
        self._reading = asyncio.create_task(self._read_on())

    async def stop(self) -> None:
        """End the reading and wait for its end."""
        if self._reading is not None:
            self._reading.cancel()
            await asyncio.wait((self._reading,))
            if not self._reading.cancelled():
                self._reading.result()

    async def after(self, number: int, patience_s: float) -> Heard | None:
        """Return the newest state once it is newer than this one; None when none came in time.

        Raises the `ClientError` that ended the reading for good.
        """
        with suppress(TimeoutError):
            async with asyncio.timeout(patience_s):
                while self.newest is None or self.newest.number <= number:
                    if self._failure is not None:
                        raise self._failure
                    await self._changed.wait()
                return self.newest
        return None

    def age_s(self, heard: Heard) -> float:
        """Return how long ago a state was made."""
        return ns_to_seconds(max(0, self.now_ns() - heard.made_at_ns))

    async def _read_on(self) -> None:
        pause_s = FIRST_PAUSE_S
        while True:
            before = self.newest
            try:
                await self._read_connection()
            except (BadAnswerError, RequestRefusedError) as problem:
                self._failure = problem
                self._wake()
                return
            except TimeoutError:
                self.trouble = f"it is silent for {SILENT_CONNECTION_S:g} s"
            except (OSError, WebSocketException) as problem:
                self.trouble = str(problem)
            pause_s = FIRST_PAUSE_S if before is not self.newest else 2.0 * pause_s
            await asyncio.sleep(min(pause_s, LONGEST_PAUSE_S))

    async def _read_connection(self) -> None:
        owner = token_urlsafe(24)
        try:
            async with _open(self._address, owner) as connection, _beating(connection):
                self.owner = owner
                await self._read(connection)
        except InvalidStatus as problem:
            status = problem.response.status_code
            if status >= 500:
                raise
            raise RequestRefusedError(
                f"{self._address.http} refused the stream (HTTP {status}): expected the station's "
                "own host name, its token if it has one, and fewer than 32 readers; check the "
                "address, and give the token"
            ) from problem
        except ConnectionClosed as problem:
            if problem.sent is not None and problem.sent.code == _TOO_BIG:
                raise BadAnswerError(
                    f"expected a state of up to {LONGEST_STATE_BYTES} bytes, got a longer one: is "
                    "this a Recon station?"
                ) from problem
            raise
        finally:
            self.owner = None

    async def _read(self, connection: ClientConnection) -> None:
        while True:
            async with asyncio.timeout(SILENT_CONNECTION_S):
                data = await connection.recv()
            self._take(decode(data, StateMessage, "a state"))

    def _take(self, message: StateMessage) -> None:
        made_at_ns = self._clock.made_at_ns(message.time_ns, message.run_started_ns, self.now_ns())
        number = 1 if self.newest is None else self.newest.number + 1
        self.newest = Heard(number, made_at_ns, message)
        self._wake()

    def _wake(self) -> None:
        """Wake all who wait; who comes later waits for the next change."""
        self._changed.set()
        self._changed = asyncio.Event()


class _Straight(connect):
    """Follows no redirect: the token is for the station alone."""

    def process_redirect(self, exc: Exception) -> Exception | str:
        """Return the answer itself as the error."""
        return exc


@asynccontextmanager
async def _beating(connection: ClientConnection) -> AsyncIterator[None]:
    """Say twice a second that this program lives.

    The beats come from the program's own event loop: one that hangs stops them, and what it holds
    is stopped by the station.
    """

    async def beat() -> None:
        with suppress(ConnectionClosed):
            while True:
                await connection.send("")
                await asyncio.sleep(BEAT_S)

    beats = asyncio.create_task(beat())
    try:
        yield
    finally:
        beats.cancel()


def _open(address: Address, owner: str) -> connect:
    return _Straight(
        f"{address.stream}?owner={owner}",
        additional_headers=address.headers,
        compression=None,
        proxy=None,
        max_size=LONGEST_STATE_BYTES,
        max_queue=2,
        open_timeout=SILENT_CONNECTION_S,
        ping_interval=None,
        close_timeout=1.0,
    )
