"""The station's state, as the API sends it."""

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from enum import Enum
from functools import lru_cache
from typing import Any

from recon.api import schema
from recon.fleet import pairing
from recon.fleet.link_quality import link_figures
from recon.fleet.state import Fleet, LinkRecord, staleness
from recon.link.session import Session
from recon.model.control import StopLatch
from recon.model.imagery import Frame
from recon.model.units import Stamped
from recon.model.vehicle import AltitudeReference, VehicleState
from recon.station.api_views.ages import known_since_s, since_s
from recon.station.api_views.app_facts_view import app_facts_view, photo_tally_view
from recon.station.api_views.imaging_views import ground_image_view, shade_view
from recon.station.api_views.light_sensor_views import light_sensors_view
from recon.station.api_views.operation_views import operation_fields
from recon.station.api_views.vehicle_views import (
    authority_view,
    doubt_views,
    hazard_view,
    lease_view,
    override_view,
    steering_view,
)
from recon.station.api_views.zone_views import zone_views
from recon.station.state.alarm_book import Alarm
from recon.station.state.orders import OrderRecord
from recon.station.state.station import Station

SHOWN_ORDERS = 50
TRACK_POINTS_SHOWN = 120
TRACK_DIGITS = 6
"""A tenth of a metre, finer than GNSS: the tracks are most of a state's bytes."""
PLACE_DIGITS = 8
"""A millimetre; further digits cannot be compressed."""
TrackView = list[tuple[float, float]]
DIGITS = 3
"""Decimals of seconds, metres, metres per second and degrees of angle."""


class TrackViews:
    """The tracks as they are sent, each made again only when it has changed."""

    def __init__(self) -> None:
        self._made: dict[str | None, tuple[object, TrackView]] = {}

    def of(self, vehicle: VehicleState) -> TrackView:
        """Return the newest points of a vehicle's track."""
        track, (made_of, view) = vehicle.track, self._made.get(vehicle.serial, (None, []))
        if made_of is not track:
            view = [
                (round(p.longitude_deg, TRACK_DIGITS), round(p.latitude_deg, TRACK_DIGITS))
                for p in track[-TRACK_POINTS_SHOWN:]
            ]
            self._made[vehicle.serial] = track, view
        return view


@dataclass(frozen=True, slots=True)
class DriverState:
    """What the view needs besides the station's state: sessions and facts of the driver."""

    sessions: dict[int, Session]
    station: schema.StationView
    site: schema.SiteView | None
    numbers: Mapping[str, int]
    """The number of each serial."""
    tracks: TrackViews
    replay: schema.ReplayView | None = None


def state_view(station: Station, around: DriverState, now_ns: int) -> schema.StationState:
    """Return everything a console shows, with ages as of `now_ns`."""
    return schema.StationState(
        time_ns=now_ns,
        station=around.station,
        site=around.site,
        vehicles=_vehicles(station, around.numbers, around.tracks, now_ns),
        links=[_link(station.fleet, r, around, now_ns) for r in station.fleet.links.values()],
        commands=_commands(station, now_ns),
        alarms=[_alarm(alarm, now_ns) for alarm in station.alarms.alarms.values()],
        stop_latch=_stop_latch(station.stop_latch, now_ns),
        temporary_zones=zone_views(station, now_ns),
        ground_image=ground_image_view(station, now_ns),
        shade=shade_view(station, now_ns),
        light_sensors=light_sensors_view(station, now_ns),
        replay=around.replay,
        **operation_fields(station, now_ns),
    )


def _stop_latch(latch: StopLatch | None, now_ns: int) -> schema.StopLatchView | None:
    if latch is None:
        return None
    # After a restart the clock may be behind that of the last run.
    age_s = max(0.0, since_s(latch.at_ns, now_ns))
    return schema.StopLatchView(by=latch.by, age_s=age_s, released=sorted(latch.released))


def _vehicles(
    station: Station, numbers: Mapping[str, int], tracks: TrackViews, now_ns: int
) -> list[schema.VehicleView]:
    known = [
        _vehicle(station, vehicle, numbers[serial], tracks, now_ns)
        for serial, vehicle in sorted(
            station.fleet.vehicles.items(), key=lambda item: numbers[item[0]]
        )
    ]
    unidentified = [
        _vehicle(station, link.own_state, 0, tracks, now_ns)
        for link in station.fleet.unbound_links()
        if link.claimed_serial is None and link.own_state.core_received_at_ns is not None
    ]
    lost = [
        _vehicle(station, state, 0, tracks, now_ns)
        for state in station.watchdog_state.lost.values()
    ]
    return known + unidentified + lost


