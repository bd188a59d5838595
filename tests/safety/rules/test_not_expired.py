"""An order that comes late is no order."""

from tests.safety.cases import NOW, approved, command, refused_by, situation

from recon.model.command import LandNow
from recon.safety import approve


def test_the_last_nanosecond_counts() -> None:
    assert approved(approve(command(LandNow(), expires_at_ns=NOW + 1), situation()))


def test_at_its_time_it_is_over() -> None:
    judged = approve(command(LandNow(), expires_at_ns=NOW), situation())
    assert refused_by(judged) == "not_expired"
