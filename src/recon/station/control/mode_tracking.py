"""Telemetry compared with what each vehicle was commanded to do. Writes `VehicleControl.tracking`.

Theory of operation. A vehicle's intent (`intents`) and whether telemetry has shown it begun choose
a row of the flight table (`fleet.flight_table`). Each new flight mode, with a position at least as
new, is read once by that row. The verdicts:

- *carried out*: the mode becomes the known one; for a setpoint stream the intent has begun.
- *finished*: on the ground the order is done and the intent ends. In the air the vehicle holds
  where it is, and `missions` sends the next part of a mission.
- *pilot*, *failsafe*: count at once if only they explain the mode, else after `mode_lasts_s`,
  because apps show such modes in passing. A pilot gets authority, the order is superseded and
  nothing more is sent. A failsafe fails the order and raises an alarm until landing.
- *undecided*: after `undecided_s`, or when the vehicle reconnects in such a mode, the order fails:
  its outcome is unknown.

Transitions without a verdict: an intent changes when an order leaves (`on_order_sent`), telemetry
shows its beginning (`on_order_begun`) or a stream replaces it. An order that fails before it began,
and the landing of a vehicle that holds, leave nothing commanded. Hold, land and return that
telemetry has not shown yet are not read: `order_timeouts` repeats them and ends them. A vehicle
that was never commanded and moves in position mode is flown by its pilot.
"""

from recon.fleet.confirmation import SentContext
from recon.fleet.flight_table import Instruction, ModeKind, Reading, Verdict, kind_of, read
from recon.fleet.mission_progress import Seen, waypoints_passed
from recon.model.command import STEERED_BODIES, Body, LandNow, Phase
from recon.model.control import Commanded, Intent
from recon.model.replacing import replace
from recon.model.units import ns_to_seconds, seconds_to_ns
from recon.model.vehicle import FlightMode, VehicleState
from recon.station.control import authority, intents, missions
from recon.station.state import orders
from recon.station.state.orders import OrderRecord
from recon.station.state.station import Station
from recon.station.state.steps import Judge, Output, Stepped
from recon.station.state.vehicle_control import NO_INTENT, Tracking

_RECENT_S = 0.5
"""A vehicle with newer telemetry is tracked at each of its packets, and not at ticks as well."""

FLOWN_BY_HAND_MPS = 2.0
"""Speed that an aircraft in position mode stays below without stick input: gusts, GNSS noise."""

_LASTING = (Verdict.PILOT, Verdict.FAILSAFE)
_UNCONFIRMED_EMERGENCY = (Instruction.HOLD_SENT, Instruction.RETURN_SENT, Instruction.LAND_SENT)
"""Instructions whose repeats and timeouts decide until telemetry shows their effect."""

_FAILED_BEFORE_START = (Phase.TIMED_OUT, Phase.REFUSED_BY_APP, Phase.FAILED, Phase.EXPIRED)

_NOT_TRACKED = Tracking()


def track(station: Station, serials: tuple[str, ...], now_ns: int, judge: Judge) -> Stepped:
    """Return the station after telemetry was read for these vehicles, and what is sent for it."""
    outputs: tuple[Output, ...] = ()
    for serial in serials:
        station, sent = _track(station, serial, now_ns, judge)
        outputs += sent
    return station, outputs


def without_recent_telemetry(station: Station, now_ns: int) -> tuple[str, ...]:
    """Return the vehicles that have not just been tracked at a packet of their own."""
    limit_ns = seconds_to_ns(_RECENT_S)
    return tuple(
        serial
        for serial, vehicle in station.fleet.vehicles.items()
        if vehicle.core_received_at_ns is None or now_ns - vehicle.core_received_at_ns > limit_ns
    )


def tracking_of(station: Station, serial: str) -> Tracking:
    """Return how a vehicle is tracked."""
    return station.control(serial).tracking or _NOT_TRACKED


def on_order_sent(
    station: Station, serial: str, command_id: int, body: Body, context: SentContext
) -> Station:
    """Return the station after an order to move or to stop left for a vehicle."""
    intent = intents.of_order(command_id, body, context.sent_at_ns)
    return station if intent is None else _start(station, serial, intent, context.mode_when_sent)


