"""Random closed-loop runs of the whole station, each from one seed.

    python -m studies.closed_loop --runs 1000 --jobs 2
    python -m studies.closed_loop --seed 17 --verbose

The first prints progress, a table of violations by kind and class, the latency of holds, and a
short history of each violation of the station's own; it exits with 1 when there is one, or when the
station's code raised. The second flies one seed again, with a trace. Results do not depend on
`--jobs`. What a violation is and how it is classed: `studies/closed_loop/__init__.py`.
"""

import argparse
import sys
import time
from collections import Counter
from collections.abc import Iterable, Iterator
from functools import partial
from math import inf
from multiprocessing import get_context

from studies.closed_loop.marks import ViolationClass
from studies.closed_loop.run import ClosedLoopRun, fly
from studies.closed_loop.violations import RunResult, Violation

REPORT_EVERY = 10
S_PER_HOUR = 3_600.0


def fly_all(seeds: Iterable[int], seconds: float, jobs: int) -> Iterator[RunResult]:
    """Fly seeds, in their order, in so many processes."""
    if jobs == 1:
        yield from map(partial(fly, seconds), seeds)
        return
    with get_context("spawn").Pool(jobs) as pool:
        yield from pool.imap(partial(fly, seconds), seeds)


def summary(results: list[RunResult]) -> str:
    """Return the table of all runs."""
    violations = [v for result in results for v in result.violations]
    counts = Counter((v.breach.kind, v.kind) for v in violations)
    flown_h = sum(result.flight_s for result in results) / S_PER_HOUR
    lines = [
        f"{len(results)} runs, {sum(r.seconds for r in results) / S_PER_HOUR:.1f} h simulated,"
        f" {flown_h:.1f} flight hours of {sum(r.vehicles for r in results)} vehicles",
        f"{sum(r.orders for r in results)} orders, {sum(r.packets for r in results)} packets"
        f" received by apps, {sum(r.landings for r in results)} landings",
        f"CPU {sum(r.cpu_s for r in results) / max(1, len(results)):.1f} s per run",
        "",
        f"{'violations':<18}" + "".join(f"{kind.value:>9}" for kind in ViolationClass),
    ]
    for name in sorted({name for name, _ in counts}):
        row = "".join(f"{counts[name, kind]:>9}" for kind in ViolationClass)
        lines.append(f"{name:<18}{row}")
    total = "".join(
        f"{sum(n for (_, k), n in counts.items() if k is kind):>9}" for kind in ViolationClass
    )
    return "\n".join([*lines, f"{'all':<18}{total}", "", stop_line(results)])


def stop_line(results: list[RunResult]) -> str:
    """Return the latency of holds in one line; what never arrived counts as infinite."""
    found = sorted(each for result in results for each in result.stop_latencies_s)
    if not found:
        return "no hold was given"
    at = [found[min(len(found) - 1, int(share * len(found)))] for share in (0.5, 0.99)]
    late = sum(each == inf for each in found)
    arrived = [each for each in found if each < inf]
    worst = max(arrived, default=0.0)
    return (
        f"{len(found)} holds expected at the app: p50 {at[0]:.2f} s, p99 {at[1]:.2f} s,"
        f" worst {worst:.2f} s; {late} later than that allowed"
    )


def violation_text(violation: Violation) -> str:
    """Return a violation with its history."""
    head = (
        f"seed {violation.seed}, {violation.at_s:.1f} s, {violation.until_s - violation.at_s:.1f} s"
        f" long: {violation.breach.kind} {' and '.join(violation.breach.serials)}:"
        f" {violation.breach.text}; at worst {violation.worst} ({violation.kind.value}:"
        f" {violation.why})"
    )
    return "\n".join([head, *(f"    {line}" for line in violation.history)])


def main() -> int:
    """Fly, print, and return what to exit by."""
    options = _options()
    seconds = 60.0 * options.minutes
    if options.seed is not None:
        result = ClosedLoopRun(options.seed, seconds, verbose=options.verbose).run()
        print("\n".join(violation_text(violation) for violation in result.violations))
        print(summary([result]))
        return _exit_code([result])
    seeds = range(options.first_seed, options.first_seed + options.runs)
    results: list[RunResult] = []
    began_s = time.perf_counter()
    for result in fly_all(seeds, seconds, options.jobs):
        results.append(result)
        for violation in result.violations:
            if violation.kind is ViolationClass.STATION or options.verbose:
                print(violation_text(violation), flush=True)
        if result.error:
            print(f"seed {result.seed}: the station's code raised {result.error}", flush=True)
        if len(results) % REPORT_EVERY == 0:
            took_s = time.perf_counter() - began_s
            found = Counter(v.kind.value for r in results for v in r.violations)
            print(
                f"{len(results)} of {options.runs} runs, {took_s:.0f} s: {dict(found)}", flush=True
            )
    print(summary(results))
    return _exit_code(results)


def _exit_code(results: list[RunResult]) -> int:
    own = sum(
        violation.kind is ViolationClass.STATION
        for result in results
        for violation in result.violations
    )
    failed = [result.seed for result in results if result.error]
    print(f"violations of the station's own: {own}; runs in which its code raised: {failed}")
    return 1 if own or failed else 0


def _options() -> argparse.Namespace:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--runs", type=int, default=100)
    parser.add_argument("--first-seed", type=int, default=0)
    parser.add_argument("--minutes", type=float, default=5.0, help="of virtual time in each run")
    parser.add_argument("--jobs", type=int, default=1, help="processes")
    parser.add_argument("--seed", type=int, help="fly only this one")
    parser.add_argument("--verbose", action="store_true", help="trace; tell every violation")
    return parser.parse_args()


if __name__ == "__main__":
    sys.exit(main())
