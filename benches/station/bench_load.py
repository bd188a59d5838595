"""The station under the load it is built for; nothing may be lost.

    python -m benches.station.bench_load [--apps 64] [--streams 4] [--seconds 60]

Apps at 10 Hz core and 2 Hz extended telemetry, some with raw 1280x720 images at 5 fps, from a
process of their own; beside them a console that takes a state ten times a second. Prints the
latency from an app's write to the end of the station's step and the CPU share, both beside those
of a bare asyncio sink under the same load in the same run, and how long "all stop" takes to reach
every app.
"""

import argparse
import statistics
import sys

import uvloop
from benches.station.measured import Load, Outcome, SinkOutcome, measure_sink, measure_station

P99_LIMIT_MS = 100.0
SINK_SECONDS = 10.0


def report(load: Load, outcome: Outcome, sink: SinkOutcome) -> None:
    """Print every figure."""
    sent = outcome.sent.packets
    mib_s = sent["bytes"] / load.seconds / 2**20
    print(
        f"{load.apps} apps, {load.streams} image streams, {load.seconds:g} s: "
        f"{sent['core']} core, {sent['extended']} extended, {sent.get('images', 0)} images, "
        f"{mib_s:.0f} MiB/s"
    )
    print(f"lost: {outcome.lost}")
    print(
        f"socket to state: p50 {outcome.latency_ms(50):.2f} ms, "
        f"p99 {outcome.latency_ms(99):.2f} ms, most {outcome.latency_ms(100):.2f} ms"
    )
    print(
        f"bare sink with a deframer, same run: p50 {sink.latency_ms(50):.2f} ms, "
        f"p99 {sink.latency_ms(99):.2f} ms; the station's p99 is "
        f"{outcome.latency_ms(99) / sink.latency_ms(99):.1f} times that"
    )
    print(
        f"CPU: {100 * outcome.cpu_share:.0f} % of one core, the sink {100 * sink.cpu_share:.0f} %: "
        f"{outcome.cpu_share / sink.cpu_share:.1f} times"
    )
    print(
        f"the station waited {100 * outcome.waited_share:.0f} % as long for a core as it ran: "
        "other programs' share in the latencies"
    )
    print(
        f"state and JSON: median {statistics.median(outcome.state_ms):.1f} ms, "
        f"most {max(outcome.state_ms):.1f} ms"
    )
    print(
        f"all stop to {outcome.ordered} vehicles: on every socket after "
        f"{outcome.fan_out_sent_ms:.1f} ms, "
        f"read by every app after {outcome.fan_out_read_ms:.1f} ms"
    )


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--apps", type=int, default=64)
    parser.add_argument("--streams", type=int, default=4)
    parser.add_argument("--seconds", type=float, default=60.0)
    asked = parser.parse_args()
    load = Load(asked.apps, asked.streams, asked.seconds)
    outcome = uvloop.run(measure_station(load))
    short = Load(load.apps, load.streams, min(load.seconds, SINK_SECONDS))
    report(load, outcome, uvloop.run(measure_sink(short)))
    is_good = not any(outcome.lost.values()) and outcome.latency_ms(99) < P99_LIMIT_MS
    is_good = is_good and outcome.ordered == len(outcome.sent.first_command_at_s) == load.apps
    print("good" if is_good else f"FAILED: nothing lost and p99 under {P99_LIMIT_MS:g} ms expected")
    return 0 if is_good else 1


if __name__ == "__main__":
    sys.exit(main())
