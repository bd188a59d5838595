"""What is wrong with a flight is an alarm: GNSS, wind, tilt, descent, height."""

from dataclasses import replace

import pytest
from tests.fleet.reports import core, extended
from tests.station.commanded import CommandedStation

from recon.model.report import CoreReport, ExtendedReport
from recon.model.severity import Severity
from recon.model.vehicle import Attitude

FLYING, GROUND = core(), core(flying=False, height_m=0.0)
FINE = extended()


def alarms(reported: CoreReport, more: ExtendedReport, seconds: float) -> dict[str, Severity]:
    """The alarms of a vehicle that reports this for a while."""
    start = GROUND if reported.is_flying is False else FLYING
    scene = CommandedStation().opens(1, start, FINE).keeps_receiving(1, start, FINE).passes(1.0)
    assert scene.alarms() == set()
    scene.keeps_receiving(1, reported, more).passes(seconds)
    book = scene.station.alarms.alarms.values()
    return {a.condition.rule: a.condition.severity for a in book if a.is_active}


@pytest.mark.parametrize(
    ("more", "severity"),
    [
        (replace(FINE, gnss_signal_level=0, gnss_satellite_count=3), Severity.CRITICAL),
        (replace(FINE, gnss_satellite_count=7), Severity.ERROR),
        (replace(FINE, gnss_signal_level=2), Severity.ERROR),
    ],
)
def test_gnss_lost_or_poor_for_2_s(more: ExtendedReport, severity: Severity) -> None:
    assert alarms(FLYING, more, 1.9) == {}
    assert alarms(FLYING, more, 2.3) == {"gnss": severity}
    assert alarms(GROUND, more, 5.0) == {}


def test_a_lost_position_is_lost_gnss() -> None:
    assert alarms(replace(FLYING, position=None), FINE, 2.3) == {"gnss": Severity.CRITICAL}


def test_an_unknown_height() -> None:
    reported = replace(FLYING, height_above_takeoff_m=None)
    assert "height_unknown" in alarms(reported, FINE, 1.3)


@pytest.mark.parametrize(("level", "rules"), [(None, set()), (1, set()), (2, {"strong_wind"})])
def test_strong_wind(level: int | None, rules: set[str]) -> None:
    assert set(alarms(FLYING, replace(FINE, wind_level=level), 0.3)) == rules


@pytest.mark.parametrize(("roll_deg", "rules"), [(-44.0, set()), (-46.0, {"attitude"})])
def test_a_tilt_that_no_flight_needs(roll_deg: float, rules: set[str]) -> None:
    assert set(alarms(replace(FLYING, attitude=Attitude(0, 0, roll_deg)), FINE, 0.8)) == rules


def test_a_descent_that_is_a_fall() -> None:
    reported = core(velocity=(0.0, 0.0, 9.5))
    assert alarms(reported, FINE, 0.6) == {"descent": Severity.CRITICAL}
