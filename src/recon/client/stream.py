"""The stream of states, read in the background; only the newest state is kept.

    connecting --handshake--> reading --closed, or silent for 5 s--> waiting --pause--> connecting
    connecting or reading --wrong token or certificate, not a station--> failed, for good

The pause starts at 0.2 s, doubles with each attempt up to 2 s, and starts over after a received
state. The gap shows in the ages of the values. A lost stream is reopened without the caller, orders
are never repeated. Each connection has a new random owner name: steered orders depend on the
connection they were sent under, and one that opens later does not hold earlier orders.

Received states may be old: a busy program leaves messages in the socket's buffers. `StreamClock`
estimates when each was created.
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
from recon.client.errors import (
    LOGIN_ADVICE,
    BadAnswerError,
    CertificateError,
    ClientError,
    RequestRefusedError,
)
from recon.client.messages import ReceivedState, StateMessage, decode
from recon.client.trust import CertificateTrust, is_untrusted
from recon.model.units import NS_PER_S, ns_to_seconds

LONGEST_STATE_BYTES = 16 * 1024 * 1024
"""256 vehicles with their tracks take 2 MiB."""

SILENT_CONNECTION_S = 5.0
"""The station sends ten states a second; a connection without one for this long is lost."""

KEEPALIVE_S = 0.5
"""The station stops steered orders after 2 s without a keepalive."""

FIRST_PAUSE_S = 0.2
LONGEST_PAUSE_S = 2.0
_TOO_BIG = 1009
_LOGIN_NEEDED = 4401
_REFUSED = (1008, 1013, _LOGIN_NEEDED)
"""Invalid, too many readers, and login needed."""


WINDOW_NS = 60 * NS_PER_S
"""Clocks drift by about 50 ppm: 6 ms in two windows, which is acceptable for an age."""


@dataclass(slots=True)
class StreamClock:
    """Converts station time to this computer's monotonic time.

    The fastest message of the last one or two windows gives the offset between the clocks; longer
    delays than its own are delays on the network or in buffers.
    """

    _run_started_ns: int | None = None
    _window_began_ns: int = 0
    _least_ns: int = 0
    _least_before_ns: int = 0

    def created_at_ns(self, time_ns: int, run_started_ns: int, arrived_at_ns: int) -> int:
        """Return when a message with station time `time_ns` was created, at latest its arrival."""
        offset_ns = arrived_at_ns - time_ns
        if run_started_ns != self._run_started_ns:
            self._run_started_ns = run_started_ns
            self._window_began_ns = arrived_at_ns
            self._least_ns = self._least_before_ns = offset_ns
        elif arrived_at_ns - self._window_began_ns > WINDOW_NS:
            self._window_began_ns = arrived_at_ns
            self._least_before_ns, self._least_ns = self._least_ns, offset_ns
        self._least_ns = min(self._least_ns, offset_ns)
        return time_ns + min(self._least_ns, self._least_before_ns)


class Stream:
    """Reads states until stopped; any number of tasks can wait for the next one."""

    def __init__(
        self,
        address: Address,
        now_ns: Callable[[], int] | None = None,
        trust: CertificateTrust | None = None,
        *,
        is_operator: bool = True,
    ) -> None:
        """`is_operator`: steered orders may depend on it, and it counts as somebody present."""
        self._is_operator = is_operator
        self._connection: ClientConnection | None = None
        self.now_ns = now_ns or time.monotonic_ns
        self.newest: ReceivedState | None = None
        self.owner: str | None = None
        """Owner name of the current connection, which steered orders depend on."""
        self.trouble = "no answer yet"
        """Why no state is arriving, for error texts."""
        self._address = address
        self._trust = trust or CertificateTrust(address)
        self._clock = StreamClock()
        self._failure: ClientError | None = None
        self._changed = asyncio.Event()
        self._reading: asyncio.Task[None] | None = None

    def start(self) -> None:
        """Start reading in the background."""
        self._reading = asyncio.create_task(self._read_on())

    async def stop(self) -> None:
        """Stop reading and wait until it has stopped."""
        if self._reading is not None:
            self._reading.cancel()
            await asyncio.wait((self._reading,))
            if not self._reading.cancelled():
                self._reading.result()

    async def act_as_operator(self, is_operator: bool) -> None:
        """Open the stream anew as an operator's, or as one that only reads; steered orders end."""
        if is_operator != self._is_operator:
            self._is_operator = is_operator
            if self._connection is not None:
                await self._connection.close()

    async def after(self, number: int, timeout_s: float) -> ReceivedState | None:
        """Return the newest state once its number is larger than `number`; None on timeout.

        Raises the `ClientError` that ended reading.
        """
        with suppress(TimeoutError):
            async with asyncio.timeout(timeout_s):
                while self.newest is None or self.newest.number <= number:
                    if self._failure is not None:
                        raise self._failure
                    await self._changed.wait()
                return self.newest
        return None

    def age_s(self, state: ReceivedState) -> float:
        """Return the time since a state was created, seconds."""
        return ns_to_seconds(max(0, self.now_ns() - state.created_at_ns))

    async def _read_on(self) -> None:
        pause_s = FIRST_PAUSE_S
        while True:
            before = self.newest
            try:
                await self._read_connection()
            except (BadAnswerError, RequestRefusedError, CertificateError) as problem:
                self._fail(problem)
                return
            except TimeoutError:
                self.trouble = f"no state for {SILENT_CONNECTION_S:g} s"
            except (OSError, WebSocketException) as problem:
                if is_untrusted(problem):
                    self._fail(self._trust.untrusted())
                    return
                self.trouble = str(problem)
            pause_s = FIRST_PAUSE_S if before is not self.newest else 2.0 * pause_s
            await asyncio.sleep(min(pause_s, LONGEST_PAUSE_S))

    async def _read_connection(self) -> None:
        owner = token_urlsafe(24) if self._is_operator else None
        await self._trust.prepare()
        try:
            async with (
                _open(self._address, self._trust, owner) as connection,
                _keepalives(connection),
            ):
                self.owner, self._connection = owner, connection
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
            if problem.rcvd is not None and problem.rcvd.code in _REFUSED:
                advice = f"; {LOGIN_ADVICE}" if problem.rcvd.code == _LOGIN_NEEDED else ""
                raise RequestRefusedError(
                    f"{self._address.http} refused the stream: {problem.rcvd.reason}{advice}"
                ) from problem
            if problem.sent is not None and problem.sent.code == _TOO_BIG:
                raise BadAnswerError(
                    f"expected a state of up to {LONGEST_STATE_BYTES} bytes, got a longer one: is "
                    "this a Recon station?"
                ) from problem
            raise
        finally:
            self.owner = self._connection = None

    async def _read(self, connection: ClientConnection) -> None:
        while True:
            async with asyncio.timeout(SILENT_CONNECTION_S):
                data = await connection.recv()
            self._receive(decode(data, StateMessage, "a state"))

    def _receive(self, message: StateMessage) -> None:
        created_at_ns = self._clock.created_at_ns(
            message.time_ns, message.run_started_ns, self.now_ns()
        )
        number = 1 if self.newest is None else self.newest.number + 1
        self.newest = ReceivedState(number, created_at_ns, message)
        self._wake()

    def _fail(self, problem: ClientError) -> None:
        self._failure = problem
        self._wake()

    def _wake(self) -> None:
        """Wake all waiting tasks; later ones wait for the next change."""
        self._changed.set()
        self._changed = asyncio.Event()


class _ConnectWithoutRedirect(connect):
    """Follows no redirect: the token is for the station only."""

    def process_redirect(self, exc: Exception) -> Exception | str:
        """Return the redirect as the error."""
        return exc


@asynccontextmanager
async def _keepalives(connection: ClientConnection) -> AsyncIterator[None]:
    """Send a keepalive twice a second.

    Keepalives run on the program's event loop: when it hangs they stop, and the station stops the
    program's steered orders.
    """

    async def send() -> None:
        with suppress(ConnectionClosed):
            while True:
                await connection.send("")
                await asyncio.sleep(KEEPALIVE_S)

    task = asyncio.create_task(send())
    try:
        yield
    finally:
        task.cancel()


def _open(address: Address, trust: CertificateTrust, owner: str | None) -> connect:
    return _ConnectWithoutRedirect(
        address.stream if owner is None else f"{address.stream}?owner={owner}",
        additional_headers=address.headers,
        ssl=trust.context if address.is_secure else None,
        compression=None,
        proxy=None,
        max_size=LONGEST_STATE_BYTES,
        max_queue=2,
        open_timeout=SILENT_CONNECTION_S,
        ping_interval=None,
        close_timeout=1.0,
    )