def _vehicle(
    station: Station, vehicle: VehicleState, number: int, tracks: TrackViews, now_ns: int
) -> schema.VehicleView:
    profile = vehicle.profile
    reference = AltitudeReference.UNSET if profile is None else profile.waypoint_altitude
    aged, tally = _Aging(now_ns), vehicle.photo_tally
    return schema.VehicleView(
        number=number,
        serial=vehicle.serial,
        link_id=vehicle.link_id,
        name=vehicle.display_name,
        model="unknown model" if profile is None else profile.model,
        camera=None if profile is None else profile.camera,
        is_simulated=vehicle.is_simulated,
        is_imager=vehicle.serial in station.imaging.imagers,
        authority=authority_view(station, vehicle.serial, now_ns),
        lease=lease_view(station, vehicle.serial, now_ns),
        is_stopped=station.is_stopped(vehicle.serial),
        preflight_override=override_view(station, vehicle.serial, now_ns),
        steering=steering_view(station, vehicle.serial),
        staleness=staleness(vehicle, now_ns).value,
        telemetry_age_s=known_since_s(vehicle.core_received_at_ns, now_ns),
        is_flying=aged.flag(vehicle.is_flying),
        reported_is_flying=aged.flag(vehicle.reported_is_flying),
        doubts=doubt_views(vehicle, now_ns),
        position=aged.parts(
            schema.PositionView,
            vehicle.position,
            ("latitude_deg", "longitude_deg"),
            PLACE_DIGITS,
        ),
        height_above_takeoff_m=aged.number(vehicle.height_above_takeoff_m),
        reported_altitude_m=aged.number(vehicle.reported_altitude_m),
        velocity_ned=aged.parts(
            schema.VelocityView, vehicle.velocity_ned, ("north_mps", "east_mps", "down_mps")
        ),
        attitude=aged.parts(
            schema.AttitudeView, vehicle.attitude, ("yaw_deg", "pitch_deg", "roll_deg")
        ),
        battery_fraction=aged.number(vehicle.battery_fraction),
        battery_warning=aged.word(vehicle.battery_warning),
        gnss_satellite_count=aged.number(vehicle.gnss_satellite_count),
        gnss_signal_level=aged.number(vehicle.gnss_signal_level),
        wind_level=aged.number(vehicle.wind_level),
        flight_mode=aged.word(vehicle.flight_mode),
        mission_id=aged.number(vehicle.mission_id),
        camera_state=aged.word(vehicle.camera_state),
        waypoint_altitude=reference.value,
        flies_missions=vehicle.flies_missions,
        conflict_link_ids=list(vehicle.rival_link_ids),
        app_facts=_facts(vehicle),
        app_facts_age_s=aged.age_s(vehicle.app_facts),
        photos=None if tally is None else photo_tally_view(tally),
        newest_photo_age_s=None if tally is None else known_since_s(tally.newest_at_ns, now_ns),
        track=tracks.of(vehicle),
        frame=_frame(station.frames.get(vehicle.serial or ""), now_ns),
        hazard=hazard_view(station, vehicle, now_ns),
    )


def _facts(vehicle: VehicleState) -> schema.AppFactsView | None:
    facts = vehicle.app_facts.value
    return None if facts is None else app_facts_view(facts)


@dataclass(frozen=True, slots=True)
class _Aging:
    """Turns stamped values into views with ages, without the digits that mean nothing."""

    now_ns: int

    def age_s(self, stamped: Stamped[Any]) -> float | None:
        return known_since_s(stamped.received_at_ns, self.now_ns)

    def number(self, stamped: Stamped[Any]) -> schema.AgedNumber:
        return _aged_number(_rounded(stamped.value, DIGITS), self.age_s(stamped))

    def flag(self, stamped: Stamped[bool]) -> schema.AgedFlag:
        return _aged_flag(stamped.value, self.age_s(stamped))

    def word(self, stamped: Stamped[Any]) -> schema.AgedText:
        value: Enum | None = stamped.value
        return _aged_text(None if value is None else value.name.lower(), self.age_s(stamped))

    def parts(
        self,
        view: Callable[..., Any],
        stamped: Stamped[Any],
        names: Iterable[str],
        digits: int = DIGITS,
    ) -> Any:
        values = {name: _rounded(getattr(stamped.value, name, None), digits) for name in names}
        return view(**values, age_s=self.age_s(stamped))


# Levels, modes and flags are few, and so are ages in milliseconds: most views have been made
# before.
@lru_cache(maxsize=8192)
def _aged_number(value: float | None, age_s: float | None) -> schema.AgedNumber:
    return schema.AgedNumber(value=value, age_s=age_s)


@lru_cache(maxsize=8192)
def _aged_flag(value: bool | None, age_s: float | None) -> schema.AgedFlag:
    return schema.AgedFlag(value=value, age_s=age_s)


@lru_cache(maxsize=8192)
def _aged_text(value: str | None, age_s: float | None) -> schema.AgedText:
    return schema.AgedText(value=value, age_s=age_s)


def _rounded(value: float | None, digits: int) -> float | None:
    return None if value is None else round(float(value), digits)


def _frame(frame: Frame | None, now_ns: int) -> schema.FrameView | None:
    if frame is None:
        return None
    return schema.FrameView(
        id=frame.id,
        received_age_s=since_s(frame.received_at_ns, now_ns),
        captured_age_s=since_s(frame.captured_at_ns, now_ns),
        captured_sigma_s=frame.captured_sigma_s,
    )


