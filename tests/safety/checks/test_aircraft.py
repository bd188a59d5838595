"""Checks of the aircraft's own reports, on both sides of every threshold."""

from dataclasses import replace

import pytest
from tests.safety.cases import AIRSPACE, NOW, S, vehicle
from tests.safety.checks.checked import ATTENTION, FAILS, OK, UNKNOWN, checked

from recon.model.airspace import FlightLimits
from recon.model.vehicle import BatteryWarning
from recon.safety import PreparedAirspace
from recon.safety.check import CheckState
from recon.safety.checks.aircraft import battery, link, wind


class TestLink:
    @pytest.mark.parametrize(
        ("age_s", "state"), [(0.1, OK), (1.0, OK), (1.000000001, FAILS), (90.0, FAILS)]
    )
    def test_telemetry_is_young(self, age_s: float, state: CheckState) -> None:
        assert checked(link, vehicle(age_s=age_s)).state is state


class TestBattery:
    @pytest.mark.parametrize(
        ("fraction", "state"),
        [(1.0, OK), (0.5, OK), (0.4999, ATTENTION), (0.2501, ATTENTION), (0.25, FAILS)],
    )
    def test_it_is_charged(self, fraction: float, state: CheckState) -> None:
        assert checked(battery, vehicle(battery_fraction=fraction)).state is state

    def test_the_reserve_is_the_sites(self) -> None:
        limits = FlightLimits(battery_reserve_fraction=0.6)
        strict = PreparedAirspace(replace(AIRSPACE.airspace, limits=limits))
        found = checked(battery, vehicle(battery_fraction=0.55), airspace=strict)
        assert (found.state, found.text) == (FAILS, "55%, all of it reserve (60%)")

    @pytest.mark.parametrize("warning", [BatteryWarning.LOW, BatteryWarning.SERIOUS])
    def test_the_aircrafts_warning_counts(self, warning: BatteryWarning) -> None:
        assert checked(battery, vehicle(battery_warning=warning)).state is FAILS
        unknown = vehicle(battery_warning=warning, battery_fraction=None)
        assert checked(battery, unknown).state is FAILS

    @pytest.mark.parametrize("lost", [{"battery_fraction": None}, {"battery_warning": None}])
    def test_what_the_app_does_not_tell_is_unknown(self, lost: dict[str, object]) -> None:
        assert checked(battery, vehicle(**lost)).state is UNKNOWN  # type: ignore[arg-type]


class TestWind:
    @pytest.mark.parametrize(
        ("level", "state"), [(None, OK), (0, OK), (1, OK), (2, ATTENTION), (7, ATTENTION)]
    )
    def test_strong_wind_wants_attention(self, level: int | None, state: CheckState) -> None:
        assert checked(wind, vehicle(wind_level=level)).state is state


def test_ages_are_shown_in_tenths_of_a_second() -> None:
    state = vehicle(core_received_at_ns=NOW - S // 5)
    assert checked(link, state).text == "telemetry is 0.2 s old"
