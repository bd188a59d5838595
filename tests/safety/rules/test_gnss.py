"""What is set in motion must know where it is, and hold its place by it."""

from dataclasses import replace

import pytest
from tests.safety.cases import MOVES, ZERO, command, mission, situation, vehicle

from recon.model.command import Body, Hover, Refusal, StopCamera
from recon.model.units import Stamped
from recon.model.vehicle import FlightMode
from recon.safety import SafetySettings
from recon.safety.rules.gnss import gnss

WITHOUT = {FlightMode.MANUAL, FlightMode.ATTI, FlightMode.ATTI_COURSE_LOCK, FlightMode.UNKNOWN}


def judged(body: Body = MOVES[0], *, flying: bool | None = True, **changes: object) -> str | None:
    """The reason of a refusal, or None."""
    answer = gnss(command(body), situation(vehicle(flying=flying, **changes)))
    assert answer is None or (answer.rule, answer.reason[:3]) == ("gnss", "A: ")
    return None if answer is None else answer.reason


@pytest.mark.parametrize("body", MOVES)
def test_motion_needs_a_fix(body: Body) -> None:
    assert judged(body) is None
    assert judged(body, position=Stamped()) is not None


@pytest.mark.parametrize("body", [ZERO, Hover(), StopCamera()])
def test_what_stops_or_looks_needs_none(body: Body) -> None:
    assert judged(body, position=Stamped()) is None


@pytest.mark.parametrize(("count", "goes"), [(8, True), (7, False), (0, False), (None, False)])
def test_eight_satellites_are_needed(count: int | None, goes: bool) -> None:
    assert (judged(gnss_satellite_count=count) is None) is goes


@pytest.mark.parametrize("flying", [True, None])
@pytest.mark.parametrize(
    ("level", "goes"), [(3, True), (5, True), (10, True), (2, False), (0, False), (None, False)]
)
def test_in_the_air_the_level_at_which_it_holds_its_place(
    level: int | None, goes: bool, flying: bool | None
) -> None:
    assert (judged(gnss_signal_level=level, flying=flying) is None) is goes


@pytest.mark.parametrize(("level", "goes"), [(4, True), (3, False), (None, False)])
def test_on_the_ground_the_level_at_which_it_records_its_home(
    level: int | None, goes: bool
) -> None:
    assert (judged(gnss_signal_level=level, flying=False) is None) is goes


@pytest.mark.parametrize("mode", [None, *FlightMode])
def test_modes_without_gnss_are_the_pilots(mode: FlightMode | None) -> None:
    assert (judged(flight_mode=mode) is None) is (mode is not None and mode not in WITHOUT)


def test_the_thresholds_are_settings() -> None:
    strict = replace(situation(), settings=SafetySettings(min_satellites=20))
    assert isinstance(gnss(command(mission()), strict), Refusal)
    assert gnss(command(mission()), replace(strict, vehicle=None)) is None
