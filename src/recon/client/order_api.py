"""Where orders are handed in: one request each, and one answer for each vehicle named."""

from collections.abc import Sequence
from typing import TYPE_CHECKING

from recon.client.errors import ConnectionLostError, MaybeSentError, OrderInvalidError
from recon.client.messages import OrderMessage, ResultMessage
from recon.client.order import Order, VehicleAnswer
from recon.client.order_form import order_form
from recon.model.command import STEERED_BODIES, Body, Refusal

if TYPE_CHECKING:
    from recon.client.http import Http
    from recon.client.stream import Stream


class OrderDesk:
    """Gives orders to one station. Nothing is ever given twice."""

    def __init__(self, http: "Http", stream: "Stream") -> None:
        self.http = http
        self.stream = stream

    async def give(
        self, serials: Sequence[str], body: Body, takeoff: bool = False
    ) -> tuple[VehicleAnswer, ...]:
        """Give an order to vehicles; returns one answer for each, in their order."""
        form = order_form(body)
        if isinstance(form, Refusal):
            return _all_refused(serials, form)
        run_started_ns = self._run_started_ns()
        asked = {"serials": list(serials), "order": form, "takeoff": takeoff}
        if isinstance(body, STEERED_BODIES):
            asked["owner"] = self._owner()
        try:
            answer = await self.http.post("/api/orders", asked, OrderMessage, "results of an order")
        except OrderInvalidError as problem:
            return _all_refused(serials, Refusal("order_form", str(problem)))
        told = [result.serial for result in answer.results]
        if told != list(serials):
            raise MaybeSentError(
                f"expected one result for each of {list(serials)}, got results for {told}; the "
                "order may have been sent: see what the vehicles do before giving it again"
            )
        return tuple(self._answer(result, run_started_ns) for result in answer.results)

    async def give_one(self, serial: str, body: Body, takeoff: bool = False) -> Order | Refusal:
        """Give an order to one vehicle."""
        (result,) = await self.give((serial,), body, takeoff)
        return result.answer

    async def refusal_of(self, serial: str, body: Body, takeoff: bool = False) -> Refusal | None:
        """Return why an order would be refused now, None when it would not; none is given."""
        form = order_form(body)
        if isinstance(form, Refusal):
            return form
        asked = {"serials": [serial], "order": form, "takeoff": takeoff}
        if isinstance(body, STEERED_BODIES):
            asked["owner"] = self._owner()
        try:
            answer = await self.http.post(
                "/api/orders/check", asked, OrderMessage, "results of a check"
            )
        except OrderInvalidError as problem:
            return Refusal("order_form", str(problem))
        (result,) = answer.results
        if result.accepted:
            return None
        return result.refusal

    async def all_stop(self) -> tuple[VehicleAnswer, ...]:
        """Hold everything that flies."""
        run_started_ns = self._run_started_ns()
        answer = await self.http.post("/api/all-stop", None, OrderMessage, "results of an all stop")
        return tuple(self._answer(result, run_started_ns) for result in answer.results)

    async def fleet_return(self, serials: Sequence[str] | None) -> tuple[VehicleAnswer, ...]:
        """Call vehicles home in layers; None calls every one that flies or may."""
        run_started_ns = self._run_started_ns()
        asked = {"serials": None if serials is None else list(serials)}
        answer = await self.http.post(
            "/api/fleet-return", asked, OrderMessage, "results of a fleet return"
        )
        return tuple(self._answer(result, run_started_ns) for result in answer.results)

    def _run_started_ns(self) -> int:
        """The run of the station before the order was sent: that one knows the command's number."""
        if self.stream.newest is None:
            raise ConnectionLostError(
                "expected an open station, got one that was never entered: use "
                "`async with Station(...) as station`"
            )
        return self.stream.newest.message.run_started_ns

    def _owner(self) -> str:
        """The present connection of the stream: when it ends, the vehicle stops."""
        if self.stream.owner is None:
            raise ConnectionLostError(
                "expected an open stream of states to hold the order by, got none at present "
                f"({self.stream.trouble}); nothing was sent: give the order again when it is back"
            )
        return self.stream.owner

    def _answer(self, result: ResultMessage, run_started_ns: int) -> VehicleAnswer:
        answer: Order | Refusal
        if result.accepted:
            answer = Order(
                result.command_id,
                result.serial,
                result.link_id,
                result.vehicle_name,
                run_started_ns,
                self.stream,
                result.repairs,
                result.parts,
            )
        else:
            answer = result.refusal
        return VehicleAnswer(result.serial, result.link_id, result.vehicle_name, answer)


def _all_refused(serials: Sequence[str], refusal: Refusal) -> tuple[VehicleAnswer, ...]:
    return tuple(VehicleAnswer(serial, None, serial, refusal) for serial in serials)