def _link(fleet: Fleet, record: LinkRecord, around: DriverState, now_ns: int) -> schema.LinkView:
    session = around.sessions.get(record.id)
    counters = None if session is None else session.counters
    return schema.LinkView(
        id=record.id,
        remote_address=record.remote_address,
        status=_link_status(fleet, record),
        claimed_serial=record.claimed_serial,
        waiting=_waiting(fleet, record, now_ns),
        opened_age_s=since_s(record.opened_at_ns, now_ns),
        last_packet_age_s=known_since_s(record.last_packet_at_ns, now_ns),
        closed_reason=record.closed_reason,
        bytes_received=0 if session is None else session.bytes_received,
        packets_received=record.packets,
        images_received=record.images,
        bad_hash=0 if counters is None else counters.bad_hash,
        bad_size=0 if counters is None else counters.bad_size,
        unknown_pid=0 if counters is None else counters.unknown_pid,
        ignored_reports=record.ignored_reports,
        bytes_skipped=0 if counters is None else counters.bytes_skipped,
        commands_queued=0 if session is None else session.commands_queued,
        ignored_answers=0 if session is None else session.acks.ignored_late,
        figures=_link_figures(record, now_ns),
    )


def _link_figures(record: LinkRecord, now_ns: int) -> schema.LinkFiguresView | None:
    found = link_figures(record.arrivals, now_ns) if record.is_open else None
    if found is None:
        return None
    return _figures(
        round(found.rate_hz, 1), round(found.jitter_s, 2), round(found.longest_gap_s, 1), found.bars
    )


@lru_cache(maxsize=4096)
def _figures(
    rate_hz: float, jitter_s: float, longest_gap_s: float, bars: int
) -> schema.LinkFiguresView:
    """Links whose telemetry comes evenly have the same few figures in all messages."""
    return schema.LinkFiguresView(
        rate_hz=rate_hz, jitter_s=jitter_s, longest_gap_s=longest_gap_s, bars=bars
    )


def _waiting(fleet: Fleet, record: LinkRecord, now_ns: int) -> schema.WaitingAppView | None:
    if not record.is_waiting or record.waits_since_ns is None:
        return None
    return schema.WaitingAppView(
        serial=record.waiting_serial,
        age_s=since_s(record.waits_since_ns, now_ns),
        reason=pairing.objection(fleet, record),
        is_flying=record.own_state.is_flying.value,
    )


def _link_status(fleet: Fleet, record: LinkRecord) -> Any:
    if not record.is_open:
        return "closed"
    if record.is_waiting:
        return "waiting"
    if record.claimed_serial is None:
        return "unidentified"
    vehicle = fleet.vehicles.get(record.claimed_serial)
    has_rivals = vehicle is not None and bool(vehicle.rival_link_ids)
    return "conflict" if has_rivals else "identified"


def _commands(station: Station, now_ns: int) -> list[schema.CommandView]:
    newest = sorted(station.orders.records.values(), key=_issued, reverse=True)
    # A stick stream is one order; its packets are counted in the stream.
    sticks = {stream.command.id: stream.packets_sent for _, stream in station.streams()}
    return [
        _command(record, sticks.get(record.command.id, record.times_sent), now_ns)
        for record in newest[:SHOWN_ORDERS]
    ]


def _issued(record: OrderRecord) -> tuple[int, int]:
    return record.command.issued_at_ns, record.command.id


def _command(record: OrderRecord, times_sent: int, now_ns: int) -> schema.CommandView:
    command = record.command
    return schema.CommandView(
        id=command.id,
        kind=command.name,
        serial=command.serial,
        link_id=command.link_id,
        vehicle_name=record.vehicle_name,
        issued_by=command.issued_by,
        age_s=since_s(command.issued_at_ns, now_ns),
        phase=record.phase.value,
        is_final=record.phase.is_final,
        note=record.note,
        rule=None if record.refusal is None else record.refusal.rule,
        parameters={} if record.refusal is None else dict(record.refusal.parameters),
        times_sent=times_sent,
        takeoff=command.takeoff,
        sent_altitudes=record.altitudes,
        part=None if record.plan is None else record.plan.label or None,
        repairs=[] if record.plan is None else list(record.plan.repairs),
        history=[
            schema.PhaseView(
                phase=change.phase.value,
                age_s=since_s(change.at_ns, now_ns),
                note=change.note,
            )
            for change in record.history
        ],
    )


def _alarm(alarm: Alarm, now_ns: int) -> schema.AlarmView:
    condition = alarm.condition
    return schema.AlarmView(
        id=alarm.id,
        severity=condition.severity.value,
        rule=condition.rule,
        serial=condition.serial,
        link_id=condition.link_id,
        vehicle_name=condition.vehicle_name,
        text=condition.text,
        raised_age_s=since_s(alarm.raised_at_ns, now_ns),
        is_active=alarm.is_active,
        is_acknowledged=alarm.acknowledged_by is not None,
    )
