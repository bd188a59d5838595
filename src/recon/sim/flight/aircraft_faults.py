"""Faults of the aircraft: what each does to it when it begins, and when it ends."""

from collections.abc import Callable
from math import nan
from random import Random

from recon.sim.app.faults import FAILED_CELL_FRACTION, STALE_BY_M, FaultKind
from recon.sim.app.telemetry import HomeAltitude
from recon.sim.flight.air import Squall
from recon.sim.flight.aircraft import Aircraft


class AircraftFaults:
    """Begins and ends the faults of one aircraft; how many of a kind overlap does not matter."""

    def __init__(self, aircraft: Aircraft, altitude: HomeAltitude, seed: str) -> None:
        self._aircraft = aircraft
        self._altitude = altitude
        self._headings = Random(f"{seed}/gusts")
        self._running: dict[FaultKind, int] = {}
        self._begins: dict[FaultKind, Callable[[], None]] = {
            FaultKind.PILOT_TAKES: aircraft.pilot_takes,
            FaultKind.LOW_BATTERY: lambda: aircraft.battery.lose_a_cell(FAILED_CELL_FRACTION),
            FaultKind.GNSS_LOSS: aircraft.lose_gnss,
            FaultKind.GUSTS: self._begin_squall,
            FaultKind.FALLS_SILENT: aircraft.crash,
            FaultKind.TAKEOFF_ALTITUDE_LOST: lambda: self._mistake(nan),
            FaultKind.TAKEOFF_ALTITUDE_STALE: lambda: self._mistake(STALE_BY_M),
        }
        self._ends: dict[FaultKind, Callable[[], None]] = {
            FaultKind.PILOT_TAKES: aircraft.pilot_gives_back,
            FaultKind.GNSS_LOSS: aircraft.find_gnss,
            FaultKind.GUSTS: aircraft.air.end_squall,
            FaultKind.TAKEOFF_ALTITUDE_LOST: lambda: self._mistake(0.0),
            FaultKind.TAKEOFF_ALTITUDE_STALE: lambda: self._mistake(0.0),
        }

    def begin(self, kind: FaultKind) -> None:
        """Let a fault begin."""
        self._running[kind] = self._running.get(kind, 0) + 1
        self._begins[kind]()

    def end(self, kind: FaultKind) -> None:
        """Let a fault end, unless another of its kind is still on."""
        self._running[kind] -= 1
        if self._running[kind] == 0 and kind in self._ends:
            self._ends[kind]()

    def _begin_squall(self) -> None:
        squall = Squall(self._headings.uniform(0.0, 360.0))
        self._aircraft.air.begin_squall(squall, self._aircraft.now_ns)

    def _mistake(self, error_m: float) -> None:
        self._altitude.fault_m = error_m
