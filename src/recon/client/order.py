"""Orders to a station: one request per order, one answer per vehicle, and waiting for its end."""

from collections.abc import Callable, Sequence
from dataclasses import asdict, dataclass, field
from enum import Enum
from math import isfinite
from typing import TYPE_CHECKING, Any

from recon.client.errors import (
    ConnectionLostError,
    MaybeSentError,
    OrderInvalidError,
    WaitTimeoutError,
)
from recon.client.messages import (
    AnswerMessage,
    OrderMessage,
    OrderStatus,
    ReceivedState,
    ResultMessage,
)
from recon.model.command import (
    Body,
    Phase,
    Refusal,
    SteeredBody,
)

if TYPE_CHECKING:
    from recon.client.stream import Stream

SAME_RUN_NS = 1_000_000
"""Tolerance of a run's start, which is the difference of two rounded numbers, nanoseconds."""


@dataclass(frozen=True, slots=True)
class Order:
    """An accepted order. Accepted does not mean flown: only telemetry confirms, see `wait`."""

    command_id: int
    serial: str | None
    link_id: int | None
    vehicle_name: str
    _run_started_ns: int = field(repr=False)
    _stream: "Stream" = field(repr=False, compare=False)
    repairs: tuple[str, ...] = ()
    """Changes the station made to a mission so that the aircraft accepts it, as sentences."""
    parts: int = 0
    """Number of parts a mission is flown in; 0 for other orders."""

    async def wait(self, until: Phase = Phase.CONFIRMED, timeout_s: float = 30.0) -> OrderStatus:
        """Return the order's status once it has reached a phase or ended otherwise.

        The default is what telemetry shows: confirmed, or a mission's start. `Phase.DONE` waits
        for the end. Check `status.phase`: an order that timed out or was superseded is returned
        too. Raises `WaitTimeoutError`, and `ConnectionLostError` if the station has restarted and
        no longer has this order.
        """
        return await self._wait(
            lambda status: status.has_reached(until) or status.phase.is_final,
            until.value,
            timeout_s,
        )

    async def wait_for_effect(self, timeout_s: float = 30.0) -> OrderStatus:
        """Return the order's status once telemetry shows its execution, or it has ended.

        Check `status.has_taken_effect`. Raises as `wait` does.
        """
        return await self._wait(
            lambda status: status.has_taken_effect or status.phase.is_final,
            "an effect in telemetry",
            timeout_s,
        )

    async def wait_for_arrival(self, timeout_s: float = 600.0) -> OrderStatus:
        """Return a steered order's status once the vehicle is at the target, or it has ended.

        Check `status.has_arrived`. Raises as `wait` does.
        """

        def is_over(status: OrderStatus) -> bool:
            return status.has_arrived or (
                status.phase.is_final and status.phase is not Phase.CONFIRMED
            )

        return await self._wait(is_over, "arrival", timeout_s)

    async def _wait(
        self, is_over: Callable[[OrderStatus], bool], expected: str, timeout_s: float
    ) -> OrderStatus:
        deadline_ns = self._stream.now_ns() + round(timeout_s * 1e9)
        number, status = 0, None
        while (left_ns := deadline_ns - self._stream.now_ns()) > 0:
            state = await self._stream.after(number, left_ns / 1e9)
            if state is None:
                break
            number = state.number
            status = self._status(state) or status
            if status is not None and is_over(status):
                return status
        phase = "unknown" if status is None else f"{status.phase.value} ({status.note})"
        raise WaitTimeoutError(
            f"order {self.command_id} to {self.vehicle_name}: expected {expected} within "
            f"{timeout_s:g} s, its phase is {phase}; the order continues: hold the vehicle to stop "
            "it"
        )

    def _status(self, state: ReceivedState) -> OrderStatus | None:
        if abs(state.message.run_started_ns - self._run_started_ns) > SAME_RUN_NS:
            raise ConnectionLostError(
                f"order {self.command_id} to {self.vehicle_name}: the station has restarted and no "
                "longer has this order; check the vehicle"
            )
        return next((c for c in state.message.commands if c.id == self.command_id), None)


@dataclass(frozen=True, slots=True)
class VehicleAnswer:
    """The station's answer for one vehicle of an order to several.

    `serial` is None for a link that has not reported a serial number; an all stop holds it too.
    """

    serial: str | None
    link_id: int | None
    vehicle_name: str
    answer: Order | Refusal


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

    async def release_stop(self, serials: Sequence[str] | None) -> Refusal | None:
        """Release vehicles from the all stop in force; None: all."""
        request = {"serials": None if serials is None else list(serials)}
        answer = await self.http.post(
            "/api/all-stop/release", request, AnswerMessage, "an answer to a release"
        )
        return answer.refusal

    async def fleet_return(self, serials: Sequence[str] | None) -> tuple[VehicleAnswer, ...]:
        """Start a return in layers; None means all vehicles that fly or may fly."""
        named = None if serials is None else list(serials)
        request = {"serials": named, "given_at_unix_ms": self.station_time_ms()}
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
        request = {
            "serials": list(serials),
            "order": order,
            "takeoff": takeoff,
            "given_at_unix_ms": self.station_time_ms(),
        }
        return {**request, "owner": self._owner()} if isinstance(body, SteeredBody) else request

    def station_time_ms(self) -> int | None:
        """Return the station's time now, by its newest state; None without one.

        An order to move that arrives long after this is refused. No two clocks are compared: it is
        the station's own, counted on.
        """
        state = self.stream.newest
        if state is None:
            return None
        return round(state.message.time_ns / 1e6 + self.stream.age_s(state) * 1e3)

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
    order = {"kind": body.name, **_flat(asdict(body))}
    fault = not_finite(order, "")
    return order if fault is None else Refusal("finite_numbers", fault)


def _flat(values: dict[str, Any]) -> dict[str, Any]:
    """Return the fields of a body, with those of a position or mission among them."""
    flat: dict[str, Any] = {}
    for name, value in values.items():
        if isinstance(value, dict):
            flat |= value
        else:
            flat[name] = value.value if isinstance(value, Enum) else value
    flat.pop("purpose", None)  # a mission's is the station's to state
    if "waypoints" in flat:
        flat["waypoints"] = list(flat["waypoints"])  # JSON has no tuples
    return flat


def not_finite(value: object, name: str) -> str | None:
    """Return a sentence about the first NaN or infinity, with its path; None without any."""
    if isinstance(value, float) and not isfinite(value):
        return f"{name} is {value}: a finite number is needed"
    parts: list[tuple[object, object]] = []
    if isinstance(value, dict):
        parts = list(value.items())
    elif isinstance(value, list):
        parts = list(enumerate(value, start=1))
    faults = (not_finite(part, f"{name} {key}".strip()) for key, part in parts)
    return next((fault for fault in faults if fault is not None), None)


def _all_refused(serials: Sequence[str], refusal: Refusal) -> tuple[VehicleAnswer, ...]:
    return tuple(VehicleAnswer(serial, None, serial, refusal) for serial in serials)
