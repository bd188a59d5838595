"""What judging a core packet costs, beside storing it without a judgement in the same run.

Times are the processor's, so that what else runs on the machine does not count.

    python -m benches.fleet.bench_trust
"""

import sys
from collections.abc import Callable
from random import Random
from time import process_time

from recon.fleet.settings import FleetSettings
from recon.fleet.telemetry import fold_core, fold_extended
from recon.geo.distance import moved_m
from recon.model.geo import LatLon
from recon.model.replacing import replace
from recon.model.report import CoreReport, ExtendedReport
from recon.model.units import Stamped
from recon.model.vehicle import (
    Attitude,
    BatteryWarning,
    CameraState,
    FlightMode,
    VehicleState,
    VelocityNed,
)

PACKETS = 5_000
ROUNDS = 7
PERIOD_NS = 100_000_000
BUDGET_US = 20.0
SETTINGS = FleetSettings()
Fold = Callable[[VehicleState, CoreReport, int, FleetSettings], VehicleState]
HOME = LatLon(42.0, -93.6)
EXTENDED = ExtendedReport(
    "A", 14, 5, False, False, 0.8, BatteryWarning.NONE, 0, CameraState.FEED_OFF, FlightMode(10), 1
)


def flight(*, is_flying: bool) -> list[CoreReport]:
    """Packets of a vehicle that flies north at 8 m/s, as noisy as measured ones."""
    random = Random(1)
    speed_mps = 8.0 if is_flying else 0.0
    return [
        CoreReport(
            is_flying,
            moved_m(HOME, 0.1 * speed_mps * number % 2_000, random.gauss(0.0, 0.1)),
            300.0,
            40.0 + random.gauss(0.0, 0.1),
            VelocityNed(speed_mps, random.gauss(0.0, 0.1), 0.0),
            Attitude(random.gauss(0.0, 1.0), 0.0, 0.0),
        )
        for number in range(PACKETS)
    ]


def store(
    state: VehicleState, report: CoreReport, now_ns: int, _settings: FleetSettings
) -> VehicleState:
    """Store a packet as it is: the baseline."""
    return replace(
        state,
        is_flying=Stamped(report.is_flying, now_ns),
        reported_is_flying=Stamped(report.is_flying, now_ns),
        position=Stamped(report.position, now_ns),
        height_above_takeoff_m=Stamped(report.height_above_takeoff_m, now_ns),
        reported_altitude_m=Stamped(report.reported_altitude_m, now_ns),
        velocity_ned=Stamped(report.velocity_ned, now_ns),
        attitude=Stamped(report.attitude, now_ns),
        altitude_offset_m=Stamped(260.0, now_ns),
        core_received_at_ns=now_ns,
    )


def cost_us(fold: Fold, reports: list[CoreReport]) -> float:
    """Return the least time per packet of some rounds, in microseconds."""
    best_s = float("inf")
    for _ in range(ROUNDS):
        state = fold_extended(VehicleState("A"), EXTENDED, 1, SETTINGS)
        started_s, now_ns = process_time(), 2
        for report in reports:
            now_ns += PERIOD_NS
            state = fold(state, report, now_ns, SETTINGS)
        best_s = min(best_s, process_time() - started_s)
    return 1e6 * best_s / len(reports)


def main() -> int:
    """Print the costs; return 1 when the judgement takes more than its budget."""
    flying, standing = flight(is_flying=True), flight(is_flying=False)
    in_doubt = [flying[0], *(replace(report, is_flying=False) for report in flying[1:])]
    is_kept = True
    for name, reports in (
        ("in flight", flying),
        ("on the ground", standing),
        ("in flight, reporting the ground", in_doubt),
    ):
        stored_us, judged_us = cost_us(store, reports), cost_us(fold_core, reports)
        is_kept = is_kept and judged_us - stored_us < BUDGET_US
        print(
            f"a core packet {name}: {judged_us:.1f} us judged, {stored_us:.1f} us stored only; "
            f"judging {judged_us - stored_us:.1f} us, budget {BUDGET_US:g} us"
        )
    return 0 if is_kept else 1


if __name__ == "__main__":
    sys.exit(main())
