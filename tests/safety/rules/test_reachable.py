"""A command needs a known vehicle and an open link."""

from tests.safety.cases import NOW, command, refused_by, vehicle

from recon.model.command import LandNow
from recon.safety import Situation, approve


def test_nobody_of_that_serial() -> None:
    assert refused_by(approve(command(LandNow()), Situation(NOW, None, ()))) == "reachable"


def test_a_vehicle_without_a_connection() -> None:
    assert refused_by(approve(command(LandNow()), Situation(NOW, vehicle(), ()))) == "reachable"
