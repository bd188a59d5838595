"""What the record of a flight costs: size of eight hours, and processor time, at the demo's load.

    python -m benches.record.bench_record [--seconds 120] [--image-format raw|jpeg]

The station of `recon demo` with its simulated drones over TCP, a survey under broken cloud and raw
1280x720 frames at up to 2 fps, recorded into a temporary folder. The first seconds, in which
drones take off, are excluded. Told are the size by topic, the processor time of the
process that writes as a share of one core, and that of the event loop for handing steps and bytes
over.
"""

import argparse
import asyncio
import os
import signal
import sys
import tempfile
import time
from collections import Counter
from collections.abc import Callable
from pathlib import Path
from typing import Any

from recon.cli.demo import DEMO_SCENARIO, DEMO_SEED
from recon.cli.own_files import scenario_file
from recon.cli.scripted_operator import fly_surveys
from recon.record.mcap.mcap_file import compressor
from recon.record.mcap.mcap_read import McapReading, RecordMessage
from recon.record.mcap.record_process import RecordProcess
from recon.score import load_scenario
from recon.score.scenario_sky import sky_of
from recon.sim.app.camera_feed import ImageFormat
from recon.station.audit.start import AuditPlace
from recon.station.host import run as station_run
from recon.station.host.run import run
from recon.station.host.run_config import RunConfig, Started
from recon.station.recording.recording import Recorder

SETTLED_S = 20.0
HOURS = 8.0
CPU_LIMIT = 0.05


class Costs:
    """Processor time of both processes, and the file's size, at two moments."""

    def __init__(self) -> None:
        self.loop_s = 0.0
        self.writer: RecordProcess | None = None

    def timed(self, act: Callable[..., Any]) -> Callable[..., Any]:
        """Return the function with its processor time added up."""

        def timed(*arguments: Any) -> Any:
            began_s = time.thread_time()
            try:
                return act(*arguments)
            finally:
                self.loop_s += time.thread_time() - began_s

        return timed

    def now(self) -> tuple[float, float, float, int]:
        """Return the time, both processor times in seconds, and the size in bytes."""
        writer = self.writer
        assert writer is not None
        assert writer.path is not None
        return time.monotonic(), writer.status.cpu_s, self.loop_s, writer.path.stat().st_size


async def fly(config: RunConfig, costs: Costs, seconds: float, image_format: str) -> list[Any]:
    """Run the station with the demo's drones; return the costs at the beginning and the end."""
    moments: list[Any] = []
    path = scenario_file(DEMO_SCENARIO)
    tasks: list[asyncio.Task[None]] = []
    processes: list[asyncio.subprocess.Process] = []

    async def measure() -> None:
        await asyncio.sleep(SETTLED_S)
        moments.append(costs.now())
        await asyncio.sleep(seconds)
        moments.append(costs.now())
        os.kill(os.getpid(), signal.SIGINT)

    async def begin(started: Started) -> None:
        words = ["--station", f"127.0.0.1:{started.link_port}", "--seed", str(DEMO_SEED)]
        words += ["--fps", "2", "--image-format", image_format]
        command = (sys.executable, "-m", "recon", "sim", "scenario", str(path), *words)
        processes.append(await asyncio.create_subprocess_exec(*command))
        scenario = load_scenario(path)
        tasks.append(asyncio.create_task(fly_surveys(started.console_url, scenario, print)))
        tasks.append(asyncio.create_task(measure()))

    try:
        await run(config, begin)
    finally:
        for task in tasks:
            task.cancel()
        for process in processes:
            process.kill()
            await process.wait()
    return moments


def main() -> int:
    """Measure and print; 1 when writing takes more of a core than is allowed."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--seconds", type=float, default=120.0)
    formats = [each.value for each in ImageFormat]
    parser.add_argument("--image-format", choices=formats, default=ImageFormat.RAW.value)
    options = parser.parse_args()
    costs = Costs()
    with tempfile.TemporaryDirectory() as text:
        folder = Path(text)
        watch(costs)
        scenario = load_scenario(scenario_file(DEMO_SCENARIO))
        config = RunConfig(
            site=scenario.site,
            link_port=0,
            http_port=0,
            audit=AuditPlace(folder / "audit"),
            record_folder=folder / "records",
            sun_time_ahead_s=sky_of(scenario, DEMO_SEED).settings.sun.start_utc_s - time.time(),
        )
        first, last = asyncio.run(fly(config, costs, options.seconds, options.image_format))
        assert costs.writer is not None
        assert costs.writer.path is not None
        took_s = last[0] - first[0]
        share = (last[1] - first[1]) / took_s
        rate = (last[3] - first[3]) / took_s
        print(f"record of {took_s:.0f} s, frames {options.image_format}")
        print(f"size            {rate / 1e6:8.3f} MB/s   {rate * HOURS * 3.6e-6:8.1f} GB in 8 h")
        handing_over = (last[2] - first[2]) / took_s
        print(f"its process     {100 * share:8.2f} % of one core")
        print(f"event loop      {100 * handing_over:8.2f} % of one core")
        share += handing_over
        print(f"writing         {100 * share:8.2f} % of one core (limit {100 * CPU_LIMIT:.0f} %)")
        print_topics(costs.writer.path)
    return 0 if share < CPU_LIMIT else 1


def watch(costs: Costs) -> None:
    """Have the station's record measured."""
    made = station_run.record_process

    def kept(*arguments: Any) -> RecordProcess:
        costs.writer = made(*arguments)
        return costs.writer

    station_run.record_process = kept
    for name in ("take", "tap"):
        setattr(Recorder, name, costs.timed(getattr(Recorder, name)))


def print_topics(path: Path) -> None:
    """Print messages and bytes of each kind of topic; packed alone, a kind takes more than here."""
    counts, sizes, packed = Counter[str](), Counter[str](), Counter[str]()
    parts: dict[str, list[bytes]] = {}
    with path.open("rb") as file:
        for item in McapReading(file).items():
            if isinstance(item, RecordMessage):
                kind = item.topic.rpartition("/")[2]
                counts[kind] += 1
                sizes[kind] += len(item.data)
                parts.setdefault(kind, []).append(item.data)
                if sum(map(len, parts[kind])) > 8e6:
                    packed[kind] += len(compressor().compress(b"".join(parts.pop(kind))))
    for kind, left in parts.items():
        packed[kind] += len(compressor().compress(b"".join(left)))
    for kind, count in counts.most_common():
        size, alone = sizes[kind] / 1e6, packed[kind] / 1e6
        print(f"{kind:<15} {count:8d} messages {size:9.2f} MB, packed {alone:8.2f} MB")


if __name__ == "__main__":
    sys.exit(main())
