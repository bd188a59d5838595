"""What vehicles do, read by the flight table, and what follows from it.

An order that telemetry has shown is followed to its end here: finished, taken over by the pilot,
or ended by the aircraft's own failsafe. So is a vehicle that has been told nothing, or to hold.
"""

from recon.fleet.flight_table import Instruction, ModeKind, Reading, Verdict, kind_of, read
from recon.model.command import STEERED_BODIES, LandNow, Phase
from recon.model.intent import Commanded, Intent
from recon.model.replacing import replace
from recon.model.units import ns_to_seconds, seconds_to_ns
from recon.model.vehicle import VehicleState
from recon.station.control import authority, intents, missions
from recon.station.state import orders
from recon.station.state.orders import OrderRecord
from recon.station.state.outputs import Output
from recon.station.state.station import Station
from recon.station.state.stepped import Judge, Stepped
from recon.station.state.tracking import Tracking

_SPEAKS_WITHIN_S = 0.5
"""Who speaks more often is followed whenever it speaks: nothing is gained by looking between."""

FLOWN_BY_HAND_MPS = 2.0
"""In position mode an aircraft that nobody steers stands: gusts and GNSS noise stay under this."""

_LASTING = (Verdict.PILOT, Verdict.FAILSAFE)
_SENT_BY_LIFE = (Instruction.HOLD_SENT, Instruction.RETURN_SENT, Instruction.LAND_SENT)
"""Emergency orders not yet shown: their repeats and their alarm are the order's own matter."""


def follow(station: Station, serials: tuple[str, ...], now_ns: int, ask: Judge) -> Stepped:
    """Return the station after telemetry was read for these vehicles, and what is sent for it."""
    outputs: tuple[Output, ...] = ()
    for serial in serials:
        station, sent = _follow(station, serial, now_ns, ask)
        outputs += sent
    return station, outputs


def silent(station: Station, now_ns: int) -> tuple[str, ...]:
    """Return the vehicles that have not just been followed by their own telemetry."""
    limit_ns = seconds_to_ns(_SPEAKS_WITHIN_S)
    return tuple(
        serial
        for serial, vehicle in station.fleet.vehicles.items()
        if vehicle.core_received_at_ns is None or now_ns - vehicle.core_received_at_ns > limit_ns
    )


def _follow(station: Station, serial: str, now_ns: int, ask: Judge) -> Stepped:
    vehicle = station.fleet.vehicles.get(serial)
    if vehicle is None:
        return _forget(station, serial), ()
    station = _let_go_of_nothing(station, serial, vehicle, now_ns)
    station = _led_by_who_flies(station, serial, vehicle, now_ns)
    station = intents.stands(intents.count_passed(station, serial), serial)
    record = _record(station, serial)
    if record is not None:
        station = missions.watch_chain(station, record, vehicle, now_ns)
    reading = _reading(station, serial, vehicle)
    if reading is None:
        return station, ()
    follows = intents.following_of(station, serial)
    follows = replace(follows, read=vehicle.flight_mode)
    station = intents.with_following(station, serial, follows)
    return _apply(station, serial, vehicle, reading, now_ns, ask)


def _reading(station: Station, serial: str, vehicle: VehicleState) -> Reading | None:
    """Return what the newest mode means, None while there is no newer one or no newer place."""
    intent, following = _state(station, serial)
    told, mode = intents.told(intent, following), vehicle.flight_mode
    if told in _SENT_BY_LIFE or mode.value is None or mode.received_at_ns is None:
        return None
    core_ns = vehicle.core_received_at_ns
    is_new = mode.received_at_ns > following.told_at_ns and mode != following.read
    if not is_new or core_ns is None or core_ns < mode.received_at_ns:
        return None
    level = vehicle.gnss_signal_level.value
    place = intents.place_of(intent, vehicle, kind_of(mode.value, level))
    if place is None:
        return None
    return read(told, mode.value, level, place, following.mode_before)


