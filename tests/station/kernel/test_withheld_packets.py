"""Telemetry withheld by a claimed size is as old as its bytes."""

from dataclasses import dataclass, field

import pytest
from tests.link.approved import MS, core, extended
from tests.link.test_session import IMAGE_HEAD

from recon.fleet.state import staleness
from recon.model.event import PacketReceived
from recon.model.report import CoreReport
from recon.model.vehicle import Staleness, VehicleState
from recon.sim.app.app import NEVER_NS
from recon.station.kernel.virtual import VirtualDriver
from recon.station.state.station import Station

SECOND = 1000 * MS


@dataclass
class Script:
    """A peer that sends bytes at set times."""

    sends: list[tuple[int, bytes]]
    received: list[bytes] = field(default_factory=list)

    def receive(self, data: bytes, now_ns: int) -> None:
        self.received.append(data)

    def advance(self, now_ns: int) -> list[bytes]:
        due = [data for at_ns, data in self.sends if at_ns <= now_ns]
        self.sends = [(at_ns, data) for at_ns, data in self.sends if at_ns > now_ns]
        return due

    @property
    def next_due_ns(self) -> int:
        return min((at_ns for at_ns, _ in self.sends), default=NEVER_NS)


def vehicle(station: Station) -> VehicleState:
    return station.fleet.vehicles["A"]


@pytest.mark.parametrize(("drip_s", "released_s"), [(0.0, 2.0), (1.5, 10.0)])
def test_a_withheld_packet_counts_from_its_arrival(drip_s: float, released_s: float) -> None:
    sends = [
        (SECOND, extended(b"A") + core(yaw_deg=1.0)),
        (2 * SECOND, IMAGE_HEAD + core(yaw_deg=2.0)),
    ]
    if drip_s:
        sends += [(round((2 + n * drip_s) * SECOND), b"\x00") for n in range(1, 9)]
    driver = VirtualDriver(Station())
    driver.connect(Script(sends))
    driver.run_for(2.5)
    attitude = vehicle(driver.station).attitude.value
    assert attitude is not None
    assert attitude.yaw_deg == 1.0
    is_released = driver.run_until(
        lambda station: (a := vehicle(station).attitude.value) is not None and a.yaw_deg == 2.0,
        20.0,
    )
    assert is_released
    state, now_ns = vehicle(driver.station), driver.now_ns
    assert now_ns >= (2.0 + released_s) * SECOND
    assert state.core_received_at_ns == 2 * SECOND + 20 * MS
    assert state.position.received_at_ns == state.core_received_at_ns
    assert staleness(state, now_ns) is not Staleness.LIVE
    (*_, last) = [
        e for e in driver.log if isinstance(e, PacketReceived) and isinstance(e.report, CoreReport)
    ]
    assert last.received_at_ns(now_ns) == 2 * SECOND + 20 * MS
