"""Where vehicles will be: courses from their state and what they were told."""

from recon.safety.prediction.course import FOREVER_S, Course, Part, part_words
from recon.safety.prediction.flyer import Flyer, flyer
from recon.safety.prediction.foresee import foresee_order, foresee_traffic
from recon.safety.prediction.hazard_area import HazardArea, hazard_area_of, hazard_courses
from recon.safety.prediction.intents import Follower
from recon.safety.prediction.meetings import Meeting, first_meeting
from recon.safety.prediction.plane import Plane
from recon.safety.settings import PredictionSettings

__all__ = [
    "FOREVER_S",
    "Course",
    "Flyer",
    "Follower",
    "HazardArea",
    "Meeting",
    "Part",
    "Plane",
    "PredictionSettings",
    "first_meeting",
    "flyer",
    "foresee_order",
    "foresee_traffic",
    "hazard_area_of",
    "hazard_courses",
    "part_words",
]
