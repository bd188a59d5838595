"""What would become of an order, without giving it: the very same step, on a state thrown away."""

from collections.abc import Iterable

from recon.model.event import OperatorOrder
from recon.station.control import order_gateway
from recon.station.state.orders import OrderRecord
from recon.station.state.station import Station

CHECKED_ID = 0
"""The number of an order that is only asked about; no order that is given has it."""


def check(
    station: Station, orders: Iterable[OperatorOrder], now_ns: int
) -> tuple[OrderRecord, ...]:
    """Return what each order's record would be, the ones before it given first.

    Nothing is sent: what the steps would have sent is dropped with the state they made.
    """
    records: list[OrderRecord] = []
    for order in orders:
        station, _ = order_gateway.place(station, order, now_ns)
        records.append(station.orders.records[order.command_id])
    return tuple(records)
