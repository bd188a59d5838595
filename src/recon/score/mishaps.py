"""Faults as they reach flights that go by events: what a link does to bytes has no place here."""

from collections.abc import Sequence
from dataclasses import dataclass

from recon.score.drone import Drone
from recon.score.scenario import Scenario
from recon.sim.faults import FAILED_CELL_FRACTION, Fault, FaultKind

HOLDING = (FaultKind.PILOT_TAKES, FaultKind.GNSS_LOSS)
"""The drone hovers under its pilot, and cannot be had for as long."""
UNHEARD = (FaultKind.TELEMETRY_DROPOUT, FaultKind.HALF_OPEN, FaultKind.RESTART)
"""The drone flies on; nobody sees where."""
REACHING = (*HOLDING, *UNHEARD, FaultKind.LOW_BATTERY)
"""All kinds that change anything in a flight by events."""


@dataclass(frozen=True, slots=True)
class Mishap:
    """A fault that strikes one drone at a moment."""

    at_s: float
    serial: str
    fault: Fault

    def strike(self, drones: Sequence[Drone]) -> None:
        """Let it happen."""
        drone = next(each for each in drones if each.serial == self.serial)
        until_s = self.at_s + self.fault.duration_s
        if self.fault.kind in HOLDING:
            drone.hold(self.at_s, until_s)
        elif self.fault.kind in UNHEARD:
            drone.lose_word(self.at_s, until_s)
        elif self.fault.kind is FaultKind.LOW_BATTERY:
            drone.fail_cell(self.at_s, FAILED_CELL_FRACTION)


def mishaps_of(scenario: Scenario) -> list[Mishap]:
    """Return what strikes whom, in order of time, those of one moment by drone."""
    struck = [
        Mishap(fault.start_s, serial, fault)
        for fault in scenario.faults
        for index, serial in enumerate(scenario.fleet.serials)
        if fault.is_for(serial, index + 1) and fault.kind in REACHING
    ]
    return sorted(struck, key=lambda each: (each.at_s, each.serial))


def without_effect(scenario: Scenario) -> list[str]:
    """Return the names of the scenario's faults that flights by events do not feel."""
    return sorted({f.kind.value for f in scenario.faults if f.kind not in REACHING})
