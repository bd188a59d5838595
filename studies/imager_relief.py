"""How long a spare imaging drone's shade method takes until it relieves the other one.

    python -m studies.imager_relief --seeds 2

The whole station in virtual time with rendered frames: three survey drones under cumulus, an
imaging drone over them, and a spare one on the ground beside the field that is ordered to relieve
it after 110 s. For each seed: from the order to its place, from there to the relief, and the
greatest age of the newest shade map meanwhile.
"""

import argparse
import re
from dataclasses import replace
from pathlib import Path
from tempfile import TemporaryDirectory

from recon.model.event import PreflightOverridden, ReliefOrdered
from recon.model.units import NS_PER_S
from recon.score import Scenario, load_scenario
from recon.score.run import StationRun
from recon.score.scenario import Methods
from recon.sim.flight.flight_modes import Grounded
from recon.station.state.imager_motion import MotionStage

SCENARIO = Path(__file__).parents[1] / "scenarios" / "cumulus-40-wide.toml"
FIRST, SPARE = "SIM-IMAGER", "SIM-IMAGER-2"
BESIDE_M = "[[-70.0, -70.0]]"
LENS = f"[imager]\nradius_m = 265.0\nalso_over_m = {BESIDE_M}\n\n"
"""A usual lens, instead of the ideal camera of the scenario."""
BEGINS_S = 110
WATCHED_S = 400


def two_imagers() -> Scenario:
    """Return the scenario with a second imaging drone, and shade found in rendered frames."""
    text = re.sub(r"\[imager\][^\[]*", LENS, SCENARIO.read_text("utf-8"), count=1)
    with TemporaryDirectory() as folder:
        path = Path(folder) / "relief.toml"
        path.write_text(text, "utf-8")
        scenario = load_scenario(path)
    return replace(scenario, methods=Methods("sunlit_reference", "advection"))


def relieved(scenario: Scenario, seed: int) -> str:
    """Fly one seed; return what came of the relief, as a sentence."""
    run = StationRun(scenario, seed)
    (spare,) = (app for app in run.apps.apps if app.settings.serial == SPARE)
    spare.aircraft.motion = spare.aircraft.motion._replace(height_m=0.0)
    spare.aircraft.active_mode = Grounded()
    for _ in range(BEGINS_S):
        run.advance_a_second()
    # The simulator sets both to one go-home height.
    run.driver.handle(PreflightOverridden(SPARE, "study", "one go-home height"))
    oldest_s, there_ns, begun_ns = 0.0, None, None
    for _ in range(WATCHED_S):
        if run.driver.station.reliefs.newest is None:
            run.driver.handle(ReliefOrdered(FIRST, SPARE, "study", takeoff=True))
        run.advance_a_second()
        newest, shade = run.driver.station.reliefs.newest, run.driver.station.shade.shade
        if newest is None or shade is None:
            continue
        oldest_s = max(oldest_s, (run.driver.now_ns - shade.captured_at_ns) / NS_PER_S)
        begun_ns = newest.begun_at_ns
        if newest.stage is MotionStage.MAPS:
            there_ns = newest.since_ns
        if newest.is_over:
            way_s = ((there_ns or newest.since_ns) - begun_ns) / NS_PER_S
            maps_s = (newest.since_ns - (there_ns or newest.since_ns)) / NS_PER_S
            reason = f" ({newest.reason})" if newest.reason else ""
            return (
                f"{newest.stage.value}{reason}: {way_s:.0f} s to the place, {maps_s:.0f} s there; "
                f"the newest shade map was at most {oldest_s:.1f} s old"
            )
    return "not over" if begun_ns is not None else "not begun"


def main() -> None:
    """Print a line for each seed."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--seeds", type=int, default=2)
    parser.add_argument("--first-seed", type=int, default=0)
    asked = parser.parse_args()
    scenario = two_imagers()
    for seed in range(asked.first_seed, asked.first_seed + asked.seeds):
        print(f"seed {seed}: {relieved(scenario, seed)}", flush=True)


if __name__ == "__main__":
    main()
