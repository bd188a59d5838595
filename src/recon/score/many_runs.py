"""Runs of many seeds: one after the other, on this machine's cores, or on a Dask cluster.

Each run is a pure function of scenario and seed, so it does not matter where it is flown; runs come
back in the order in which they end.
"""

import multiprocessing
import socket
from collections.abc import Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor, as_completed
from concurrent.futures.process import BrokenProcessPool
from typing import Any

from recon.model.errors import ReconError
from recon.model.extras import from_extra
from recon.processes.parent import end_with_parent
from recon.score.kept_runs import flown_code
from recon.score.run import Report, run
from recon.score.run_score import RunScore
from recon.score.scenario import Scenario
from recon.score.scenario_schema import ScenarioError

CONNECT_WITHIN_S, WORKERS_WITHIN_S = 10.0, 600.0
"""A batch system may let the first worker wait for minutes."""


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
    with ProcessPoolExecutor(jobs, context, initializer=end_with_parent) as pool:
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


def on_cluster(scenario: Scenario, seeds: Sequence[int], address: str) -> Iterator[RunScore]:
    """Yield the runs, flown by the workers of a Dask scheduler.

    Runs of a worker that is lost are flown by another one. Raises `ScenarioError` without Dask,
    without scheduler or workers at the address, and for workers that have other code.
    """
    with from_extra("cluster", "--cluster, here and on every worker,", ScenarioError):
        import distributed

    try:
        client = distributed.Client(address, timeout=CONNECT_WITHIN_S)
    except (OSError, ValueError) as problem:
        why = str(problem) or type(problem).__name__
        raise ScenarioError(
            f"--cluster: expected a Dask scheduler at {address}, got: {why}"
        ) from None
    with client:
        _wait_for_worker(client)
        # Part of each task: data on one worker would be lost with it.
        code = flown_code(scenario)
        waiting = [client.submit(_run_of, scenario, seed, code, pure=False) for seed in seeds]
        for done in distributed.as_completed(waiting):
            yield _result(done)


def _wait_for_worker(client: Any) -> None:
    try:
        client.wait_for_workers(1, timeout=WORKERS_WITHIN_S)
    except TimeoutError:
        raise ScenarioError(
            "--cluster: expected workers at the scheduler, got none: start some"
        ) from None


def _run_of(scenario: Scenario, seed: int, code: str) -> RunScore:
    """Return a run; on a worker, whose code must be that of the one who asks."""
    if flown_code(scenario) != code:
        raise ScenarioError(
            "--cluster: expected workers with this version of Recon, of its libraries and methods,"
            f" got another on {socket.gethostname()}: install the same there"
        )
    return run(scenario, seed)


def _result(done: Any) -> RunScore:
    try:
        found: RunScore = done.result()
    except ReconError:
        raise
    except Exception as problem:
        # Whatever a foreign machine lacks ends up here: Recon, memory, power.
        why = f"{type(problem).__name__}: {problem}"
        raise ScenarioError(
            f"--cluster: expected a run, got {why}; finished runs are kept"
        ) from problem
    return found
