"""A connection to a running station, and commands to its whole fleet."""

from collections.abc import Sequence
from types import TracebackType

from recon.client.address import parse_address
from recon.client.errors import StationUnreachableError, WaitTimeoutError
from recon.client.messages import (
    AlarmStatus,
    AnswerMessage,
    AuditLogPage,
    ImagerReliefStatus,
    LinkStatus,
    MoveUpwindStatus,
    OrderMessage,
    OrderStatus,
    ReceivedState,
    ResultMessage,
    SideStepStatus,
    StateMessage,
    StopLatchStatus,
    VehicleReturn,
)
from recon.client.order import Order, OrderApi, VehicleAnswer
from recon.client.pictures import PictureCommands
from recon.client.site import SiteCommands
from recon.client.surveys import SurveyCommands
from recon.client.telemetry import Telemetry
from recon.client.vehicle import Vehicle
from recon.client.zones import ZoneCommands
from recon.model.command import Body, Hover, LandNow, Refusal, ReturnHome

OPEN_WITHIN_S = 5.0


class Station:
    """A connection to a station; use it with `async with`.

    Leaving the block sends no order: vehicles fly on.
    """

    def __init__(
        self,
        url: str,
        token: str | None = None,
        *,
        fingerprint: str | None = None,
        answer_within_s: float = 5.0,
        is_operator: bool = True,
    ) -> None:
        """Parse a station's address; raises `AddressError`. Opens nothing yet.

        A program that nobody sits at is no operator (`is_operator`): its connection does not count
        as somebody present, and it can give no steered orders.

        `fingerprint` is the SHA-256 of the certificate of an `https` address, as the station
        prints it; without one the certificate must be of an authority that this computer trusts.
        """
        # Imported here: `recon hold --help` need not wait for the HTTP libraries.
        from recon.client.http import Http
        from recon.client.stream import Stream
        from recon.client.trust import CertificateTrust

        self.address = parse_address(url, token, fingerprint)
        trust = CertificateTrust(self.address)
        self._stream = Stream(self.address, trust=trust, is_operator=is_operator)
        self._http = Http(self.address, answer_within_s, trust)
        self._order_api = OrderApi(self._http, self._stream)
        self.fleet = FleetCommands(self._order_api)
        self.zones = ZoneCommands(self._http)
        self.pictures = PictureCommands(self._http)
        self.site = SiteCommands(self._http)
        self.surveys = SurveyCommands(self._http, self._order_api.station_time_ms)

    async def __aenter__(self) -> "Station":
        """Open the stream and wait for the first state; raises `ClientError`."""
        self._stream.start()
        try:
            first = await self._stream.after(0, OPEN_WITHIN_S)
        except BaseException:
            await self.close()
            raise
        if first is None:
            await self.close()
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
        await self.close()

    async def act_as_operator(self, is_operator: bool) -> None:
        """Count as an operator from now on, or no longer: steered orders of before end."""
        await self._stream.act_as_operator(is_operator)

    async def next_state(self, number: int, timeout_s: float) -> tuple[ReceivedState, float] | None:
        """Return the first whole state after a number, and its age in seconds; None on timeout."""
        state = await self._stream.after(number, timeout_s)
        return None if state is None else (state, self._stream.age_s(state))

    @property
    def takes_steered_orders(self) -> bool:
        """Whether the stream that steered orders depend on is open."""
        return self._stream.owner is not None

    async def vehicle(self, serial: str, timeout_s: float = 30.0) -> Vehicle:
        """Return a vehicle once it is connected with live telemetry.

        Raises `WaitTimeoutError`.
        """
        deadline_ns = self._stream.now_ns() + round(timeout_s * 1e9)
        number = 0
        while (left_ns := deadline_ns - self._stream.now_ns()) > 0:
            state = await self._stream.after(number, left_ns / 1e9)
            if state is None:
                break
            number = state.number
            telemetry = state.vehicle(serial)
            age_s = self._stream.age_s(state)
            if telemetry is not None and telemetry.older_by(age_s).is_connected:
                return Vehicle(serial, self._order_api)
        known = ", ".join(v.serial for v in self.vehicles() if v.serial is not None) or "none"
        raise WaitTimeoutError(
            f"expected {serial} to be connected within {timeout_s:g} s; the station knows {known}: "
            "check the serial number, and that its app is connected"
        )

    async def order(self, serial: str, body: Body, *, takeoff: bool = False) -> Order | Refusal:
        """Send one order to one vehicle, as the methods of `Vehicle` do; raises as they do."""
        return await self._order_api.send_one(serial, body, takeoff)

    def known(self, serial: str) -> Vehicle:
        """Return a vehicle by its serial number without waiting for a connection."""
        return Vehicle(serial, self._order_api)

    def vehicles(self) -> tuple[Telemetry, ...]:
        """Return all vehicles, including unidentified ones, with ages as of now."""
        state = self._stream.newest
        if state is None:
            return ()
        age_s = self._stream.age_s(state)
        return tuple(vehicle.older_by(age_s) for vehicle in state.message.vehicles)

    async def all_stop(self) -> tuple[VehicleAnswer, ...]:
        """Hold all flying vehicles, identified or not. Never stops motors.

        Until `release_stop` the station sends nothing that moves a vehicle.
        """
        return await self._order_api.all_stop()

    async def release_stop(self, serials: Sequence[str] | None = None) -> Refusal | None:
        """Release vehicles from the all stop in force, or all; None on success.

        Nothing is sent to them, and nothing resumes: order what they are to do.
        """
        return await self._order_api.release_stop(serials)

    async def stop_in_force(self) -> StopLatchStatus | None:
        """Return the all stop in force; None without one."""
        return (await self._state()).stop_latch

    async def side_step(self, serial: str | None = None) -> Refusal | None:
        """Have an imaging drone fly 25 m aside and back; None on success.

        By default the one whose light is unknown, or the site's first. It continues after the call;
        `side_stepping` has the progress, a hold stops it.
        """
        request = {"serial": serial, "given_at_unix_ms": self._order_api.station_time_ms()}
        answer = await self._http.post(
            "/api/side-step", request, AnswerMessage, "an answer to a side-step"
        )
        return answer.refusal

    async def side_stepping(self) -> SideStepStatus | None:
        """Return the newest side-step; None before the first."""
        return (await self._state()).side_step

    async def relieve(
        self, serial: str, spare: str | None = None, *, takeoff: bool = False
    ) -> Refusal | None:
        """Have an imaging drone take the place of another; None on success.

        By default the same one returns to its own place. `takeoff` allows it to leave the ground.
        It continues after the call; `relieving` has the progress, a hold stops it.
        """
        request = {
            "serial": serial,
            "spare": spare,
            "takeoff": takeoff,
            "given_at_unix_ms": self._order_api.station_time_ms(),
        }
        answer = await self._http.post(
            "/api/imager-relief", request, AnswerMessage, "an answer to a relief"
        )
        return answer.refusal

    async def relieving(self) -> ImagerReliefStatus | None:
        """Return the newest relief of an imaging drone; None before the first."""
        return (await self._state()).imager_relief

    async def moving_upwind(self) -> MoveUpwindStatus | None:
        """Return the newest move upwind for a survey that allows it; None before the first."""
        return (await self._state()).move_upwind

    async def waiting_apps(self) -> tuple[LinkStatus, ...] | None:
        """Return the links whose app waits to be admitted; None: the station has no list."""
        state = await self._state()
        if state.station.apps_listed is None:
            return None
        return tuple(link for link in state.links if link.waiting is not None)

    async def admit_app(
        self,
        link_id: int,
        serial: str,
        *,
        is_for_good: bool = True,
        any_address: bool = False,
    ) -> Refusal | None:
        """Admit the app that waits on a link as the vehicle with this serial; None on success."""
        lasting = "always" if is_for_good else "session"
        request = {
            "link_id": link_id,
            "serial": serial,
            "lasting": lasting,
            "any_address": any_address,
        }
        return await self._decide("/api/apps/admit", request)

    async def refuse_app(self, link_id: int) -> Refusal | None:
        """Refuse the app that waits on a link, for 5 minutes; None on success."""
        return await self._decide("/api/apps/refuse", {"link_id": link_id})

    async def _decide(self, path: str, request: dict[str, object]) -> Refusal | None:
        answer = await self._http.post(path, request, AnswerMessage, "an answer about an app")
        return answer.refusal

    async def all_stop_at_once(self) -> tuple[ResultMessage, ...]:
        """Hold all flying vehicles with a single request.

        Needs no stream and so no `async with`, and works while the station accepts no further
        readers. Results appear in `commands`; call `close` afterwards.
        """
        message = await self._http.post(
            "/api/all-stop", None, OrderMessage, "results of an all stop"
        )
        return message.results

    async def close(self) -> None:
        """Close the connection; `async with` calls this."""
        await self._stream.stop()
        await self._http.close()

    async def commands(self) -> tuple[OrderStatus, ...]:
        """Return the status of the latest orders, newest first."""
        return (await self._state()).commands

    async def alarms(self) -> tuple[AlarmStatus, ...]:
        """Return all alarms that are active or not acknowledged yet."""
        return (await self._state()).alarms

    async def acknowledge(self, alarm_id: int) -> None:
        """Acknowledge an alarm; raises `RequestRefusedError` for an unknown id."""
        await self._http.post_without_result(f"/api/alarms/{alarm_id}/acknowledge")

    async def switch_separation_hold(self, is_on: bool) -> None:
        """Switch the separation hold; while off, conflicts only raise alarms."""
        await self._http.post_without_result(f"/api/separation-hold/{'on' if is_on else 'off'}")

    async def audit(self, after: int = 0, at_most: int = 100) -> AuditLogPage:
        """Return entries of this run's audit log after a number, oldest first."""
        path = f"/api/audit?after={after}&at_most={at_most}"
        return await self._http.get(path, AuditLogPage, "a page of the audit log")

    async def _state(self) -> StateMessage:
        return await self._http.get("/api/state", StateMessage, "a state")


