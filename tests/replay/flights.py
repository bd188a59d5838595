"""The reference flights: made in virtual time, kept as records beside their test.

    python -m tests.replay.flights [NAME...]

makes them anew. Do so to accept an intended change of behaviour, and state the change in the
commit; `recon replay --check tests/replay/flights/NAME.mcap` shows it before.
"""

import shutil
import sys
from collections.abc import Callable, Mapping
from pathlib import Path
from tempfile import TemporaryDirectory

import pytest
from tests.oracles.eight_vehicles import eight_vehicles
from tests.oracles.same_again import FAULTS, bad_link
from tests.replay.record_flight import Recorded, recording
from tests.replay.rounding import was_here
from tests.station.returning_world import FRAME
from tests.station.surveyed_world import SURVEY_ID, asked, surveyed_world

from recon.site import Site
from recon.station.kernel.virtual import VirtualDriver
from recon.station.recording.recorded_values import FlightStart

FOLDER = Path(__file__).parent / "flights"


def skip_if_recorded_elsewhere(start: FlightStart) -> None:
    """Skip a test of what follows from pixels: linear algebra differs between processors in its
    last bits, and is compared with thresholds."""
    if not was_here(start):
        pytest.skip("recorded on another processor: numbers differ in their last bits")


def faults(folder: Path) -> Path:
    """Orders, missions and sticks for eight vehicles, over bad links and with faults."""
    scene = eight_vehicles(3, faults=FAULTS, make_link=lambda: bad_link(3))
    with recording(scene.driver, scene.site, folder) as record:
        scene.run_for(14.0)
    return record.path


def survey(folder: Path) -> Path:
    """Two vehicles survey a field, are paused, and are recalled."""
    world = surveyed_world(2)
    with recording(world.driver, Site("reference"), folder) as record:
        world.asks()
        world.starts("SIM-1", "SIM-2")
        world.runs(20.0)
        world.pauses()
        world.runs(4.0)
        world.starts("SIM-1", "SIM-2")
        world.runs(4.0)
        world.fleet.call("SIM-1", "SIM-2")
        world.runs(20.0)
    return record.path


def pictures(folder: Path) -> Path:
    """An imaging drone's frames become shade maps and forecasts."""
    scene = eight_vehicles(3, sees=True, jpeg_quality=30)
    with recording(scene.driver, scene.site, folder) as record:
        scene.run_for(4.5)
    return record.path


def new_file(record: Recorded, driver: VirtualDriver) -> None:
    """Begin a new file at the next moment without a job, as a landing does."""
    while record.recorder._jobs:
        driver.run_for(0.05)
    record.recorder._hand_over()
    record.recorder._begin_file(driver.station, driver.now_ns)


def pictures_in_two(folder: Path) -> None:
    """Frames, with a new file in flight."""
    scene = eight_vehicles(3, sees=True, jpeg_quality=30)
    with recording(scene.driver, scene.site, folder) as record:
        scene.run_for(2.5)
        new_file(record, scene.driver)
        scene.run_for(2.0)


def survey_in_two(folder: Path) -> None:
    """A survey beside one that is never started, with a new file in flight."""
    world = surveyed_world(2)
    with recording(world.driver, Site("reference", FRAME), folder) as record:
        world.asks()
        world.asks(asked(id=SURVEY_ID + 1, name="not flown"))
        world.starts("SIM-1", "SIM-2")
        world.runs(10.0)
        new_file(record, world.driver)
        world.pauses()
        world.runs(2.0)
        world.starts("SIM-1", "SIM-2")
        world.runs(4.0)


FLIGHTS: Mapping[str, Callable[[Path], Path]] = {
    each.__name__: each for each in (faults, survey, pictures)
}


def main(*names: str) -> None:
    """Make flights anew; all of them without a name."""
    FOLDER.mkdir(exist_ok=True)
    for name in names or FLIGHTS:
        with TemporaryDirectory() as folder:
            shutil.copy(FLIGHTS[name](Path(folder)), FOLDER / f"{name}.mcap")
        print(f"{FOLDER / name}.mcap: {(FOLDER / f'{name}.mcap').stat().st_size} bytes")


if __name__ == "__main__":
    main(*sys.argv[1:])
