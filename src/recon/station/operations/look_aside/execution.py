"""The execution of a look aside: one goto aside, one back, then a hold.

    aside --arrived--> back, or waiting while the gate refuses the way back
    waiting --the gate approves--> back
    back --arrived--> done: held, and control goes back to the operator
    any of them --pilot, another order, all stop, connection lost, refused setpoint, too long-->
        stopped: held by whatever ended it, or by an order here; nothing resumes

Both gotos are orders of guidance through the gate, without a connection that owns them: each ends
by itself within a minute. The end of an order is read from its record, which telemetry makes.
"""

from dataclasses import replace

from recon.guidance.look_aside import LOOK_ASIDE_SETTINGS, LookAsideSettings
from recon.model.command import Hover, Phase
from recon.model.control import AuthorityHolder
from recon.model.event import OperatorOrder
from recon.model.units import seconds_to_ns
from recon.station.control import authority, order_gateway
from recon.station.operations.look_aside.by_itself import begin_if_due
from recon.station.operations.look_aside.commands import way
from recon.station.state.look_aside_record import LookAside, LookAsideStage
from recon.station.state.station import Station, take_id
from recon.station.state.steps import Stepped

HOLD_ENDED = "the station could no longer hold it beside its place"


def advance(
    station: Station, now_ns: int, settings: LookAsideSettings = LOOK_ASIDE_SETTINGS
) -> Stepped:
    """Advance the look aside under way, or begin one by itself if it is due."""
    current = station.look_asides.newest
    if current is None or current.is_over:
        return begin_if_due(station, now_ns, settings)
    holder = station.control(current.serial).authority
    if holder.holder is not AuthorityHolder.GUIDANCE:
        return _stopped(station, current, holder.reason, now_ns), ()
    if current.stage is LookAsideStage.WAITING:
        return _wait(station, current, settings, now_ns)
    return _read_way(station, current, settings, now_ns)


def _read_way(
    station: Station, current: LookAside, settings: LookAsideSettings, now_ns: int
) -> Stepped:
    record = station.orders.records.get(current.command_id)
    if record is None:
        return _hold(station, current, "the record of its order was lost", now_ns)
    if record.phase is Phase.DONE:
        if current.stage is LookAsideStage.ASIDE and _is_held_aside(station, current):
            return _fly_back(station, current, now_ns)
        if current.stage is LookAsideStage.ASIDE:
            return _stopped(station, current, HOLD_ENDED, now_ns), ()
        return _come_back(station, current, now_ns)
    if record.phase.is_final:
        return _stopped(station, current, record.note or record.phase.value, now_ns), ()
    if now_ns - current.since_ns > seconds_to_ns(settings.leg_within_s):
        return _hold(station, current, f"not arrived within {settings.leg_within_s:g} s", now_ns)
    return station, ()


def _wait(
    station: Station, current: LookAside, settings: LookAsideSettings, now_ns: int
) -> Stepped:
    """Beside its place: have the gate judge the way back again, for a while."""
    if not _is_held_aside(station, current):
        return _stopped(station, current, HOLD_ENDED, now_ns), ()
    if now_ns - current.since_ns > seconds_to_ns(settings.gate_waits_s):
        why = f"its way back was refused for {settings.gate_waits_s:g} s: {current.reason}"
        return _hold(station, current, why, now_ns)
    if now_ns - current.judged_at_ns < seconds_to_ns(settings.judged_again_s):
        return station, ()
    return _fly_back(station, current, now_ns)


def _is_held_aside(station: Station, current: LookAside) -> bool:
    """Whether the goto aside still holds it there: when that has ended, nothing resumes."""
    stream = station.control(current.serial).stream
    if stream is None or stream.command.id != current.command_id:
        return False
    return stream.closing is None


def _fly_back(station: Station, current: LookAside, now_ns: int) -> Stepped:
    """Order the way back; while it is refused, the first goto holds the vehicle beside its place.

    A refused try leaves no record: it is made again every second.
    """
    order = way(station, current.by, current.serial, current.place, current.height_above_takeoff_m)
    tried, outputs = order_gateway.submit(take_id(station)[0], order, now_ns)
    record = tried.orders.records[order.command_id]
    if record.phase is not Phase.REFUSED_BY_STATION:
        flying = replace(current, command_id=order.command_id)
        return _put(tried, flying.at(LookAsideStage.BACK, now_ns)), outputs
    if current.stage is LookAsideStage.ASIDE:
        current = current.at(LookAsideStage.WAITING, now_ns)
    return _put(station, replace(current, judged_at_ns=now_ns, reason=record.note)), ()


def _come_back(station: Station, current: LookAside, now_ns: int) -> Stepped:
    """The aircraft's own hold replaces the sticks, and the operator gets it back."""
    station, outputs = _ordered_hold(station, current, "look aside done", now_ns)
    station = _put(station, current.at(LookAsideStage.DONE, now_ns))
    return _handed_back(station, current, "look aside done", now_ns), outputs


def _hold(station: Station, current: LookAside, why: str, now_ns: int) -> Stepped:
    """Stop a look aside whose vehicle still flies it: hold it where it is."""
    station, outputs = _ordered_hold(station, current, f"look aside: {why}", now_ns)
    return _stopped(station, current, why, now_ns), outputs


def _ordered_hold(station: Station, current: LookAside, why: str, now_ns: int) -> Stepped:
    station, number = take_id(station)
    by = f"station: {why}"
    hold = OperatorOrder(number, Hover(), by, serial=current.serial, role=AuthorityHolder.GUIDANCE)
    return order_gateway.submit(station, hold, now_ns)


def _stopped(station: Station, current: LookAside, why: str, now_ns: int) -> Station:
    station = _put(station, current.at(LookAsideStage.STOPPED, now_ns, why))
    return _handed_back(station, current, f"look aside stopped: {why}", now_ns)


def _handed_back(station: Station, current: LookAside, why: str, now_ns: int) -> Station:
    return authority.hand_back(station, current.serial, current.by, why, now_ns)


def _put(station: Station, current: LookAside) -> Station:
    return replace(station, look_asides=replace(station.look_asides, newest=current))
