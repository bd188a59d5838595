"""Scenarios flown by the whole station in virtual time, and figures to compare methods by.

`load_scenario` reads a file, `run` flies it once for a seed, `tables` prints the figures of several
runs. Nothing else sees the simulator's truth.
"""

from recon.score.run import StationRun, run
from recon.score.run_score import RunScore
from recon.score.scenario import Methods, Scenario
from recon.score.scenario_file import load_scenario
from recon.score.scenario_schema import ScenarioError
from recon.score.tables import tables
