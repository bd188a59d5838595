"""What an app reports of an action that failed, beside the order that it belongs to.

An outcome changes nothing of an order's phase: telemetry and time decide that, as for every app.
"""

from recon.model.app_report import AppAction, OutcomeReport
from recon.model.command import Body, FlyMission, LockCamera, Phase
from recon.model.replacing import replace
from recon.model.vehicle import VehicleState
from recon.station.control.order_records import put
from recon.station.state.orders import OrderRecord, PhaseChange
from recon.station.state.station import Station

_BODIES: dict[AppAction, type[Body]] = {
    AppAction.MISSION_UPLOAD: FlyMission,
    AppAction.MISSION_LOAD: FlyMission,
    AppAction.MISSION_START: FlyMission,
    AppAction.MISSION_FLIGHT: FlyMission,
    AppAction.LOCK_CAMERA: LockCamera,
    AppAction.UNLOCK_CAMERA: LockCamera,
}
_NOTED_IN = (Phase.ACKNOWLEDGED, Phase.CONFIRMED, Phase.STARTED)
MOST_CHANGES = 24
"""Most entries of an order's history for which an outcome is noted: an app may send any number."""


def on_outcome(
    station: Station, vehicle: VehicleState, report: OutcomeReport, now_ns: int
) -> Station:
    """Return the station with a failure noted at the newest order that it is about, if any."""
    body = _BODIES.get(report.action)
    if report.ok or body is None or vehicle.serial is None:
        return station
    record = _newest(station, vehicle.serial, body)
    note = f"its app: {_sentence(report)}"
    if record is None or record.note == note or len(record.history) >= MOST_CHANGES:
        return station
    change = PhaseChange(record.phase, now_ns, note)
    return put(station, replace(record, history=(*record.history, change)))


def _newest(station: Station, serial: str, body: type[Body]) -> OrderRecord | None:
    found = [
        record
        for record in station.orders.tracked
        if record.command.serial == serial
        and isinstance(record.command.body, body)
        and record.phase in _NOTED_IN
    ]
    return max(found, key=lambda record: record.command.id, default=None)


def _sentence(report: OutcomeReport) -> str:
    what = report.text or f"{report.action.value.replace('_', ' ')} failed"
    return what if report.code is None else f"{what} (DJI's code {report.code})"
