"""The watchdog runner: ten times a second the watchdogs check a picture of all traffic.

Their findings become alarms. A finding may require a hold: the runner returns a `HoldRequest`,
the kernel places it as an order like any other (judged by the gate, on record, repeated until
telemetry shows it), and reports the outcome with `after_hold`. A hold that was refused is requested
again after `hold_retry_s`; one that was sent lasts until a newer order or the landing.
"""

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass

from recon.model.event import SeparationHoldSwitched
from recon.model.replacing import replace
from recon.model.units import NS_PER_S, seconds_to_ns
from recon.model.vehicle import VehicleState
from recon.safety.watchdogs import (
    CommandedHold,
    Finding,
    TrafficPicture,
    Watchdog,
    WatchedVehicle,
    build_traffic_picture,
    hold_outcome,
)
from recon.station.failsafe import failsafe_holds
from recon.station.state.station import Station
from recon.station.state.watchdog_state import ActiveFinding, HoldRefused, StickCount
from recon.station.traffic import identity_grace
from recon.station.traffic.known_traffic import in_the_air


@dataclass(frozen=True, slots=True)
class HoldRequest:
    """A vehicle that the watchdogs hold, why, and how fast it flies now."""

    serial: str
    finding: Finding
    speed_mps: float


def run(
    station: Station, now_ns: int, watchdogs: Iterable[Watchdog]
) -> tuple[Station, tuple[HoldRequest, ...]]:
    """Return the station with the watchdogs' findings, if it is time, and their holds."""
    run_at_ns, settings = station.watchdog_state.run_at_ns, station.settings.safety.watchdogs
    if run_at_ns is not None and now_ns - run_at_ns < seconds_to_ns(settings.period_s):
        return station, ()
    station = identity_grace.with_unidentified(_with_stick_counts(station, now_ns), now_ns)
    refused = _lately_refused(station, now_ns)
    station = replace(
        station, watchdog_state=replace(station.watchdog_state, holds_refused=refused)
    )
    kept = station.watchdog_state.findings
    picture = build_traffic_picture(
        _watched(station, now_ns),
        station.airspace,
        station.settings.safety,
        now_ns,
        {key: one.since_ns for key, one in kept.items()},
        is_hold_on=station.watchdog_state.is_hold_on,
    )
    findings = [finding for watchdog in watchdogs for finding in watchdog(picture)]
    watch = replace(
        station.watchdog_state,
        run_at_ns=now_ns,
        findings=_kept(kept, findings, now_ns, seconds_to_ns(settings.lingers_s)),
        held=_still_held(station),
    )
    return replace(station, watchdog_state=watch), _requests(findings, picture)


def switch_hold(station: Station, event: SeparationHoldSwitched, _now_ns: int) -> Station:
    """Return the station after an operator switched the holds on or off."""
    watch = replace(station.watchdog_state, is_hold_on=event.is_on, switched_by=event.by)
    return replace(station, watchdog_state=watch)


def _watched(station: Station, now_ns: int) -> Iterator[WatchedVehicle]:
    watch = station.watchdog_state
    for vehicle, claimed in in_the_air(station):
        if vehicle.serial != claimed and _is_connected(station, claimed):
            continue  # a link in conflict: most likely telemetry of the same aircraft
        if identity_grace.is_in_grace(station, vehicle, now_ns):
            continue
        serial = vehicle.serial or ""
        control = station.control(serial)
        count = watch.sticks.get(serial)
        refused = watch.holds_refused.get(serial)
        quiet_s = None if count is None else (now_ns - count.changed_at_ns) / NS_PER_S
        yield WatchedVehicle(
            vehicle,
            control.intent,
            control.authority.holder,
            held=watch.held.get(serial),
            is_imager=vehicle.serial in station.imaging.imagers,
            stick_quiet_s=quiet_s,
            hold_refused="" if refused is None else refused.why,
            alarm_only=failsafe_holds.alarm_only(station, vehicle),
        )


def _is_connected(station: Station, serial: str | None) -> bool:
    vehicle = station.fleet.vehicles.get(serial or "")
    return vehicle is not None and vehicle.link_id is not None


def _with_stick_counts(station: Station, now_ns: int) -> Station:
    """Note for each setpoint stream when its last setpoint was sent."""
    if not station.streaming and not station.watchdog_state.sticks:
        return station
    counts: dict[str, StickCount] = {}
    for serial, stream in station.streams():
        if stream.closing is not None:
            continue
        before = station.watchdog_state.sticks.get(serial)
        known = (stream.started_at_ns, stream.packets_sent)
        is_same = before is not None and (before.started_at_ns, before.sent) == known
        counts[serial] = before if before and is_same else StickCount(*known, now_ns)
    return replace(station, watchdog_state=replace(station.watchdog_state, sticks=counts))


def _kept(
    kept: Mapping[str, ActiveFinding], findings: Iterable[Finding], now_ns: int, lingers_ns: int
) -> dict[str, ActiveFinding]:
    """Findings of now and of a moment ago: alarms must not flicker."""
    still = {key: one for key, one in kept.items() if now_ns - one.seen_ns <= lingers_ns}
    for finding in findings:
        before = still.get(finding.key)
        since_ns = now_ns if before is None else before.since_ns
        still[finding.key] = ActiveFinding(finding, since_ns, now_ns)
    return still


def _still_held(station: Station) -> dict[str, CommandedHold]:
    """The holds in force: no newer order, and not landed."""
    return {
        serial: held
        for serial, held in station.watchdog_state.held.items()
        if held.holds_against(station.control(serial).intent)
        and _may_fly(station.fleet.vehicles.get(serial))
    }


def _lately_refused(station: Station, now_ns: int) -> dict[str, HoldRefused]:
    """The holds that were refused, until they are to be tried again."""
    retry_ns = seconds_to_ns(station.settings.safety.watchdogs.hold_retry_s)
    refused = station.watchdog_state.holds_refused.items()
    return {serial: one for serial, one in refused if now_ns - one.at_ns < retry_ns}


def _may_fly(vehicle: VehicleState | None) -> bool:
    return vehicle is not None and vehicle.is_flying.value is not False


def after_hold(station: Station, request: HoldRequest, why_not: str | None, now_ns: int) -> Station:
    """Record a requested hold as sent, or why it was not; its finding's text states which."""
    serial, state = request.serial, station.watchdog_state
    if why_not is not None:
        refused = {**state.holds_refused, serial: HoldRefused(now_ns, why_not)}
        state = replace(state, holds_refused=refused)
    else:
        state = replace(
            state, held={**state.held, serial: CommandedHold(now_ns, request.speed_mps)}
        )
    words = hold_outcome(state.held.get(serial), why_not or "")
    outcome = f"; {station.fleet.vehicles[serial].display_name} {words}"
    key = request.finding.key
    if outcome not in request.finding.text:  # or it was held before, and is held again
        finding = replace(request.finding, text=f"{request.finding.text}{outcome}")
        kept = replace(state.findings[key], finding=finding)
        state = replace(state, findings={**state.findings, key: kept})
    return replace(station, watchdog_state=state)


def _requests(findings: Iterable[Finding], picture: TrafficPicture) -> tuple[HoldRequest, ...]:
    """Return one hold for each vehicle that needs one; the last finding gives the reason."""
    wanted = {finding.holds: finding for finding in findings if finding.holds is not None}
    speeds_mps = {
        one.state.serial: one.motion.speed_mps for one in picture.flying if one.motion is not None
    }
    return tuple(
        HoldRequest(serial, finding, speeds_mps.get(serial, 0.0))
        for serial, finding in wanted.items()
        if serial is not None
    )
