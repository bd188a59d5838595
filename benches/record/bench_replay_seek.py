"""How long a seek takes in a two-hour record, and opening it.

    python -m benches.record.bench_replay_seek [--hours 2] [--seeks 40] [--image-format jpeg|raw]
    python -m benches.record.bench_replay_seek --record FILE.mcap

The demonstration (four drones, a survey under broken cloud, frames at up to 2 fps) is recorded for
a minute over TCP, and its record is written again and again with later times until it is as long as
asked; with --record a given file is used as it is. Then random moments are sought, as the console
does it: the station of the moment, and its state as JSON.
"""

import argparse
import asyncio
import random
import sys
import tempfile
import time
from collections.abc import Iterable
from pathlib import Path
from typing import Any

import msgspec
from benches.record.bench_record import Costs, fly, watch
from foxglove_schemas_protobuf.Grid_pb2 import Grid

from recon.cli.demo import DEMO_SCENARIO
from recon.cli.own_files import scenario_file
from recon.record.mcap.foxglove import SHADE_TOPIC, SUN_TOPIC
from recon.record.mcap.mcap_file import KEYFRAMES_TOPIC, STEPS_TOPIC, McapFile
from recon.record.mcap.mcap_read import McapReading, RecordAttachment, RecordMessage
from recon.score import load_scenario
from recon.sim.app.camera_feed import ImageFormat
from recon.station.audit.start import AuditPlace
from recon.station.host.replay_run import ReplayStation, replay_service
from recon.station.host.run_config import RunConfig
from recon.station.recording.playback import Playback

RECORDED_S = 60.0
LIMIT_S = 1.0
EARLIEST_NS = 10**17
"""Of station time; smaller numbers of a record are counts and identities."""
CHUNK_NS = 300_000_000
"""As often the station writes a chunk."""


def recorded(folder: Path, image_format: str) -> Path:
    """Record the demonstration; return the file."""
    costs = Costs()
    watch(costs)
    config = RunConfig(
        site=load_scenario(scenario_file(DEMO_SCENARIO)).site,
        link_port=0,
        http_port=0,
        audit=AuditPlace(folder / "audit"),
        record_folder=folder / "records",
    )
    asyncio.run(fly(config, costs, RECORDED_S, image_format))
    assert costs.writer is not None
    assert costs.writer.path is not None
    return costs.writer.path


def later(value: Any, by_ns: int) -> Any:
    """Return built-in values with every station time moved on."""
    if type(value) is int:
        return value + by_ns if value > EARLIEST_NS else value
    if isinstance(value, dict):
        return {key: later(each, by_ns) for key, each in value.items()}
    return [later(each, by_ns) for each in value] if isinstance(value, list) else value


def moved(item: RecordMessage, by_ns: int) -> bytes:
    """Return a message as it would have been recorded later."""
    if item.topic in (STEPS_TOPIC, KEYFRAMES_TOPIC):
        return msgspec.msgpack.encode(later(msgspec.msgpack.decode(item.data), by_ns))
    if item.topic in (SHADE_TOPIC, SUN_TOPIC):
        grid = Grid.FromString(item.data)
        grid.timestamp.FromNanoseconds(grid.timestamp.ToNanoseconds() + by_ns)
        data: bytes = grid.SerializeToString()
        return data
    return item.data


def repeated(source: Path, target: Path, hours: float) -> None:
    """Write a record again and again until it lasts so long."""
    with source.open("rb") as file:
        items = list(McapReading(file).items())
    messages = [item for item in items if isinstance(item, RecordMessage)]
    file, channels, schemas = McapFile(target, "bench"), dict[str, int](), dict[str, int]()
    for item in items:
        if isinstance(item, RecordAttachment):
            file.add_attachment(item.name, item.media_type, item.data, 0)
    first_ns = min(item.log_ns for item in messages)
    lasts_ns = max(item.log_ns for item in messages) - first_ns + 50_000_000
    steps = max(item.sequence for item in messages if item.topic == STEPS_TOPIC)
    flushed_ns = first_ns
    for number in range(round(hours * 3600e9 / lasts_ns) + 1):
        for item in messages:
            channel = _channel(file, item, channels, schemas)
            is_step = item.topic in (STEPS_TOPIC, KEYFRAMES_TOPIC)
            sequence = item.sequence + number * steps * is_step
            at_ns = item.log_ns + number * lasts_ns
            file.add_message(channel, sequence, at_ns, moved(item, number * lasts_ns))
            if at_ns >= flushed_ns + CHUNK_NS or file.is_chunk_full:
                flushed_ns = at_ns
                file.flush()
    file.finish()


def _channel(
    file: McapFile, item: RecordMessage, channels: dict[str, int], schemas: dict[str, int]
) -> int:
    if item.topic not in channels:
        if item.schema and item.schema not in schemas:
            schemas[item.schema] = file.add_schema(item.schema, item.encoding, b"")
        schema = schemas.get(item.schema, 0)
        channels[item.topic] = file.add_channel(item.topic, item.encoding, schema)
    return channels[item.topic]


def seek_times_s(path: Path, seeks: int) -> Iterable[float]:
    """Yield a record's hours, the seconds of opening it, then those of seeks to random moments."""
    began_s = time.perf_counter()
    playback, rng = Playback(path), random.Random(1)
    replay = ReplayStation(path, playback)
    service = replay_service(replay)
    opened_s = time.perf_counter() - began_s
    yield (playback.ends_ns - playback.begins_ns) / 3600e9
    yield opened_s
    for _ in range(seeks):
        at_ns = rng.randint(playback.begins_ns, playback.ends_ns)
        began_s = time.perf_counter()
        replay.show(playback.move(at_ns))
        service.state().model_dump_json()
        yield time.perf_counter() - began_s
    playback.close()


def main() -> int:
    """Measure and print; 1 when a seek takes longer than a second."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--hours", type=float, default=2.0)
    parser.add_argument("--seeks", type=int, default=40)
    parser.add_argument("--record", type=Path)
    formats = [each.value for each in ImageFormat]
    parser.add_argument("--image-format", choices=formats, default=ImageFormat.JPEG.value)
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as text:
        path = options.record
        if path is None:
            path = Path(text) / "long.mcap"
            repeated(recorded(Path(text), options.image_format), path, options.hours)
        lasts_h, opening_s, *took_s = seek_times_s(path, options.seeks)
        size_gb = path.stat().st_size / 1e9
    took_s.sort()
    print(f"record of {lasts_h:.2f} h, {size_gb:.1f} GB")
    print(f"opening         {opening_s:6.2f} s")
    print(f"seek, median    {took_s[len(took_s) // 2]:6.2f} s of {len(took_s)}")
    print(f"seek, longest   {took_s[-1]:6.2f} s (limit {LIMIT_S:g} s)")
    return 0 if took_s[-1] < LIMIT_S else 1


if __name__ == "__main__":
    sys.exit(main())
