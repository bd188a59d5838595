"""Prediction: where vehicles will be, from their state and their intent (last commanded motion).

Theory of operation. `VehicleMotion` is a vehicle at its last telemetry in one plane. `Predictor`
writes its `Trajectory` from there: rows of straight motion with constant acceleration, a band of
heights, and a radius that grows where the position is uncertain (corners, manual control, sticks
that turn). Two users read it at different resolution:

- The gate predicts an order to its end and indefinitely beyond, with each leg as one even row, and
  cuts it into `ProtectedVolumes` with growing time uncertainty (`first_conflict`).
- The watchdogs predict the next seconds with exact acceleration phases and sample them.

While telemetry is younger than `stale_s` a vehicle follows its intent; without an intent it may use
its present speed in any direction for `free_s`. After `stale_s` it is a `HazardArea`: a circle that
grows with its last speed, the ground below, and its route home; if it was sent a mission, the
mission counts as well. A hazard area ends with new telemetry or by an operator's dismissal.
"""

from recon.model.arrays import BoolArray
from recon.safety.prediction.conflicts import Conflict, first_conflict
from recon.safety.prediction.hazard_area import HazardArea, hazard_area_of, hazard_trajectories
from recon.safety.prediction.motion import (
    Plane,
    VehicleMotion,
    height_drift_m,
    unknown_heights,
    vehicle_motion,
)
from recon.safety.prediction.predicted_trajectories import predict_order, predict_traffic
from recon.safety.prediction.predictor import Predictor
from recon.safety.prediction.trajectory import FOREVER_S, FlightPart, Trajectory, part_text
from recon.safety.prediction_settings import PredictionSettings
