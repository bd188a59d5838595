"""Where vehicles will be: trajectories from their state and what they were told."""

from recon.safety.prediction.conflicts import Conflict, first_conflict
from recon.safety.prediction.hazard_area import HazardArea, hazard_area_of, hazard_trajectories
from recon.safety.prediction.motion import Plane, VehicleMotion, vehicle_motion
from recon.safety.prediction.predicted_trajectories import predict_order, predict_traffic
from recon.safety.prediction.predictor import Predictor
from recon.safety.prediction.trajectory import FOREVER_S, FlightPart, Trajectory, part_text
from recon.safety.settings import PredictionSettings

__all__ = [
    "FOREVER_S",
    "Conflict",
    "FlightPart",
    "HazardArea",
    "Plane",
    "PredictionSettings",
    "Predictor",
    "Trajectory",
    "VehicleMotion",
    "first_conflict",
    "hazard_area_of",
    "hazard_trajectories",
    "part_text",
    "predict_order",
    "predict_traffic",
    "vehicle_motion",
]
