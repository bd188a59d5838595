"""What active faults do to packets and to the aircraft; all random values come from the seed."""

from collections.abc import Callable
from math import nan
from random import Random

from recon import wire
from recon.model.units import seconds_to_ns
from recon.sim.app.faults import (
    FAILED_CELL_FRACTION,
    HOME_MOVED_BY_M,
    LOW_GO_HOME_M,
    STALE_BY_M,
    FaultKind,
    InjectedFault,
)
from recon.sim.app.telemetry import HomeAltitude
from recon.sim.camera.frames import Black, FrameFlaw, exposed, torn
from recon.sim.flight.air import Squall
from recon.sim.flight.aircraft import Aircraft

BURST_S = 1.5
"""Telemetry in the field comes in bursts, with gaps of a second and more while video runs."""
ACK_DELAY_S = (0.5, 3.0)
"""The upper end is longer than the station's retry interval, so that retries are exercised."""
CORRUPTED_SHARE = 0.1
"""Share of packets; each of these has one to three bytes changed."""
MOST_CHANGED_BYTES = 3


class FaultSchedule:
    """Which faults of one vehicle are active when, and what they do to its packets."""

    def __init__(self, seed: str, start_ns: int) -> None:
        self._by_kind: dict[FaultKind, list[InjectedFault]] = {}
        self._start_ns = start_ns
        self._delays = Random(f"{seed}/delays")
        self._changes = Random(f"{seed}/changes")
        self._flaws = Random(f"{seed}/frames")
        self._repeated: dict[type, wire.Packet] = {}

    def add(self, fault: InjectedFault) -> None:
        """Add a fault."""
        self._by_kind.setdefault(fault.kind, []).append(fault)

    def active(self, kind: FaultKind, now_ns: int) -> InjectedFault | None:
        """Return the active fault of a kind (the last listed of several), else None."""
        faults = self._by_kind.get(kind) if self._by_kind else None
        if faults is None:
            return None
        elapsed_ns = now_ns - self._start_ns
        on = [fault for fault in faults if fault.is_active(elapsed_ns)]
        return on[-1] if on else None

    def has(self, kind: FaultKind, now_ns: int) -> bool:
        """Return whether a fault of a kind is active."""
        return self.active(kind, now_ns) is not None

    def send_time_ns(self, now_ns: int) -> int:
        """Return when a packet made now is sent: at once, or with the next burst."""
        fault = self.active(FaultKind.BURSTS, now_ns)
        if fault is None:
            return now_ns
        burst_ns = seconds_to_ns(BURST_S)
        begin_ns = self._start_ns + seconds_to_ns(fault.start_s)
        whole = (now_ns - begin_ns) // burst_ns + 1
        ends_ns = fault.end_ns(self._start_ns)
        # A burst never waits beyond the end of the fault.
        due_ns = begin_ns + whole * burst_ns
        return due_ns if ends_ns is None else min(due_ns, ends_ns)

    def ack_time_ns(self, now_ns: int) -> int:
        """Return when an acknowledgment made now is sent."""
        if not self.has(FaultKind.DELAYED_ACKS, now_ns):
            return self.send_time_ns(now_ns)
        return self.send_time_ns(now_ns) + seconds_to_ns(self._delays.uniform(*ACK_DELAY_S))

    def damaged(self, packet: bytes, now_ns: int) -> bytes:
        """Return a packet's bytes as sent: intact or damaged."""
        if not self.has(FaultKind.CORRUPTED_BYTES, now_ns):
            return packet
        if self._changes.random() >= CORRUPTED_SHARE:
            return packet
        changed = bytearray(packet)
        for _ in range(self._changes.randint(1, MOST_CHANGED_BYTES)):
            # Never XOR with 0: a chosen byte really changes.
            changed[self._changes.randrange(len(changed))] ^= self._changes.randint(1, 255)
        return bytes(changed)

    def as_frozen(self, packet: wire.Packet, now_ns: int) -> wire.Packet:
        """Return the packet, or while telemetry is frozen the first of its kind since then."""
        if not self.has(FaultKind.FROZEN_TELEMETRY, now_ns):
            self._repeated.clear()
            return packet
        return self._repeated.setdefault(type(packet), packet)

    def frame_flaw(self, now_ns: int) -> FrameFlaw | None:
        """Return the defect of a frame taken now, None without a fault."""
        if self.has(FaultKind.FRAMES_BLACK, now_ns):
            return Black()
        if self.has(FaultKind.FRAMES_TORN, now_ns):
            return torn(self._flaws)
        return exposed(self._flaws) if self.has(FaultKind.EXPOSURE_JUMPS, now_ns) else None


class AircraftFaults:
    """Starts and ends the faults of one aircraft; overlapping ones of a kind act as one."""

    def __init__(self, aircraft: Aircraft, altitude: HomeAltitude, seed: str) -> None:
        self._aircraft = aircraft
        self._altitude = altitude
        self._headings = Random(f"{seed}/gusts")
        self._running: dict[FaultKind, int] = {}
        go_home_height_m = aircraft.settings.go_home_height_m
        self._begins: dict[FaultKind, Callable[[], None]] = {
            FaultKind.PILOT_TAKES: aircraft.pilot_takes,
            FaultKind.LOW_BATTERY: lambda: aircraft.battery.lose_a_cell(FAILED_CELL_FRACTION),
            FaultKind.GNSS_LOSS: aircraft.lose_gnss,
            FaultKind.GUSTS: self._begin_squall,
            FaultKind.FALLS_SILENT: aircraft.crash,
            FaultKind.TAKEOFF_ALTITUDE_LOST: lambda: self._set_altitude_fault(nan),
            FaultKind.TAKEOFF_ALTITUDE_STALE: lambda: self._set_altitude_fault(STALE_BY_M),
            FaultKind.GO_HOME_HEIGHT: lambda: aircraft.set_go_home_height(LOW_GO_HOME_M),
            FaultKind.HOME_MOVED: lambda: aircraft.move_home_east(HOME_MOVED_BY_M),
        }
        self._ends: dict[FaultKind, Callable[[], None]] = {
            FaultKind.PILOT_TAKES: aircraft.pilot_releases,
            FaultKind.GNSS_LOSS: aircraft.find_gnss,
            FaultKind.GUSTS: aircraft.air.end_squall,
            FaultKind.TAKEOFF_ALTITUDE_LOST: lambda: self._set_altitude_fault(0.0),
            FaultKind.TAKEOFF_ALTITUDE_STALE: lambda: self._set_altitude_fault(0.0),
            FaultKind.GO_HOME_HEIGHT: lambda: aircraft.set_go_home_height(go_home_height_m),
        }

    def begin(self, kind: FaultKind) -> None:
        """Start a fault."""
        self._running[kind] = self._running.get(kind, 0) + 1
        self._begins[kind]()

    def end(self, kind: FaultKind) -> None:
        """End a fault, unless another of its kind is still active."""
        self._running[kind] -= 1
        if self._running[kind] == 0 and kind in self._ends:
            self._ends[kind]()

    def _begin_squall(self) -> None:
        squall = Squall(self._headings.uniform(0.0, 360.0))
        self._aircraft.air.begin_squall(squall, self._aircraft.now_ns)

    def _set_altitude_fault(self, error_m: float) -> None:
        self._altitude.fault_m = error_m
