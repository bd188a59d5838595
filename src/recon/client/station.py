"""A running station, as a program uses it."""

from types import TracebackType

from recon.client.address import parse_address
from recon.client.errors import StationUnreachableError, TookTooLongError
from recon.client.fleet import Fleet
from recon.client.life import Life
from recon.client.messages import StateMessage
from recon.client.order import VehicleAnswer
from recon.client.order_api import OrderDesk
from recon.client.surveys import Surveys
from recon.client.telemetry import Telemetry
from recon.client.vehicle import Vehicle
from recon.client.watched import Alarm, AuditPage, StopAnswer, StopMessage

OPEN_WITHIN_S = 5.0


class Station:
    """A connection to a station; use it by `async with`.

    Leaving it orders nothing: vehicles fly on.
    """

    def __init__(self, url: str, token: str | None = None, *, answer_within_s: float = 5.0) -> None:
        """Take a station's address; raises `AddressError`. Nothing is opened yet."""
        # Imported here: `recon hold --help` need not wait for the HTTP libraries.
        from recon.client.http import Http
        from recon.client.stream import Stream

        self.address = parse_address(url, token)
        self._stream = Stream(self.address)
        self._http = Http(self.address, answer_within_s)
        self._desk = OrderDesk(self._http, self._stream)
        self.fleet = Fleet(self._desk)
        self.surveys = Surveys(self._http)

    async def __aenter__(self) -> "Station":
        """Open the stream and wait for the first state; raises `ClientError`."""
        self._stream.start()
        try:
            first = await self._stream.after(0, OPEN_WITHIN_S)
        except BaseException:
            await self._close()
            raise
        if first is None:
            await self._close()
            raise StationUnreachableError(
                f"expected a station at {self.address.http}, got no state within "
                f"{OPEN_WITHIN_S:g} s ({self._stream.trouble}); start it with `recon run`, or "
                "check the address"
            )
        return self

    async def __aexit__(
        self,
        kind: type[BaseException] | None,
        problem: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        await self._close()

    async def vehicle(self, serial: str, timeout_s: float = 30.0) -> Vehicle:
        """Return a vehicle once it is connected and its telemetry live; `TookTooLongError`."""
        deadline_ns = self._stream.now_ns() + round(timeout_s * 1e9)
        seen = 0
        while (left_ns := deadline_ns - self._stream.now_ns()) > 0:
            heard = await self._stream.after(seen, left_ns / 1e9)
            if heard is None:
                break
            seen = heard.number
            told = heard.vehicle(serial)
            if told is not None and told.older_by(self._stream.age_s(heard)).is_connected:
                return Vehicle(serial, self._desk)
        known = ", ".join(v.serial for v in self.vehicles() if v.serial is not None) or "none"
        raise TookTooLongError(
            f"expected {serial} to be connected within {timeout_s:g} s; the station knows {known}: "
            "check the serial, and that its app is connected"
        )

    def known(self, serial: str) -> Vehicle:
        """Return a vehicle by its serial, heard or not; the station answers for what it knows."""
        return Vehicle(serial, self._desk)

    def vehicles(self) -> tuple[Telemetry, ...]:
        """Return all vehicles, also those without a serial, with ages as of now."""
        heard = self._stream.newest
        if heard is None:
            return ()
        age_s = self._stream.age_s(heard)
        return tuple(vehicle.older_by(age_s) for vehicle in heard.message.vehicles)

    async def all_stop(self) -> tuple[VehicleAnswer, ...]:
        """Hold everything that flies, with a serial or without. Never cuts motors."""
        return await self._desk.all_stop()

    async def all_stop_at_once(self) -> tuple[StopAnswer, ...]:
        """Hold everything that flies, by one request and nothing before it.

        Needs no stream, so no `async with`, and works while the station has no place for another
        reader; what becomes of each stop is told by `commands`. `close` afterwards.
        """
        message = await self._http.post(
            "/api/all-stop", None, StopMessage, "results of an all stop"
        )
        return message.results

    async def close(self) -> None:
        """Close the connection; `async with` does it by itself."""
        await self._close()

    async def commands(self) -> tuple[Life, ...]:
        """Return the latest orders and their lives, the newest first."""
        return (await self._state()).commands

    async def alarms(self) -> tuple[Alarm, ...]:
        """Return every alarm that is active or that nobody has seen yet."""
        return (await self._state()).alarms

    async def acknowledge(self, alarm_id: int) -> None:
        """Say that a person has seen an alarm; raises `RequestRefusedError` for none of these."""
        await self._http.tell(f"/api/alarms/{alarm_id}/acknowledge")

    async def switch_separation_hold(self, is_on: bool) -> None:
        """Switch on or off that vehicles in conflict are held; off, they only raise alarms."""
        await self._http.tell(f"/api/separation-hold/{'on' if is_on else 'off'}")

    async def audit(self, after: int = 0, at_most: int = 100) -> AuditPage:
        """Return entries of this run's audit after a number, the oldest first."""
        path = f"/api/audit?after={after}&at_most={at_most}"
        return await self._http.get(path, AuditPage, "a page of the audit")

    async def _state(self) -> StateMessage:
        return await self._http.get("/api/state", StateMessage, "a state")

    async def _close(self) -> None:
        await self._stream.stop()
        await self._http.close()
