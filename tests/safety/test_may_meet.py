"""What is sorted out before courses are compared piece by piece never meets."""

from hypothesis import given, settings
from hypothesis import strategies as st
from tests.safety.traffic import SETTINGS

from recon.safety.prediction.course import Course, CourseWriter, Part
from recon.safety.prediction.foresee import may_meet, surroundings
from recon.safety.prediction.meetings import first_meeting
from recon.safety.separation_minima import SeparationMinima

NEED = SeparationMinima(horizontal_m=15.0, vertical_m=8.0)

places_m = st.floats(-120.0, 120.0)
heights_m = st.floats(20.0, 70.0)


@st.composite
def courses(draw: st.DrawFn) -> Course:
    """Some straight pieces, with bands of heights and growing discs; at the end it stays."""
    height_m = draw(heights_m)
    writer = CourseWriter(draw(places_m), draw(places_m), height_m, height_m)
    for _ in range(draw(st.integers(1, 4))):
        low_m = draw(heights_m)
        writer.moves(
            draw(places_m),
            draw(places_m),
            draw(st.floats(1.0, 20.0)),
            0,
            curve=draw(st.sampled_from([0.0, 0.001])),
            band_m=(low_m, low_m + draw(st.floats(0.0, 5.0))),
            radius_m=draw(st.sampled_from([None, 3.0, 10.0])),
        )
    if draw(st.booleans()):
        writer.stays(Part.HOVERING)
    return writer.course("SIM-1", "SIM-1")


@settings(max_examples=300)
@given(courses(), courses())
def test_what_meets_is_never_sorted_out(own: Course, other: Course) -> None:
    if first_meeting(own, [other], NEED, SETTINGS) is not None:
        assert may_meet(other, surroundings(own, NEED, SETTINGS))


def standing(east_m: float, up_m: float) -> Course:
    writer = CourseWriter(east_m, 0.0, up_m, up_m)
    writer.stays(Part.HOVERING)
    return writer.course("SIM-2", "SIM-2")


def test_what_is_elsewhere_or_at_other_heights_is_sorted_out() -> None:
    around = surroundings(standing(0.0, 40.0), NEED, SETTINGS)
    assert may_meet(standing(14.9, 40.0), around)
    assert not may_meet(standing(15.1, 40.0), around)
    assert may_meet(standing(0.0, 47.9), around)
    assert not may_meet(standing(0.0, 48.1), around)
    assert not may_meet(standing(0.0, 31.9), around)


def test_what_is_nowhere_is_in_doubt() -> None:
    around = surroundings(standing(0.0, 40.0), NEED, SETTINGS)
    assert may_meet(standing(float("nan"), 40.0), around)
    assert may_meet(standing(0.0, float("nan")), around)
