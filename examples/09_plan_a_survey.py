"""Plan a survey: the rows over a region, and what two drones take for it.

Run: uv run python examples/09_plan_a_survey.py
"""

import numpy as np

from recon.guidance.survey import Surveyor, plan_survey
from recon.guidance.survey.estimate import Batteries, estimate
from recon.model.airspace import Region
from recon.model.command import Refusal
from recon.model.geo import GeoPoint, LocalFrame
from recon.model.survey import Survey

FRAME = LocalFrame(GeoPoint(41.9012, -93.6034, 275.0))
CORNERS_M = np.array([[0.0, 0.0], [300.0, 0.0], [260.0, 220.0], [0.0, 200.0]])


def main() -> None:
    """Print the rows of a survey and the flights of each drone."""
    survey = Survey(1, "south field", Region(CORNERS_M), height_above_takeoff_m=60.0, speed_mps=8.0)
    plan = plan_survey(survey, FRAME)
    if isinstance(plan, Refusal):
        raise SystemExit(plan.reason)
    metres = sum(piece.length_m for piece in plan.pieces)
    print(f"{len(plan.pieces)} rows of {metres:.0f} m, {plan.lattice.spacing_m:.0f} m apart")

    drones = [Surveyor(f"SIM-{number}", (20.0 * number, -30.0)) for number in (1, 2)]
    found = estimate(plan, drones, Batteries())
    if isinstance(found, Refusal):
        raise SystemExit(found.reason)
    for drone in found.drones:
        print(f"{drone.serial}: {len(drone.flights)} flights, {drone.flown_s / 60.0:.1f} min")


if __name__ == "__main__":
    main()