def _apply(
    station: Station,
    serial: str,
    vehicle: VehicleState,
    reading: Reading,
    now_ns: int,
    ask: Judge,
) -> Stepped:
    verdict = reading.verdict
    if verdict in _LASTING:
        station, has_lasted = _doubted(station, serial, vehicle, verdict)
        if not (has_lasted or reading.is_at_once):
            return station, ()
        if verdict is Verdict.PILOT:
            return pilot_has_it(station, serial, reading.why, now_ns)
        return _failsafe(station, serial, reading.why, now_ns), ()
    if verdict is Verdict.FINISHED:
        return _finished(station, serial, vehicle, now_ns, ask)
    if verdict is Verdict.UNDECIDED:
        return _undecided(station, serial, vehicle, reading, now_ns), ()
    follows = intents.following_of(station, serial)
    by_sticks = verdict is Verdict.CARRIED_OUT and _is_steered(station, serial)
    seen = replace(
        follows,
        has_begun=follows.has_begun or by_sticks,
        doubt=None,
        mode_before=vehicle.flight_mode.value,
        link_id=vehicle.link_id,
    )
    return (station if seen == follows else intents.with_following(station, serial, seen)), ()


def _doubted(
    station: Station, serial: str, vehicle: VehicleState, verdict: Verdict
) -> tuple[Station, bool]:
    """Note a verdict that counts when it has lasted; return whether it has."""
    follows = intents.following_of(station, serial)
    told_ns = vehicle.flight_mode.received_at_ns or 0
    if follows.doubt is not verdict:
        doubted = replace(follows, doubt=verdict, doubt_since_ns=told_ns)
        return intents.with_following(station, serial, doubted), False
    lasted_s = ns_to_seconds(told_ns - follows.doubt_since_ns)
    return station, lasted_s >= station.settings.mode_lasts_s


def pilot_has_it(station: Station, serial: str, why: str, now_ns: int) -> Stepped:
    """Return the station after a pilot took a vehicle: the order behind what it did is superseded,
    nothing goes on, and the pilot leads."""
    record = _record(station, serial)
    if record is not None:
        is_landing = isinstance(record.command.body, LandNow)
        alarm = orders.LANDING_STOPPED if is_landing else None
        note = f"the pilot has taken over: {why}"
        station = _put(station, orders.ended(record, Phase.SUPERSEDED, now_ns, note, alarm=alarm))
    station, outputs = authority.pilot_has_it(station, serial, now_ns, why)
    return intents.let_go(station, serial, now_ns), outputs


def _failsafe(station: Station, serial: str, why: str, now_ns: int) -> Station:
    record = _record(station, serial)
    if record is not None:
        station = _put(station, orders.ended(record, Phase.FAILED, now_ns, why))
    return intents.let_go(station, serial, now_ns, failsafe=why)


def _finished(
    station: Station, serial: str, vehicle: VehicleState, now_ns: int, ask: Judge
) -> Stepped:
    record = _record(station, serial)
    if vehicle.is_flying.value is False:
        if record is not None:
            note = "by telemetry: it is on the ground"
            station = _put(station, orders.ended(record, Phase.DONE, now_ns, note))
        return intents.let_go(station, serial, now_ns), ()
    station = intents.holds_here(station, serial, now_ns)
    if record is None:
        return station, ()
    return missions.part_flown(station, record, now_ns, ask)


def _undecided(
    station: Station, serial: str, vehicle: VehicleState, reading: Reading, now_ns: int
) -> Station:
    """Nothing follows from a mode, unless it lasts, or the vehicle came back with it on another
    connection: then nobody knows any more what the vehicle does."""
    follows = intents.following_of(station, serial)
    mode = vehicle.flight_mode.value
    if mode is follows.mode_before:
        return station
    if follows.command_id is None and not follows.has_begun:
        return intents.with_following(station, serial, replace(follows, mode_before=mode))
    if not follows.has_begun:
        return station
    if vehicle.is_flying.value is False:
        return intents.let_go(station, serial, now_ns)
    station, _ = _doubted(station, serial, vehicle, Verdict.UNDECIDED)
    doubt_s = ns_to_seconds((vehicle.flight_mode.received_at_ns or 0) - _since_ns(station, serial))
    came_back = follows.link_id is not None and vehicle.link_id != follows.link_id
    if not came_back and doubt_s < station.settings.undecided_s:
        return station
    record = _record(station, serial)
    if record is not None:
        text = (
            f"it came back otherwise than it was left ({reading.why})"
            if came_back
            else (f"it is not seen to carry it out any more ({reading.why})")
        )
        station = _put(station, orders.ended(record, Phase.FAILED, now_ns, text))
    return intents.let_go(station, serial, now_ns)


