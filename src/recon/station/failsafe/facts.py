"""The facts that the rows of the failsafe matrix are judged by, gathered from the station."""

from collections import defaultdict
from collections.abc import Iterator, Mapping
from dataclasses import dataclass

from recon.fleet.state import staleness
from recon.model.replacing import replace
from recon.model.units import NS_PER_S, seconds_to_ns
from recon.model.vehicle import Staleness, VehicleState
from recon.safety.failsafe import FailsafeLimits, FlightFacts, RelatedFinding, SharedFacts
from recon.safety.failsafe.row import NO_FINDINGS
from recon.station.state.failsafe_state import FailsafeState
from recon.station.state.settings import FailsafeSettings, StationSettings
from recon.station.state.station import Station

Findings = Mapping[str, Mapping[str, RelatedFinding]]
"""The watchdogs' findings by serial and rule."""


@dataclass(frozen=True, slots=True)
class RunFacts:
    """What is the same for all vehicles in one run."""

    limits: FailsafeLimits
    station: SharedFacts
    findings: Findings


def run_facts(station: Station, now_ns: int) -> RunFacts:
    """Return the facts of one run."""
    return RunFacts(limits_of(station.settings), station_facts(station, now_ns), _findings(station))


def limits_of(settings: StationSettings) -> FailsafeLimits:
    """Return the thresholds that the rows share with the alarms."""
    return FailsafeLimits(
        settings.low_battery_fraction,
        settings.serious_battery_fraction,
        settings.safety.preflight.strong_wind_level,
        settings.flight_alarms.max_tilt_deg,
    )


def station_facts(station: Station, now_ns: int) -> SharedFacts:
    """Return the facts of the station itself."""
    state = station.failsafe_state
    lost = [at_ns for _, at_ns in lost_imagers(station, now_ns)]
    return SharedFacts(
        state.late_since_ns if state.is_late else None,
        _operator_gone_since_ns(state, station.settings.failsafe, now_ns),
        frozenset(station.imaging.imagers),
        min(lost, default=None),
    )


def flight_facts(
    station: Station, vehicle: VehicleState, run: RunFacts, now_ns: int
) -> FlightFacts:
    """Return the facts of one vehicle."""
    link = station.fleet.links.get(-1 if vehicle.link_id is None else vehicle.link_id)
    opened_at_ns = link.opened_at_ns if link is not None and link.is_open else None
    findings = run.findings.get(vehicle.serial or "", NO_FINDINGS)
    return FlightFacts(vehicle, now_ns, opened_at_ns, run.limits, run.station, findings)


def with_times(state: FailsafeState, station: Station, now_ns: int) -> FailsafeState:
    """Return the state with the times of late steps and of connected clients brought up to date."""
    settings = station.settings.failsafe
    return _with_clients(_with_lateness(state, settings, now_ns), station, now_ns)


def _with_lateness(state: FailsafeState, settings: FailsafeSettings, now_ns: int) -> FailsafeState:
    gap_ns = 0 if state.ticked_ns is None else now_ns - state.ticked_ns
    late_ns = state.late_ns
    if gap_ns >= seconds_to_ns(settings.late_step_s):
        within_ns = seconds_to_ns(settings.late_within_s)
        late_ns = (*(at_ns for at_ns in late_ns if now_ns - at_ns <= within_ns), now_ns)
        if len(late_ns) > 1 or gap_ns >= seconds_to_ns(settings.suspended_s):
            since_ns = state.late_since_ns if state.is_late else now_ns
            gap_s = gap_ns / NS_PER_S
            state = replace(state, is_late=True, late_since_ns=since_ns, late_gap_s=gap_s)
    elif state.is_late and now_ns - late_ns[-1] > seconds_to_ns(settings.late_lasts_s):
        state = replace(state, is_late=False)
    return replace(state, ticked_ns=now_ns, late_ns=late_ns)


def _with_clients(state: FailsafeState, station: Station, now_ns: int) -> FailsafeState:
    since_ns = state.client_since_ns
    if not station.owners:
        if since_ns is None:
            return state
        return replace(state, client_since_ns=None, no_client_since_ns=now_ns)
    if since_ns is None:
        return replace(state, client_since_ns=now_ns, no_client_since_ns=None)
    stays_ns = seconds_to_ns(station.settings.failsafe.operator_stays_s)
    if state.had_operator or now_ns - since_ns < stays_ns:
        return state
    return replace(state, had_operator=True)


def _operator_gone_since_ns(
    state: FailsafeState, settings: FailsafeSettings, now_ns: int
) -> int | None:
    since_ns = state.no_client_since_ns
    if since_ns is None or not state.had_operator:
        return None
    return since_ns if now_ns - since_ns >= seconds_to_ns(settings.operator_gone_s) else None


def lost_imagers(station: Station, now_ns: int) -> Iterator[tuple[VehicleState, int]]:
    """Yield the imaging drones that are lost in flight, with their last telemetry's time."""
    for serial in station.imaging.imagers:
        imager = station.fleet.vehicles.get(serial)
        if imager is None or imager.is_flying.value is False or imager.core_received_at_ns is None:
            continue
        if station.control(serial).restored is not None:
            continue  # of the last run: nothing was lost in this one
        if staleness(imager, now_ns) in (Staleness.LOST, Staleness.SILENT):
            yield imager, imager.core_received_at_ns


def _findings(station: Station) -> Findings:
    found: dict[str, dict[str, RelatedFinding]] = defaultdict(dict)
    for kept in station.watchdog_state.findings.values():
        finding = kept.finding
        if finding.serial is not None and finding.rule in _RULES_READ:
            found[finding.serial][finding.rule] = RelatedFinding(finding.severity, kept.since_ns)
    return found


_RULES_READ = frozenset({"battery_home"})
"""Rules of the watchdog findings that a row is judged by."""
