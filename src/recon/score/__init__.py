"""Scenarios, flown in a closed loop by events, and the figures that methods are compared by.

`load_scenario` reads a file; `run` flies it once for a seed; `tables` prints what several runs say.
"""

from recon.score.closed_loop import run
from recon.score.errors import ScenarioError
from recon.score.run_score import RunScore
from recon.score.scenario import Methods, Scenario
from recon.score.scenario_file import load_scenario
from recon.score.tables import tables

__all__ = ["Methods", "RunScore", "Scenario", "ScenarioError", "load_scenario", "run", "tables"]
