"""Emergency orders are repeated until telemetry shows them, each time judged anew."""

from recon.model.command import Refusal
from recon.model.replacing import replace
from recon.model.units import seconds_to_ns
from recon.station.state.orders import OrderRecord
from recon.station.state.outputs import Output, SendCommand
from recon.station.state.station import Station
from recon.station.state.stepped import Judge


def repeat(
    station: Station, record: OrderRecord, ask: Judge, now_ns: int
) -> tuple[OrderRecord, tuple[Output, ...]]:
    """Send an unconfirmed emergency order again if the gate still approves it now.

    One that has never left is no repeat: it is judged anew and waits on, until it expires. A repeat
    is never an order to take off: nothing that starts motion is sent again by itself.
    """
    left = record.repeats_left - (record.sent is not None)
    later_ns = now_ns + seconds_to_ns(station.settings.emergency_repeat_s)
    record = replace(record, repeats_left=left, next_repeat_ns=later_ns if left > 0 else None)
    command = record.command
    if record.sent is not None:
        command = replace(command, takeoff=False)
    judged = ask(station, command)
    if isinstance(judged, Refusal):
        waits = record.waits_to_be_heard and record.sent is None
        return (replace(record, next_repeat_ns=now_ns) if waits else record), ()
    waiting = tuple(dict.fromkeys((*record.waiting_link_ids, *judged.link_ids)))
    return replace(record, waiting_link_ids=waiting), (SendCommand(judged),)