def on_order_begun(
    station: Station, serial: str, command_id: int, body: Body, now_ns: int
) -> Station:
    """Return the station after telemetry showed an order begun: a mission flown, a landing.

    An order that had failed and begins late is the vehicle's intent again.
    """
    if station.control(serial).intent.command_id != command_id:
        station = on_order_sent(station, serial, command_id, body, SentContext(now_ns, None, None))
    vehicle, tracking = station.fleet.vehicles.get(serial), tracking_of(station, serial)
    if vehicle is None or tracking.has_begun:
        return station
    begun = replace(
        tracking,
        has_begun=True,
        mode_before=vehicle.flight_mode.value,
        link_id=vehicle.link_id,
        core_at_ns=vehicle.core_received_at_ns,
    )
    return _with_tracking(station, serial, begun)


def hold_here(station: Station, serial: str, now_ns: int) -> Station:
    """Return the station with a vehicle that holds where it is, its order finished.

    The place it holds is known once it hovers.
    """
    vehicle = station.fleet.vehicles[serial]
    intent = Intent(Commanded.HOLD, now_ns)
    station = _start(station, serial, intent, vehicle.flight_mode.value)
    begun = replace(tracking_of(station, serial), has_begun=True, link_id=vehicle.link_id)
    return _with_tracking(station, serial, begun)


def on_pilot_takeover(station: Station, serial: str, why: str, now_ns: int) -> Stepped:
    """Return the station after a pilot took a vehicle over: the order behind its intent is
    superseded, and the pilot has authority."""
    record = _active_order(station, serial)
    if record is not None:
        is_landing = isinstance(record.command.body, LandNow)
        alarm = orders.LANDING_STOPPED if is_landing else None
        note = f"the pilot has taken over: {why}"
        station = _put(station, orders.ended(record, Phase.SUPERSEDED, now_ns, note, alarm=alarm))
    station, outputs = authority.give_to_pilot(station, serial, now_ns, why)
    return _command_nothing(station, serial, now_ns), outputs


def _track(station: Station, serial: str, now_ns: int, judge: Judge) -> Stepped:
    vehicle = station.fleet.vehicles.get(serial)
    if vehicle is None:
        return _forget(station, serial), ()
    station = _end_stale_intent(station, serial, vehicle, now_ns)
    station = _detect_manual_flight(station, serial, vehicle, now_ns)
    station = intents.with_held_place(_count_passed(station, serial, vehicle), serial)
    record = _active_order(station, serial)
    if record is not None:
        station = missions.check_chain(station, record, vehicle, now_ns)
    reading = _reading(station, serial, vehicle)
    if reading is None:
        return station, ()
    tracking = replace(tracking_of(station, serial), read=vehicle.flight_mode)
    station = _with_tracking(station, serial, tracking)
    return _apply(station, serial, vehicle, reading, now_ns, judge)


def _reading(station: Station, serial: str, vehicle: VehicleState) -> Reading | None:
    """Return what the newest mode means, None while there is no newer one or no newer place.

    A mode that only a pilot selects needs no newer place: an order may come before the next one.
    """
    intent, tracking = _tracked(station, serial)
    instruction, mode = intents.instruction_of(intent, tracking.has_begun), vehicle.flight_mode
    if instruction in _UNCONFIRMED_EMERGENCY or mode.value is None or mode.received_at_ns is None:
        return None
    core_ns = vehicle.core_received_at_ns
    if mode is tracking.read or mode == tracking.read:
        return None
    level = vehicle.gnss_signal_level.value
    kind = kind_of(mode.value, level)
    is_new = mode.received_at_ns > tracking.since_ns
    is_placed = core_ns is not None and core_ns >= mode.received_at_ns
    if not is_new or not (is_placed or kind is ModeKind.PILOT):
        return None
    place = intents.place_of(intent, vehicle, kind)
    if place is None:
        return None
    return read(instruction, mode.value, level, place, tracking.mode_before)


def _apply(
    station: Station,
    serial: str,
    vehicle: VehicleState,
    reading: Reading,
    now_ns: int,
    judge: Judge,
) -> Stepped:
    verdict = reading.verdict
    if verdict in _LASTING:
        station, has_lasted = _with_doubt(station, serial, vehicle, verdict)
        if not (has_lasted or reading.is_at_once):
            return station, ()
        if verdict is Verdict.PILOT:
            return on_pilot_takeover(station, serial, reading.why, now_ns)
        return _on_failsafe(station, serial, reading.why, now_ns), ()
    if verdict is Verdict.FINISHED:
        return _on_finished(station, serial, vehicle, now_ns, judge)
    if verdict is Verdict.UNDECIDED:
        return _on_undecided(station, serial, vehicle, reading, now_ns), ()
    tracking = tracking_of(station, serial)
    is_steered = verdict is Verdict.CARRIED_OUT and _is_steered(station, serial)
    shown = replace(
        tracking,
        has_begun=tracking.has_begun or is_steered,
        doubt=None,
        mode_before=vehicle.flight_mode.value,
        link_id=vehicle.link_id,
    )
    return (station if shown == tracking else _with_tracking(station, serial, shown)), ()


