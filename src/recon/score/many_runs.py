"""Runs of many seeds: one after the other, or on this machine's cores.

Each run is a pure function of scenario and seed, so it does not matter where it is flown; runs come
back in the order in which they end.
"""

import multiprocessing
import os
from collections.abc import Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor, as_completed
from concurrent.futures.process import BrokenProcessPool
from threading import Thread

from recon.score.run import Report, run
from recon.score.run_score import RunScore
from recon.score.scenario import Scenario
from recon.score.scenario_schema import ScenarioError


def one_by_one(
    scenario: Scenario, seeds: Sequence[int], report: Report | None = None
) -> Iterator[RunScore]:
    """Yield the runs, flown here; `report` is called every few minutes of each."""
    for seed in seeds:
        yield run(scenario, seed, report)


def on_cores(
    scenario: Scenario, seeds: Sequence[int], jobs: int, report: Report | None = None
) -> Iterator[RunScore]:
    """Yield the runs, flown by `jobs` processes of this machine; `report` is called in them.

    Raises `ScenarioError` when one of them ends before its run.
    """
    # Forked processes would inherit threads of the linear algebra in any state.
    context = multiprocessing.get_context("spawn")
    with ProcessPoolExecutor(jobs, context, initializer=_end_with_parent) as pool:
        waiting = [pool.submit(run, scenario, seed, report) for seed in seeds]
        try:
            for done in as_completed(waiting):
                yield done.result()
        except BrokenProcessPool:
            raise ScenarioError(
                "expected each process to fly its runs, got one that ended (out of memory?);"
                " finished runs are kept: use fewer --jobs and run the command again"
            ) from None
        finally:
            for each in waiting:
                each.cancel()


def _end_with_parent() -> None:
    """End a process of the pool as soon as the command ends, even when killed.

    Otherwise it would fly its run to the end, and then wait for the next one indefinitely.
    """
    parent = multiprocessing.parent_process()
    assert parent is not None

    def watch() -> None:
        parent.join()
        os._exit(1)

    Thread(target=watch, daemon=True).start()
