"""What waits unsent for a vehicle is withdrawn: by a stop, an all stop or a release to its pilot.

The order ends here, at once; `WithdrawMotion` takes the packet from the queues. A packet whose
order has ended is never sent (`dispatch`), so nothing depends on which of the two comes first.
"""

from recon.model.command import STEERED_BODIES, Command, Phase
from recon.model.replacing import replace
from recon.station.state import orders
from recon.station.state.orders import OrderRecord
from recon.station.state.station import Station
from recon.station.state.steps import Stepped, WithdrawMotion


def withdraw(
    station: Station, serial: str, why: str, now_ns: int, *, with_stops: bool = False
) -> Stepped:
    """End every order that waits unsent to move a vehicle; `with_stops`: unconfirmed stops too.

    Steered orders have a stream, which ends automatically.
    """
    book = station.orders
    for record in book.tracked:
        if _waits(record, serial) or (with_stops and _is_open_stop(record.command, record, serial)):
            ended = orders.ended(record, Phase.SUPERSEDED, now_ns, f"withdrawn: {why}")
            book = orders.put(book, ended, station.settings.orders_kept)
    links = station.fleet.link_ids_claiming(serial)
    outputs = (WithdrawMotion(links, why),) if links else ()
    return replace(station, orders=book), outputs


def _waits(record: OrderRecord, serial: str) -> bool:
    command = record.command
    if command.serial != serial or record.phase is not Phase.QUEUED:
        return False
    return command.moves and not isinstance(command.body, STEERED_BODIES)


def _is_open_stop(command: Command, record: OrderRecord, serial: str) -> bool:
    """Whether it is a stop that is not sent yet, or is still repeated."""
    if command.serial != serial or not command.is_emergency or record.phase.is_final:
        return False
    return record.phase is Phase.QUEUED or record.next_repeat_ns is not None