def _with_doubt(
    station: Station, serial: str, vehicle: VehicleState, verdict: Verdict
) -> tuple[Station, bool]:
    """Note a verdict that counts once it has lasted; return whether it has."""
    tracking = tracking_of(station, serial)
    mode_ns = vehicle.flight_mode.received_at_ns or 0
    if tracking.doubt is not verdict:
        doubted = replace(tracking, doubt=verdict, doubt_since_ns=mode_ns)
        return _with_tracking(station, serial, doubted), False
    lasted_s = ns_to_seconds(mode_ns - tracking.doubt_since_ns)
    return station, lasted_s >= station.settings.mode_lasts_s


def _on_failsafe(station: Station, serial: str, why: str, now_ns: int) -> Station:
    record = _active_order(station, serial)
    if record is not None:
        station = _put(station, orders.ended(record, Phase.FAILED, now_ns, why))
    return _command_nothing(station, serial, now_ns, failsafe=why)


def _on_finished(
    station: Station, serial: str, vehicle: VehicleState, now_ns: int, judge: Judge
) -> Stepped:
    record = _active_order(station, serial)
    if vehicle.is_flying.value is False:
        if record is not None:
            note = "telemetry shows it on the ground"
            station = _put(station, orders.ended(record, Phase.DONE, now_ns, note))
        return _command_nothing(station, serial, now_ns), ()
    station = hold_here(station, serial, now_ns)
    if record is None:
        return station, ()
    return missions.part_flown(station, record, now_ns, judge)


def _on_undecided(
    station: Station, serial: str, vehicle: VehicleState, reading: Reading, now_ns: int
) -> Station:
    """Wait, unless the mode lasts or the vehicle came back with it on another link: then the
    outcome of its order is unknown, and it is commanded nothing."""
    tracking, mode = tracking_of(station, serial), vehicle.flight_mode.value
    if mode is tracking.mode_before:
        return station
    if tracking.command_id is None and not tracking.has_begun:
        return _with_tracking(station, serial, replace(tracking, mode_before=mode))
    if not tracking.has_begun:
        return station
    if vehicle.is_flying.value is False:
        return _command_nothing(station, serial, now_ns)
    station, _ = _with_doubt(station, serial, vehicle, Verdict.UNDECIDED)
    since_ns = tracking_of(station, serial).doubt_since_ns
    doubt_s = ns_to_seconds((vehicle.flight_mode.received_at_ns or 0) - since_ns)
    came_back = tracking.link_id is not None and vehicle.link_id != tracking.link_id
    if not came_back and doubt_s < station.settings.undecided_s:
        return station
    record = _active_order(station, serial)
    if record is not None:
        text = (
            f"reconnected in another flight mode ({reading.why})"
            if came_back
            else f"telemetry no longer shows it carried out ({reading.why})"
        )
        station = _put(station, orders.ended(record, Phase.FAILED, now_ns, text))
    return _command_nothing(station, serial, now_ns)


def _end_stale_intent(station: Station, serial: str, vehicle: VehicleState, now_ns: int) -> Station:
    """An order that failed before it began is no intent; a landing ends holds and failsafes."""
    control = station.control(serial)
    intent, tracking = control.intent, control.tracking
    record = station.orders.records.get(intent.command_id or 0)
    if tracking is None:
        station = _command_nothing(station, serial, now_ns)
        new = replace(tracking_of(station, serial), is_unbidden=not control.is_taken)
        return _with_tracking(station, serial, new)
    if intent.commanded is not Commanded.NOTHING and intent.command_id != tracking.command_id:
        return _start(station, serial, intent, vehicle.flight_mode.value)
    if record is not None and not tracking.has_begun and record.phase in _FAILED_BEFORE_START:
        return _command_nothing(station, serial, now_ns)
    is_down = vehicle.is_flying.value is False
    is_over = intent.commanded is Commanded.HOLD and tracking.has_begun
    if is_down and (is_over or tracking.failsafe is not None):
        return _command_nothing(station, serial, now_ns)
    return station


