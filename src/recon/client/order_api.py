"""Sends orders to a station: one request per order, one answer per vehicle."""

from collections.abc import Sequence
from dataclasses import asdict
from math import isfinite
from typing import TYPE_CHECKING, Any

from recon.client.errors import ConnectionLostError, MaybeSentError, OrderInvalidError
from recon.client.messages import OrderMessage, ResultMessage
from recon.client.order import Order, VehicleAnswer
from recon.model.command import (
    BODY_NAMES,
    STEERED_BODIES,
    Body,
    FlyMission,
    GoTo,
    Nudge,
    Refusal,
    StartCamera,
    VirtualStick,
)

if TYPE_CHECKING:
    from recon.client.http import Http
    from recon.client.stream import Stream


class OrderApi:
    """Sends orders to one station. No order is sent twice."""

    def __init__(self, http: "Http", stream: "Stream") -> None:
        self.http = http
        self.stream = stream

    async def send(
        self, serials: Sequence[str], body: Body, takeoff: bool = False
    ) -> tuple[VehicleAnswer, ...]:
        """Send an order to vehicles; return one answer per vehicle, in the order of `serials`.

        Raises `ConnectionLostError` if a steered order has no stream to depend on, and
        `MaybeSentError` if the results do not match the vehicles.
        """
        request = self._request(serials, body, takeoff)
        if isinstance(request, Refusal):
            return _all_refused(serials, request)
        run_started_ns = self._run_started_ns()
        try:
            answer = await self.http.post(
                "/api/orders", request, OrderMessage, "results of an order"
            )
        except OrderInvalidError as problem:
            return _all_refused(serials, Refusal("order_form", str(problem)))
        answered = [result.serial for result in answer.results]
        if answered != list(serials):
            raise MaybeSentError(
                f"expected one result for each of {list(serials)}, got results for {answered}; the "
                "order may have been sent: check the vehicles before sending it again"
            )
        return tuple(self._answer(result, run_started_ns) for result in answer.results)

    async def send_one(self, serial: str, body: Body, takeoff: bool = False) -> Order | Refusal:
        """Send an order to one vehicle; raises as `send` does."""
        (result,) = await self.send((serial,), body, takeoff)
        return result.answer

    async def check(self, serial: str, body: Body, takeoff: bool = False) -> Refusal | None:
        """Return the refusal an order would get now, None if it would pass. Sends no order."""
        request = self._request((serial,), body, takeoff)
        if isinstance(request, Refusal):
            return request
        try:
            answer = await self.http.post(
                "/api/orders/check", request, OrderMessage, "results of a check"
            )
        except OrderInvalidError as problem:
            return Refusal("order_form", str(problem))
        (result,) = answer.results
        return result.refusal

    async def all_stop(self) -> tuple[VehicleAnswer, ...]:
        """Hold all flying vehicles."""
        return await self._send_to_fleet("/api/all-stop", None, "results of an all stop")

    async def fleet_return(self, serials: Sequence[str] | None) -> tuple[VehicleAnswer, ...]:
        """Start a return in layers; None means all vehicles that fly or may fly."""
        request = {"serials": None if serials is None else list(serials)}
        return await self._send_to_fleet("/api/fleet-return", request, "results of a fleet return")

    async def _send_to_fleet(
        self, path: str, request: dict[str, Any] | None, expected: str
    ) -> tuple[VehicleAnswer, ...]:
        run_started_ns = self._run_started_ns()
        answer = await self.http.post(path, request, OrderMessage, expected)
        return tuple(self._answer(result, run_started_ns) for result in answer.results)

    def _request(
        self, serials: Sequence[str], body: Body, takeoff: bool
    ) -> dict[str, Any] | Refusal:
        order = order_json(body)
        if isinstance(order, Refusal):
            return order
        request = {"serials": list(serials), "order": order, "takeoff": takeoff}
        return {**request, "owner": self._owner()} if isinstance(body, STEERED_BODIES) else request

    def _run_started_ns(self) -> int:
        """Start of the station's run before the order was sent: command ids belong to a run."""
        if self.stream.newest is None:
            raise ConnectionLostError(
                "expected an open station, got one that was never entered: use "
                "`async with Station(...) as station`"
            )
        return self.stream.newest.message.run_started_ns

    def _owner(self) -> str:
        """Owner name of the current stream connection; when that closes, the vehicle stops."""
        if self.stream.owner is None:
            raise ConnectionLostError(
                "expected an open stream for a steered order, got none "
                f"({self.stream.trouble}); nothing was sent: send the order again when it is back"
            )
        return self.stream.owner

    def _answer(self, result: ResultMessage, run_started_ns: int) -> VehicleAnswer:
        answer = result.refusal or Order(
            result.command_id,
            result.serial,
            result.link_id,
            result.vehicle_name,
            run_started_ns,
            self.stream,
            result.repairs,
            result.parts,
        )
        return VehicleAnswer(result.serial, result.link_id, result.vehicle_name, answer)


def order_json(body: Body) -> dict[str, Any] | Refusal:
    """Return an order as JSON values, or a refusal if it contains NaN or infinity."""
    order = {"kind": BODY_NAMES[type(body)], **_details(body)}
    fault = _not_finite(order, "")
    return order if fault is None else Refusal("finite_numbers", fault)


def _details(body: Body) -> dict[str, Any]:
    match body:
        case FlyMission(mission):
            return {
                "waypoints": [asdict(waypoint) for waypoint in mission.waypoints],
                "land_at_end": mission.land_at_end,
                "curved": mission.curved,
            }
        case VirtualStick():
            return {**asdict(body), "frame": body.frame.value}
        case GoTo(target, height_m, speed_mps, yaw_deg):
            return {
                **asdict(target),
                "height_above_takeoff_m": height_m,
                "speed_mps": speed_mps,
                "yaw_deg": yaw_deg,
            }
        case Nudge():
            return asdict(body)
        case StartCamera(fps_hz):
            return {"fps_hz": fps_hz}
        case _:
            return {}


def _not_finite(value: object, name: str) -> str | None:
    """Return a sentence about the first NaN or infinity, with its path; None without any."""
    if isinstance(value, float) and not isfinite(value):
        return f"{name} is {value}: a finite number is needed"
    parts: list[tuple[object, object]] = []
    if isinstance(value, dict):
        parts = list(value.items())
    elif isinstance(value, list):
        parts = list(enumerate(value, start=1))
    faults = (_not_finite(part, f"{name} {key}".strip()) for key, part in parts)
    return next((fault for fault in faults if fault is not None), None)


def _all_refused(serials: Sequence[str], refusal: Refusal) -> tuple[VehicleAnswer, ...]:
    return tuple(VehicleAnswer(serial, None, serial, refusal) for serial in serials)
