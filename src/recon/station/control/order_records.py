"""New order records: refused, waiting or queued; and the end of the older orders they replace."""

from recon.fleet.confirmation import SentContext
from recon.link.outbox import Lane, lane_of
from recon.model.command import Body, Command, Hover, Phase, Refusal, ReturnHome
from recon.model.replacing import replace
from recon.model.units import seconds_to_ns
from recon.model.vehicle import VehicleState
from recon.safety import ApprovedCommand
from recon.station.state import orders
from recon.station.state.orders import OrderRecord, PhaseChange
from recon.station.state.station import Station
from recon.vehicles.packets import describe_altitudes


def put(station: Station, record: OrderRecord) -> Station:
    """Return the station with a record added, or replaced by its newer form."""
    book = orders.put(station.orders, record, station.settings.orders_kept)
    return replace(station, orders=book)


def target_of(station: Station, command: Command) -> VehicleState | None:
    """Return the state of a command's vehicle; None when there is no such vehicle or link."""
    return station.target(command.serial, command.link_id)


def refused_record(
    station: Station, command: Command, refusal: Refusal, now_ns: int
) -> OrderRecord:
    """Return the record of an order that the gate refused."""
    change = PhaseChange(Phase.REFUSED_BY_STATION, now_ns, refusal.reason)
    return OrderRecord(command, _name(station, command), (change,), refusal=refusal)


def may_wait(command: Command, refusal: Refusal) -> bool:
    """Return whether a stop is refused only because telemetry of a flying vehicle is stale."""
    return isinstance(command.body, Hover) and not command.takeoff and refusal.is_stale


def waiting_record(
    station: Station, command: Command, refusal: Refusal, now_ns: int
) -> OrderRecord:
    """Return the record of a stop that is sent as soon as telemetry returns."""
    expires_at_ns = now_ns + seconds_to_ns(station.settings.stop_waits_s)
    note = f"waits for telemetry: {refusal.reason}"
    return OrderRecord(
        command=replace(command, expires_at_ns=expires_at_ns),
        vehicle_name=_name(station, command),
        history=(PhaseChange(Phase.QUEUED, now_ns, note),),
        next_repeat_ns=now_ns,
        repeats_left=station.settings.emergency_repeats,
        waits_for_telemetry=True,
    )


def queued_record(
    station: Station, command: Command, approved: ApprovedCommand, now_ns: int
) -> OrderRecord:
    """Return the record of an order that the gate approved."""
    settings = station.settings
    repeat_ns = now_ns + seconds_to_ns(settings.emergency_repeat_s)
    target = target_of(station, command)
    note = _return_home_note(command.body, target)
    is_blind = isinstance(command.body, Hover) and not command.takeoff
    is_blind = is_blind and is_stale(station, target, now_ns)
    return OrderRecord(
        command=command,
        vehicle_name=_name(station, command),
        history=(PhaseChange(Phase.QUEUED, now_ns, note),),
        altitudes=describe_altitudes(command.body, approved.altitude_offset_m),
        next_repeat_ns=repeat_ns if command.is_emergency else None,
        repeats_left=settings.emergency_repeats if command.is_emergency else 0,
        waits_for_telemetry=is_blind,
        waiting_link_ids=approved.link_ids,
    )


def is_stale(station: Station, vehicle: VehicleState | None, now_ns: int) -> bool:
    """Return whether telemetry no longer shows whether a vehicle flies."""
    age_s = None if vehicle is None else vehicle.is_flying.age_s(now_ns)
    return age_s is None or age_s > station.settings.safety.fresh_telemetry_s


def steered_record(station: Station, command: Command, now_ns: int) -> OrderRecord:
    """Return the record of a steered order that the gate approved; its setpoints follow."""
    queued = PhaseChange(Phase.QUEUED, now_ns, "")
    return OrderRecord(command, _name(station, command), (queued,))


def replace_older_orders(station: Station, command: Command, now_ns: int) -> Station:
    """Return the station with older orders to the same vehicle ended, repeats and alarms included.

    Camera orders replace only camera orders: they must never end the repeats of a stop.
    """
    target = target_of(station, command)
    is_camera = lane_of(command) is Lane.CAMERA
    for record in station.orders.tracked:
        older = record.command
        if (lane_of(older) is Lane.CAMERA) is is_camera and target_of(station, older) is target:
            note = f"Replaced by order {command.id}"
            station = put(station, orders.ended(record, Phase.SUPERSEDED, now_ns, note))
    return station


def sent_context(station: Station, record: OrderRecord, now_ns: int) -> SentContext:
    """Return the telemetry at the moment a command is sent; a stale flight mode is unknown."""
    target = target_of(station, record.command)
    if target is None:
        return SentContext(now_ns, None, None)
    age_s = target.flight_mode.age_s(now_ns)
    is_fresh = age_s is not None and age_s <= station.settings.safety.fresh_telemetry_s
    mode = target.flight_mode.value if is_fresh else None
    return SentContext(now_ns, mode, target.is_flying.value, target.mission_id.value)


def _name(station: Station, command: Command) -> str:
    target = target_of(station, command)
    if target is not None:
        return target.display_name
    profile = station.fleet.profiles.get(command.serial or "")
    return profile.display_name if profile is not None else command.serial or "unknown"


def _return_home_note(body: Body, vehicle: VehicleState | None) -> str:
    """The climb at the start of a return home: the ICD has no field for its height."""
    if not isinstance(body, ReturnHome):
        return ""
    profile = None if vehicle is None else vehicle.profile
    height_m = None if profile is None else profile.go_home_height_m
    if height_m is None:
        return (
            "first climbs to the aircraft's go-home height, unknown here, unless it is already "
            "higher"
        )
    return (
        f"first climbs to the aircraft's go-home height, {height_m:g} m above its takeoff point "
        "by the site's file, unless it is already higher"
    )