def _since_ns(station: Station, serial: str) -> int:
    return intents.following_of(station, serial).doubt_since_ns


def _let_go_of_nothing(
    station: Station, serial: str, vehicle: VehicleState, now_ns: int
) -> Station:
    """An order that came to nothing before it began is no intent; a landing ends holds and
    failsafes."""
    intent, follows = _state(station, serial)
    record = station.orders.records.get(intent.command_id or 0)
    if serial not in station.trackings:
        station = intents.let_go(station, serial, now_ns)
        new = replace(
            intents.following_of(station, serial), is_unbidden=serial not in station.authorities
        )
        return intents.with_following(station, serial, new)
    if intent.commanded is not Commanded.NOTHING and intent.command_id != follows.command_id:
        return intents.follow_anew(station, serial)
    if record is not None and not follows.has_begun and record.phase in _CAME_TO_NOTHING:
        return intents.let_go(station, serial, now_ns)
    is_down = vehicle.is_flying.value is False
    is_over = intent.commanded is Commanded.HOLD and follows.has_begun
    if is_down and (is_over or follows.failsafe is not None):
        return intents.let_go(station, serial, now_ns)
    return station


def _led_by_who_flies(station: Station, serial: str, vehicle: VehicleState, now_ns: int) -> Station:
    """A vehicle that flies about in position mode, with nothing ordered here, is its pilot's.

    Other modes tell by the flight table who flies it; one that hovers may be anybody's.
    """
    intent, follows = _state(station, serial)
    if intent.commanded is not Commanded.NOTHING or vehicle.is_flying.value is None:
        return station
    if vehicle.is_flying.value is False:
        if follows.is_unbidden:
            return station
        return intents.with_following(station, serial, replace(follows, is_unbidden=True))
    is_flown = follows.is_unbidden and _moves_in_position_mode(vehicle)
    return authority.flies_unbidden(station, serial, now_ns) if is_flown else station


def _moves_in_position_mode(vehicle: VehicleState) -> bool:
    mode, velocity = vehicle.flight_mode.value, vehicle.velocity_ned.value
    if mode is None or velocity is None:
        return False
    is_neutral = kind_of(mode, vehicle.gnss_signal_level.value) is ModeKind.NEUTRAL
    return is_neutral and velocity.speed_mps >= FLOWN_BY_HAND_MPS


_CAME_TO_NOTHING = (Phase.TIMED_OUT, Phase.REFUSED_BY_APP, Phase.FAILED, Phase.EXPIRED)


def _is_steered(station: Station, serial: str) -> bool:
    """Whether a stream of sticks flies it: nobody else tells when that has begun."""
    record = _record(station, serial)
    return record is not None and isinstance(record.command.body, STEERED_BODIES)


def _forget(station: Station, serial: str) -> Station:
    kept = {key: follows for key, follows in station.trackings.items() if key != serial}
    told = {key: intent for key, intent in station.intents.items() if key != serial}
    return replace(station, trackings=kept, intents=told)


def _state(station: Station, serial: str) -> tuple[Intent, Tracking]:
    return station.intents.get(serial, intents.NOTHING), intents.following_of(station, serial)


def _record(station: Station, serial: str) -> OrderRecord | None:
    """The order behind what a vehicle does, while it lives."""
    intent = station.intents.get(serial, intents.NOTHING)
    record = station.orders.records.get(intent.command_id or 0)
    return None if record is None or record.phase.is_final else record


def _put(station: Station, record: OrderRecord) -> Station:
    book = orders.put(station.orders, record, station.settings.orders_kept)
    return replace(station, orders=book)
