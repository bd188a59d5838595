"""Whether the watchdogs may hold a vehicle, by the site's failsafe matrix."""

from recon.model.failsafe_matrix import Activity, FailsafeCondition, Reaction
from recon.model.vehicle import VehicleState
from recon.station.failsafe.activity import activity_of
from recon.station.state.station import Station

_WATCHDOGS = (FailsafeCondition.GEOFENCE, FailsafeCondition.SEPARATION)
_LEFT_TO_THE_WATCHDOG = (FailsafeCondition.GEOFENCE, Activity.RETURNING)
"""The watchdog itself exempts vehicles that land or return from holds at a fence."""


def alarm_only(station: Station, vehicle: VehicleState) -> frozenset[FailsafeCondition]:
    """Return the conditions for which a vehicle gets an alarm and no hold."""
    rows = station.settings.failsafe_matrix.rows
    weak = [
        (condition, activity)
        for condition in _WATCHDOGS
        for activity, cell in rows[condition].items()
        if cell.reaction is not Reaction.HOLD and (condition, activity) != _LEFT_TO_THE_WATCHDOG
    ]
    if not weak:
        return frozenset()
    now = activity_of(station, vehicle)
    return frozenset(condition for condition, activity in weak if activity is now)
