"""The orders of the API's port: given, checked, and what became of each at once."""

from collections.abc import Callable, Iterable
from dataclasses import dataclass

from recon.api import schema
from recon.model.command import Body, Hover, Phase
from recon.model.event import AllStopped, FleetReturnOrdered, OperatorOrder
from recon.model.person import Person
from recon.model.replacing import replace
from recon.station.alarms.event_alarms import FAULT_TO_DO
from recon.station.api_views import RunningStation
from recon.station.control.order_gateway import DRY_RUN_ID, dry_run
from recon.station.state.orders import OrderRecord
from recon.station.state.station import Station


@dataclass(frozen=True, slots=True)
class OrderService:
    """Orders to a running station."""

    driver: RunningStation
    ids: Callable[[], int]

    def give(self, serials: list[str], order: OperatorOrder) -> schema.OrderResponse:
        """Give an order like this one to each named vehicle, once each."""
        named = dict.fromkeys(serials)
        return self._given(replace(order, command_id=self.ids(), serial=one) for one in named)

    def check(self, serials: list[str], order: OperatorOrder) -> schema.OrderResponse:
        """Return what `give` would answer now; nothing is given and nothing changes."""
        station = self.driver.station
        orders = [replace(order, serial=serial) for serial in dict.fromkeys(serials)]
        records = dry_run(station, orders, self.driver.now_ns())
        return schema.OrderResponse(results=[_result(station, record) for record in records])

    def all_stop(self, by: Person) -> schema.OrderResponse:
        """Latch every vehicle, then hold every link that may be in flight, identified or not.

        Vehicles on the ground or without a connection are in the results with the gate's refusal:
        no vehicle that may be in flight is omitted.
        """
        self.driver.handle(AllStopped(by.label))
        fleet = self.driver.station.fleet
        links = [
            link.id
            for link in fleet.unbound_links()
            if link.claimed_serial is None
            and link.own_state.core_received_at_ns is not None
            and link.own_state.is_flying.value is not False
        ]
        hover = order_of(Hover(), by)
        orders = [replace(hover, serial=serial) for serial in self._within_reach()]
        orders += [replace(hover, link_id=link) for link in links]
        return self._given(replace(order, command_id=self.ids()) for order in orders)

    def fleet_return(
        self, serials: list[str] | None, by: Person, given_at_ns: int | None
    ) -> schema.OrderResponse:
        """Return vehicles home in layers; None: every vehicle that is or may be in flight."""
        called = self._within_reach() if serials is None else list(dict.fromkeys(serials))
        return schema.OrderResponse(results=[self._called(s, by, given_at_ns) for s in called])

    def _given(self, orders: Iterable[OperatorOrder]) -> schema.OrderResponse:
        results = []
        for order in orders:
            # Its record is read at once: the order book keeps a limited number.
            self.driver.handle(order)
            results.append(self._outcome(order.command_id, order.serial))
        return schema.OrderResponse(results=results)

    def _called(self, serial: str, by: Person, given_at_ns: int | None) -> schema.OrderResult:
        """Add one vehicle to the return; it is planned at the next tick."""
        command_id = self.ids()
        event = FleetReturnOrdered(command_id, (serial,), by.label, given_at_ns, by.name)
        self.driver.handle(event)
        return self._outcome(command_id, serial)

    def _outcome(self, command_id: int, serial: str | None) -> schema.OrderResult:
        station = self.driver.station
        record = station.orders.records.get(command_id)
        return _not_taken(command_id, serial) if record is None else _result(station, record)

    def _within_reach(self) -> list[str]:
        """Return every vehicle with a connection, or that is or may be in flight."""
        fleet = self.driver.station.fleet
        return [
            serial
            for serial, vehicle in fleet.vehicles.items()
            if fleet.link_ids_claiming(serial) or vehicle.is_flying.value is not False
        ]


def order_of(
    body: Body,
    by: Person,
    *,
    takeoff: bool = False,
    owner: str | None = None,
    given_at_ns: int | None = None,
) -> OperatorOrder:
    """Return a person's order, without a number and a vehicle yet."""
    return OperatorOrder(
        DRY_RUN_ID,
        body,
        by.label,
        takeoff=takeoff,
        owner=owner,
        given_at_ns=given_at_ns,
        person=by.name,
    )


def _not_taken(command_id: int, serial: str | None) -> schema.OrderResult:
    """Return the result of an order that was lost by a fault in the station's own code."""
    return schema.OrderResult(
        serial=serial,
        link_id=None,
        vehicle_name=serial or "?",
        is_simulated=False,
        accepted=False,
        command_id=command_id,
        rule="station_fault",
        reason=f"a fault in the station's own code, see the alarm; nothing was sent: {FAULT_TO_DO}",
        parameters={},
        repairs=[],
        parts=0,
    )


def _result(station: Station, record: OrderRecord) -> schema.OrderResult:
    target = station.target(record.command.serial, record.command.link_id)
    is_refused = record.phase is Phase.REFUSED_BY_STATION
    refusal = record.refusal if is_refused else None
    return schema.OrderResult(
        serial=record.command.serial,
        link_id=record.command.link_id,
        vehicle_name=record.vehicle_name,
        is_simulated=target is not None and target.is_simulated,
        accepted=not is_refused,
        command_id=record.command.id,
        rule=None if refusal is None else refusal.rule,
        reason=record.note or None,
        parameters={} if refusal is None else dict(refusal.parameters),
        repairs=[] if record.plan is None else list(record.plan.repairs),
        parts=0 if record.plan is None else len(record.plan.parts),
    )