def _detect_manual_flight(
    station: Station, serial: str, vehicle: VehicleState, now_ns: int
) -> Station:
    """A vehicle that moves in position mode with nothing ordered is flown by its pilot.

    In other modes the flight table shows its pilot; a hover shows nothing.
    """
    intent, tracking = _tracked(station, serial)
    if intent.commanded is not Commanded.NOTHING or vehicle.is_flying.value is None:
        return station
    if vehicle.is_flying.value is False:
        if tracking.is_unbidden:
            return station
        return _with_tracking(station, serial, replace(tracking, is_unbidden=True))
    is_flown = tracking.is_unbidden and _moves_in_position_mode(vehicle)
    return authority.on_manual_flight(station, serial, now_ns) if is_flown else station


def _moves_in_position_mode(vehicle: VehicleState) -> bool:
    mode, velocity = vehicle.flight_mode.value, vehicle.velocity_ned.value
    if mode is None or velocity is None:
        return False
    is_neutral = kind_of(mode, vehicle.gnss_signal_level.value) is ModeKind.NEUTRAL
    return is_neutral and velocity.speed_mps >= FLOWN_BY_HAND_MPS


def _count_passed(station: Station, serial: str, vehicle: VehicleState) -> Station:
    """Return the station with the waypoints counted that a vehicle has passed by now."""
    intent, tracking = _tracked(station, serial)
    core_at_ns, position = vehicle.core_received_at_ns, vehicle.position.value
    if intent.commanded is not Commanded.MISSION or intent.mission is None:
        return station  # a steered path counts its own
    if not tracking.has_begun or position is None:
        return station
    if core_at_ns is None or core_at_ns == tracking.core_at_ns:
        return station
    since_ns = tracking.core_at_ns if tracking.core_at_ns is not None else intent.since_ns
    seen = Seen(position, vehicle.height_above_takeoff_m.value, vehicle.velocity_ned.value)
    since_s = ns_to_seconds(core_at_ns - since_ns)
    passed = waypoints_passed(intent.mission, intent.passed, seen, since_s)
    station = _with_tracking(station, serial, replace(tracking, core_at_ns=core_at_ns))
    return intents.with_passed(station, serial, passed)


def _is_steered(station: Station, serial: str) -> bool:
    """Whether a setpoint stream flies it: its order begins without `on_order_begun`."""
    record = _active_order(station, serial)
    return record is not None and isinstance(record.command.body, STEERED_BODIES)


def _start(station: Station, serial: str, intent: Intent, mode: FlightMode | None) -> Station:
    """Return the station with a vehicle's intent, tracked anew; `mode` is no news of it.

    Unless it is its pilot's and not read yet: an order between the mode's packet and the next place
    must not hide that the pilot took over.
    """
    before = tracking_of(station, serial)
    known = before.mode_before if before.read is None else before.read.value
    if mode is not None and kind_of(mode, None) is ModeKind.PILOT:
        mode = known
    station = intents.with_intent(station, serial, intent)
    tracking = Tracking(since_ns=intent.since_ns, command_id=intent.command_id, mode_before=mode)
    return _with_tracking(station, serial, tracking)


def _command_nothing(
    station: Station, serial: str, now_ns: int, *, failsafe: str | None = None
) -> Station:
    """Return the station with a vehicle commanded nothing; `failsafe`: what it does on its own."""
    vehicle = station.fleet.vehicles.get(serial)
    mode = None if vehicle is None else vehicle.flight_mode.value
    station = intents.with_intent(station, serial, NO_INTENT)
    tracking = Tracking(since_ns=now_ns, mode_before=mode, failsafe=failsafe)
    return _with_tracking(station, serial, tracking)


def _forget(station: Station, serial: str) -> Station:
    return intents.with_intent(station, serial, NO_INTENT).with_control(serial, tracking=None)


def _tracked(station: Station, serial: str) -> tuple[Intent, Tracking]:
    """What a vehicle was last commanded, and how far telemetry has confirmed it."""
    control = station.control(serial)
    return control.intent, control.tracking or _NOT_TRACKED


def _with_tracking(station: Station, serial: str, tracking: Tracking) -> Station:
    return station.with_control(serial, tracking=tracking)


def _active_order(station: Station, serial: str) -> OrderRecord | None:
    """The order behind a vehicle's intent, until it has ended."""
    record = station.orders.records.get(station.control(serial).intent.command_id or 0)
    return None if record is None or record.phase.is_final else record


def _put(station: Station, record: OrderRecord) -> Station:
    book = orders.put(station.orders, record, station.settings.orders_kept)
    return replace(station, orders=book)