class FleetCommands:
    """Orders to all identified vehicles at the time of the order.

    `Station.all_stop` also reaches unidentified ones.
    """

    def __init__(self, order_api: OrderApi) -> None:
        self._order_api = order_api

    async def hold(self, serials: Sequence[str] | None = None) -> tuple[VehicleAnswer, ...]:
        """Stop and hold all vehicles, or those named."""
        return await self._send(Hover(), serials)

    async def land(self, serials: Sequence[str] | None = None) -> tuple[VehicleAnswer, ...]:
        """Land all vehicles at their current positions, or those named."""
        return await self._send(LandNow(), serials)

    async def return_home(self, serials: Sequence[str] | None = None) -> tuple[VehicleAnswer, ...]:
        """Return all vehicles at once, or those named, each at the aircraft's go-home height."""
        return await self._send(ReturnHome(), serials)

    async def return_in_layers(
        self, serials: Sequence[str] | None = None
    ) -> tuple[VehicleAnswer, ...]:
        """Return vehicles at separate heights, one at a time per pad.

        None means all vehicles that fly or may fly. Each answer is the initial hold; `returning`
        has the progress after that.
        """
        return await self._order_api.fleet_return(serials)

    async def returning(self) -> tuple[VehicleReturn, ...]:
        """Return the progress of each vehicle in the newest return in layers."""
        state = await self._order_api.http.get("/api/state", StateMessage, "a state")
        return () if state.fleet_return is None else state.fleet_return.vehicles

    async def _send(self, body: Body, serials: Sequence[str] | None) -> tuple[VehicleAnswer, ...]:
        if serials is not None:
            return await self._order_api.send(tuple(dict.fromkeys(serials)), body)
        # Requested now: the stream's list may be old, and a vehicle missing from it would fly on.
        state = await self._order_api.http.get("/api/state", StateMessage, "a state")
        known = [v.serial for v in state.vehicles if v.serial is not None]
        return await self._order_api.send(known, body) if known else ()
