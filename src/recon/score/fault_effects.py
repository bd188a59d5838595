"""Faults as they reach flights that go by events: what a link does to bytes has no place here."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from math import inf

from recon.score.drone import Drone
from recon.score.scenario import Scenario
from recon.sim.app.faults import FAILED_CELL_FRACTION, FaultKind, InjectedFault, draw_faults
from recon.sim.fleet import IMAGER_SERIAL

HOLDING = (FaultKind.PILOT_TAKES, FaultKind.GNSS_LOSS)
"""The drone hovers, or drifts with the wind, and cannot be had for as long."""
UNHEARD = (FaultKind.TELEMETRY_DROPOUT, FaultKind.RESTART)
"""The drone flies on; nobody sees where, nor that a mission has ended."""
IGNORING = (FaultKind.IGNORED_MISSIONS, FaultKind.ACK_THEN_NOTHING, FaultKind.NEGATIVE_ACK)
"""Missions that are given meanwhile are not flown."""
OF_DRONES = (
    *HOLDING,
    *UNHEARD,
    *IGNORING,
    FaultKind.LOW_BATTERY,
    FaultKind.FALLS_SILENT,
    FaultKind.GUSTS,
)
OF_THE_IMAGER = (
    *UNHEARD,
    FaultKind.FALLS_SILENT,
    FaultKind.CAMERA_STOPS,
    FaultKind.FRAMES_BLACK,
    FaultKind.FRAMES_REPEATED,
    FaultKind.FRAMES_TORN,
)
"""The eye tells nothing: there are no pictures, or the station takes none of these."""

Span = tuple[float, float]
"""From when to before when, in seconds since the run's start."""


@dataclass(frozen=True, slots=True)
class Mishap:
    """A fault that strikes one drone at a moment."""

    at_s: float
    serial: str
    fault: InjectedFault

    def strike(self, drones: Sequence[Drone]) -> None:
        """Let it happen."""
        drone = next(each for each in drones if each.serial == self.serial)
        until_s = self.at_s + self.fault.duration_s
        match self.fault.kind:
            case FaultKind.PILOT_TAKES:
                drone.hold(self.at_s, until_s)
            case FaultKind.GNSS_LOSS:
                drone.drift(self.at_s, until_s)
            case kind if kind in UNHEARD:
                drone.lose_word(self.at_s, until_s)
            case kind if kind in IGNORING:
                drone.ignore_missions(until_s)
            case FaultKind.LOW_BATTERY:
                drone.fail_cell(self.at_s, FAILED_CELL_FRACTION)
            case FaultKind.FALLS_SILENT:
                drone.fall(self.at_s)


def with_chances(scenario: Scenario, seed: int) -> Scenario:
    """Return a run's scenario: the faults that chance has for it among the others.

    They are those that the simulator draws for the same seed.
    """
    numbered = [(serial, index + 1) for index, serial in enumerate(scenario.fleet.serials)]
    drawn = [
        replace(fault, vehicle=serial)
        for serial, number in (*numbered, (IMAGER_SERIAL, len(numbered) + 1))
        for fault in draw_faults(scenario.chances, seed, serial, number)
    ]
    return replace(scenario, faults=(*scenario.faults, *drawn), chances=())


def mishaps_of(scenario: Scenario) -> list[Mishap]:
    """Return what strikes whom, in order of time, those of one moment by drone."""
    struck = [
        Mishap(fault.start_s, serial, fault)
        for fault in scenario.faults
        for index, serial in enumerate(scenario.fleet.serials)
        if fault.is_for(serial, index + 1) and fault.kind in OF_DRONES
    ]
    return sorted(struck, key=lambda each: (each.at_s, each.serial))


def gusty_spans(scenario: Scenario, serial: str) -> tuple[Span, ...]:
    """Return when there are gusts at a drone."""
    number = scenario.fleet.serials.index(serial) + 1
    return tuple(
        _span(fault)
        for fault in scenario.faults
        if fault.kind is FaultKind.GUSTS and fault.is_for(serial, number)
    )


def blind_spans(scenario: Scenario) -> tuple[Span, ...]:
    """Return when the eye tells nothing."""
    return tuple(
        _span(fault)
        for fault in scenario.faults
        if fault.kind in OF_THE_IMAGER and _is_for_the_imager(scenario, fault)
    )


def without_effect(scenario: Scenario) -> list[str]:
    """Return the names of the scenario's faults, by script or chance, that flights by events do
    not feel."""
    by_chance = (InjectedFault(c.kind, c.vehicle, c.from_s, c.longest_s) for c in scenario.chances)
    scenario = replace(scenario, faults=(*scenario.faults, *by_chance), chances=())
    struck = {mishap.fault for mishap in mishaps_of(scenario)}
    return sorted(
        {
            fault.kind.value
            for fault in scenario.faults
            if fault not in struck
            and not (fault.kind in OF_THE_IMAGER and _is_for_the_imager(scenario, fault))
        }
    )


def _is_for_the_imager(scenario: Scenario, fault: InjectedFault) -> bool:
    return fault.is_for(IMAGER_SERIAL, len(scenario.fleet.serials) + 1)


def _span(fault: InjectedFault) -> Span:
    ends = fault.kind is not FaultKind.FALLS_SILENT
    return fault.start_s, fault.start_s + fault.duration_s if ends else inf
