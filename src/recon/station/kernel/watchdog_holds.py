"""The holds that the watchdogs request, placed as orders through the gateway like any other."""

from collections.abc import Iterable

from recon.model.command import Hover, issued_by_station
from recon.model.event import OperatorOrder
from recon.safety.watchdogs import WATCHDOGS, Watchdog
from recon.station.control import order_gateway
from recon.station.state.station import Station, take_id
from recon.station.state.steps import Output, SendCommand, Stepped
from recon.station.traffic import watchdog_runner


def run_watchdogs(
    station: Station, now_ns: int, watchdogs: Iterable[Watchdog] = WATCHDOGS
) -> Stepped:
    """Run the watchdogs if it is time, place the holds they request and record each outcome.

    A vehicle counts as held only if its hold went to its link: one that was refused, or waits for
    telemetry, stops nothing.
    """
    station, requests = watchdog_runner.run(station, now_ns, watchdogs)
    outputs: tuple[Output, ...] = ()
    for request in requests:
        station, number = take_id(station)
        issued_by = issued_by_station(request.finding.rule)
        order = OperatorOrder(number, Hover(), issued_by, request.serial)
        station, sent = order_gateway.submit(station, order, now_ns)
        outputs += sent
        is_sent = any(isinstance(output, SendCommand) for output in sent)
        why_not = None if is_sent else station.orders.records[number].note
        station = watchdog_runner.after_hold(station, request, why_not, now_ns)
    return station, outputs
