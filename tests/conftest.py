"""Real frames by $RECON_DATA: without it tests skip, with RECON_DATA_REQUIRED=1 they fail."""

import gc
import os
from pathlib import Path

import pytest
from hypothesis import HealthCheck, settings
from tests.examples import examples
from tests.processor_time import ProcessorTime

FLYING = ("benches", "score", "station/operations", "guidance", "cli", "sim", "client", "safety")
"""Rooms with the dearest files: they come first, so that no worker ends long after the others."""


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Sort tests by room; within one their order stays."""
    tests = Path(__file__).parent
    items.sort(key=lambda item: not any(item.path.is_relative_to(tests / r) for r in FLYING))


def pytest_configure(config: pytest.Config) -> None:
    """Count every test's processor time; `-p no:processor_time` turns it off.

    A search for cycles goes through all that thousands of collected tests hold: it is made seldom.
    """
    config.pluginmanager.register(ProcessorTime(), "processor_time")
    gc.set_threshold(100_000, 20, 100)


settings.register_profile(
    "untimed", max_examples=examples(100), deadline=None, derandomize="CI" in os.environ
)
settings.load_profile("untimed")
"""The time of an example depends on the machine; what is measured is in benches/.

What decides whether a change lands draws the same examples each time: a rare one found there would
stop a change that has nothing to do with it. By hand and in `make study` they are new ones.
"""

settings.register_profile(
    "mutants",
    max_examples=20,
    derandomize=True,
    deadline=None,
    database=None,
    suppress_health_check=[HealthCheck.differing_executors, HealthCheck.too_slow],
)
"""For `make mutants`: every mutant meets the same few examples, and one process runs them all."""


@pytest.fixture(scope="session", autouse=True)
def state_folder(tmp_path_factory: pytest.TempPathFactory) -> None:
    """No test writes into the user's own state folder, where audits go."""
    os.environ["XDG_STATE_HOME"] = str(tmp_path_factory.mktemp("state"))


@pytest.fixture(scope="session")
def fisheye_data() -> Path:
    """The folder of the real fisheye frames."""
    return real_data("fisheye", "camera-model.txt")


@pytest.fixture(scope="session")
def photos_data() -> Path:
    """The folder of real photos."""
    return real_data("photos", "beach-phantom3/DJI_0024.JPG")


def real_data(name: str, file: str) -> Path:
    """A folder of RECON_DATA that holds a file; skips or fails the test without it."""
    folder = Path(os.environ.get("RECON_DATA", "")) / name
    if "RECON_DATA" in os.environ and (folder / file).is_file():
        return folder
    reason = f"set RECON_DATA to the folder that holds {name}/{file} (now: {folder.parent})"
    if os.environ.get("RECON_DATA_REQUIRED") == "1":
        pytest.fail(reason)
    pytest.skip(reason)
