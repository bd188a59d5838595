"""The execution of an imaging drone's motion: its legs, and its ends.

A leg is one goto, or the mission of a relief, of guidance through the gate, without a connection
that owns it: it ends in a stated time. The end of a leg is read from its order's record, which
telemetry makes. A motion ends in one of two ways, and control goes back to the operator with
either:

    done: at its place, held there by the aircraft's own hold
    stopped, by pilot, another order, all stop, lost connection, refused setpoint or too long a leg:
        held by whatever ended it, or by an order here; nothing resumes
"""

from collections.abc import Callable

from recon.model.command import Body, Phase, Refusal, issued_by_station
from recon.model.control import AuthorityHolder
from recon.model.event import OperatorOrder
from recon.model.replacing import replace
from recon.model.units import seconds_to_ns
from recon.station.control import authority, order_gateway
from recon.station.operations.guidance_hold import guidance_hold
from recon.station.operations.imager_motion.claim import Claimed
from recon.station.state.imager_motion import AnyMotion, MotionStage, MotionT
from recon.station.state.orders import OrderRecord
from recon.station.state.station import Station, take_id
from recon.station.state.steps import Output, Stepped


def begin_with(drone: Claimed, motion: AnyMotion, body: Body, now_ns: int) -> Stepped | Refusal:
    """Return the station with a motion begun by its first order, or why the gate refuses that."""
    station, outputs, record = tried(drone.station, motion, body, now_ns)
    if is_refused(record):
        assert record.refusal is not None, "a refused order has its refusal"
        return record.refusal
    station = put(station, replace(motion, command_id=record.command.id))
    return station, (*drone.outputs, *outputs)


def after_automatic_begin(
    station: Station,
    kind: type[AnyMotion],
    begun: Stepped | Refusal,
    every_s: float,
    again_s: float,
    now_ns: int,
) -> Stepped:
    """Return the station after a motion was begun automatically, or refused."""
    refusal = begun if isinstance(begun, Refusal) else None
    station, outputs = (station, ()) if isinstance(begun, Refusal) else begun
    motions = station.imager_motions
    start = motions.start(kind).after_try(refusal, every_s, again_s, now_ns)
    return replace(station, imager_motions=motions.with_start(kind, start)), outputs


def not_refused(station: Station, kind: type[AnyMotion]) -> Station:
    """Return the station without a refusal of a kind's automatic start."""
    motions = station.imager_motions.not_refused(kind)
    return (
        station if motions is station.imager_motions else replace(station, imager_motions=motions)
    )


def tried(
    station: Station, motion: AnyMotion, body: Body, now_ns: int, *, takeoff: bool = False
) -> tuple[Station, tuple[Output, ...], OrderRecord]:
    """Order a leg; return the station, the packets and the order's record, perhaps refused."""
    station, number = take_id(station)
    order = OperatorOrder(
        number,
        body,
        f"{motion.by}: {motion.words}",
        serial=motion.serial,
        takeoff=takeoff,
        role=AuthorityHolder.GUIDANCE,
    )
    station, outputs = order_gateway.submit(station, order, now_ns)
    return station, outputs, station.orders.records[number]


def is_refused(record: OrderRecord) -> bool:
    """Whether the gate refused a leg."""
    return record.phase is Phase.REFUSED_BY_STATION


def go_on(
    station: Station,
    kind: type[MotionT],
    advance: Callable[[Station, MotionT, int], Stepped],
    now_ns: int,
) -> Stepped | None:
    """Advance a kind's motion under way, or stop it: another holder may have its vehicle.

    None without one.
    """
    current = station.imager_motions.of(kind)
    if current is None or current.is_over:
        return None
    holder = station.control(current.serial).authority
    if holder.holder is not AuthorityHolder.GUIDANCE:
        return stopped(station, current, holder.reason, now_ns), ()
    return advance(station, current, now_ns)


def follow(
    station: Station,
    motion: MotionT,
    within_s: float,
    arrived: Callable[[Station, MotionT, int], Stepped],
    now_ns: int,
) -> Stepped:
    """Read what has become of the newest leg: `arrived` takes its good end."""
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


def done(station: Station, motion: AnyMotion, now_ns: int) -> Stepped:
    """End a motion at its place: the aircraft's own hold replaces the sticks."""
    why = f"{motion.words} done"
    station, outputs = _ordered_hold(station, motion, why, now_ns)
    station = put(station, motion.at(MotionStage.DONE, now_ns))
    return authority.hand_back(station, motion.serial, motion.by, why, now_ns), outputs


def held(station: Station, motion: AnyMotion, why: str, now_ns: int) -> Stepped:
    """Stop a motion whose vehicle still flies it: hold it where it is."""
    station, outputs = _ordered_hold(station, motion, f"{motion.words}: {why}", now_ns)
    return stopped(station, motion, why, now_ns), outputs


def stopped(station: Station, motion: AnyMotion, why: str, now_ns: int) -> Station:
    """Return the station with a motion stopped, and the vehicle no longer under guidance."""
    station = put(station, motion.at(MotionStage.STOPPED, now_ns, why))
    why = f"{motion.words} stopped: {why}"
    return authority.hand_back(station, motion.serial, motion.by, why, now_ns)


def put(station: Station, motion: AnyMotion) -> Station:
    """Return the station with the newest motion of its kind replaced."""
    return replace(station, imager_motions=station.imager_motions.put(motion))


def _ordered_hold(station: Station, motion: AnyMotion, why: str, now_ns: int) -> Stepped:
    station, hold = guidance_hold(station, motion.serial, issued_by_station(why))
    return order_gateway.submit(station, hold, now_ns)
