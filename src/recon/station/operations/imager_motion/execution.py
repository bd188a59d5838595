"""The ways of an imaging drone's motion, and the ends of it.

A way is one goto, or the mission of a relief, of guidance through the gate, without a connection
that owns it: it ends by itself in a stated time. The end of a way is read from its order's record,
which telemetry makes. A motion ends in one of two ways, and control goes back to the operator with
either:

    done: at its place, held there by the aircraft's own hold
    stopped, by pilot, another order, all stop, lost connection, refused setpoint or too long a way:
        held by whatever ended it, or by an order here; nothing resumes
"""

from collections.abc import Callable

from recon.model.command import Body, Phase, issued_by_station
from recon.model.control import AuthorityHolder
from recon.model.event import OperatorOrder
from recon.model.replacing import replace
from recon.model.units import seconds_to_ns
from recon.station.control import authority, order_gateway
from recon.station.operations.guidance_hold import guidance_hold
from recon.station.state.imager_motion import (
    ImagerMotion,
    LookAside,
    MotionStage,
    MotionT,
    MoveUpwind,
)
from recon.station.state.imager_relief import ImagerRelief
from recon.station.state.orders import OrderRecord
from recon.station.state.station import Station, take_id
from recon.station.state.steps import Output, Stepped


def tried(
    station: Station,
    kind: type[ImagerMotion],
    by: str,
    serial: str,
    body: Body,
    now_ns: int,
    *,
    takeoff: bool = False,
) -> tuple[Station, tuple[Output, ...], OrderRecord]:
    """Order a way; return the station, the packets and the order's record, perhaps refused."""
    station, number = take_id(station)
    order = OperatorOrder(
        number,
        body,
        f"{by}: {kind.words}",
        serial=serial,
        takeoff=takeoff,
        role=AuthorityHolder.GUIDANCE,
    )
    station, outputs = order_gateway.submit(station, order, now_ns)
    return station, outputs, station.orders.records[number]


def is_refused(record: OrderRecord) -> bool:
    """Whether the gate refused a way."""
    return record.phase is Phase.REFUSED_BY_STATION


def not_of_guidance(station: Station, motion: ImagerMotion, now_ns: int) -> Station | None:
    """Return the station with a motion stopped whose vehicle another holder has; else None."""
    holder = station.control(motion.serial).authority
    if holder.holder is AuthorityHolder.GUIDANCE:
        return None
    return stopped(station, motion, holder.reason, now_ns)


def follow(
    station: Station,
    motion: MotionT,
    within_s: float,
    arrived: Callable[[Station, MotionT, int], Stepped],
    now_ns: int,
) -> Stepped:
    """Read what has become of the newest way: `arrived` takes its good end."""
    record = station.orders.records.get(motion.command_id)
    if record is None:
        return held(station, motion, "the record of its order was lost", now_ns)
    if record.phase is Phase.DONE:
        return arrived(station, motion, now_ns)
    if record.phase.is_final:
        return stopped(station, motion, record.note or record.phase.value, now_ns), ()
    if now_ns - motion.since_ns > seconds_to_ns(within_s):
        return held(station, motion, f"not arrived within {within_s:.0f} s", now_ns)
    return station, ()


def done(station: Station, motion: ImagerMotion, now_ns: int) -> Stepped:
    """End a motion at its place: the aircraft's own hold replaces the sticks."""
    why = f"{motion.words} done"
    station, outputs = _ordered_hold(station, motion, why, now_ns)
    station = put(station, motion.at(MotionStage.DONE, now_ns))
    return authority.hand_back(station, motion.serial, motion.by, why, now_ns), outputs


def held(station: Station, motion: ImagerMotion, why: str, now_ns: int) -> Stepped:
    """Stop a motion whose vehicle still flies it: hold it where it is."""
    station, outputs = _ordered_hold(station, motion, f"{motion.words}: {why}", now_ns)
    return stopped(station, motion, why, now_ns), outputs


def stopped(station: Station, motion: ImagerMotion, why: str, now_ns: int) -> Station:
    """Return the station with a motion stopped, and the vehicle no longer under guidance."""
    station = put(station, motion.at(MotionStage.STOPPED, now_ns, why))
    why = f"{motion.words} stopped: {why}"
    return authority.hand_back(station, motion.serial, motion.by, why, now_ns)


def put(station: Station, motion: ImagerMotion) -> Station:
    """Return the station with the newest motion of its kind replaced."""
    match motion:
        case LookAside():
            return replace(station, look_asides=replace(station.look_asides, newest=motion))
        case MoveUpwind():
            return replace(station, upwind_moves=replace(station.upwind_moves, newest=motion))
        case ImagerRelief():
            return replace(station, reliefs=replace(station.reliefs, newest=motion))
    raise TypeError(f"expected a kind of motion that has a place in the state, got {motion!r}")


def _ordered_hold(station: Station, motion: ImagerMotion, why: str, now_ns: int) -> Stepped:
    station, hold = guidance_hold(station, motion.serial, issued_by_station(why))
    return order_gateway.submit(station, hold, now_ns)
