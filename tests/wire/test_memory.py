"""Memory of a process full of deframers: what a peer can claim, and what it leaves behind."""

import subprocess
import sys
from typing import Any

import pytest

MIB = 1024 * 1024

PREPARE = """
import gc, resource, sys
from pathlib import Path
import numpy as np
from recon import wire

def resident_mib():
    line = next(l for l in Path("/proc/self/status").read_text().splitlines() if "VmRSS" in l)
    return int(line.split()[1]) / 1024

def header(rows, cols):
    size = 17 + 3 * rows * cols
    return (b"\\xda\\xa7" + size.to_bytes(4, "big") + b"\\x02" + bytes(4)
            + rows.to_bytes(2, "big") + cols.to_bytes(2, "big"))
"""

CLAIM = """
limit = int(Path("/proc/self/statm").read_text().split()[0]) * resource.getpagesize() + 64 * 2**20
resource.setrlimit(resource.RLIMIT_AS, (limit, limit))
deframers = [wire.Deframer() for _ in range(240)]
before = resident_mib()
for deframer in deframers:
    assert deframer.feed(header(2160, 3840)) == []
print(resident_mib() - before, sum(deframer.buffered_bytes for deframer in deframers))
"""

IMAGES = """
frame = wire.encode(wire.Image(target_fps_hz=1.0, pixels=np.full((2160, 3840, 3), 7, np.uint8)))
frame = bytearray(frame)
if sys.argv[1] == "damaged":
    frame[1000] ^= 1
deframers = [wire.Deframer() for _ in range(40)]
before = resident_mib()
for start in range(0, len(frame) - 32768, 32768):
    for deframer in deframers:
        deframer.feed(bytes(frame[start:start + 32768]))
held = resident_mib()
for deframer in deframers:
    deframer.feed(bytes(frame[start + 32768:]))
gc.collect()
assert all(deframer.pending_bytes == 0 for deframer in deframers)
print(resident_mib() - before, held - before)
"""


def measured(script: str, *arguments: str) -> tuple[float, float]:
    run: subprocess.CompletedProcess[Any] = subprocess.run(
        [sys.executable, "-c", PREPARE + script, *arguments],
        capture_output=True,
        text=True,
        check=True,
    )
    first, second = run.stdout.split()
    return float(first), float(second)


@pytest.mark.skipif(sys.platform != "linux", reason="reads /proc")
class TestMemory:
    def test_claims_of_six_gigabytes_reserve_nothing(self) -> None:
        """240 headers of 25 MB each, in a process that may take 64 MiB more."""
        resident_mib, buffered_bytes = measured(CLAIM)
        print(f"240 claims of 25 MB: {resident_mib:.1f} MiB resident, {buffered_bytes:.0f} bytes")
        assert resident_mib < 16
        assert buffered_bytes < MIB

    @pytest.mark.parametrize("kind", ["good", "damaged"])
    def test_large_images_leave_nothing_behind(self, kind: str) -> None:
        left_mib, held_mib = measured(IMAGES, kind)
        print(f"40 {kind} images of 24 MiB: {held_mib:.0f} MiB held, {left_mib:.1f} MiB after")
        assert held_mib > 800
        assert left_mib < 24
