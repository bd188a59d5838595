"""The rows of the failsafe matrix, one file each. Pure.

A row states when its condition holds for a vehicle in flight, what a site may choose to do about
it, and the default. The station's runner (`station/failsafe/runner.py`) keeps the times and orders
the reaction like any other order; geofence and separation are found and timed by the watchdogs.
"""

from collections.abc import Mapping

from recon.model.failsafe_matrix import FailsafeCondition, FailsafeMatrix
from recon.safety.failsafe import (
    attitude,
    battery_critical,
    battery_low,
    geofence,
    gnss_lost,
    imaging_drone_lost,
    link_lost,
    operator_gone,
    separation,
    station_overloaded,
    telemetry_lost,
    wind,
)
from recon.safety.failsafe.row import (
    FailsafeLimits,
    FailsafeRow,
    FlightFacts,
    RelatedFinding,
    SharedFacts,
    cell_words,
)

ROWS: Mapping[FailsafeCondition, FailsafeRow] = {
    module.ROW.condition: module.ROW
    for module in (
        link_lost,
        telemetry_lost,
        gnss_lost,
        battery_low,
        battery_critical,
        wind,
        attitude,
        geofence,
        separation,
        imaging_drone_lost,
        station_overloaded,
        operator_gone,
    )
}

DEFAULT_MATRIX = FailsafeMatrix({condition: row.default for condition, row in ROWS.items()})
"""What the station does at a site that states nothing."""
