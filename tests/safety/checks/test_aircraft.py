"""Checks of the aircraft's own reports, on both sides of every threshold."""

from dataclasses import replace

import pytest
from tests.safety.cases import AIRSPACE, FACTS, NOW, S, situation, vehicle
from tests.safety.checks.checked import ATTENTION, FAILS, OK, UNKNOWN, checked

from recon.model.airspace import FlightLimits
from recon.model.vehicle import BatteryWarning, FlightMode
from recon.safety import PreparedAirspace
from recon.safety.check import CheckState
from recon.safety.checks.aircraft import app, battery, gnss, link, wind


class TestLink:
    @pytest.mark.parametrize(
        ("age_s", "state"), [(0.1, OK), (1.0, OK), (1.000000001, FAILS), (90.0, FAILS)]
    )
    def test_telemetry_is_young(self, age_s: float, state: CheckState) -> None:
        assert checked(link, vehicle(age_s=age_s)).state is state

    def test_before_any_telemetry_it_is_unknown(self) -> None:
        assert checked(link, vehicle(core_received_at_ns=None)).state is UNKNOWN

    def test_one_app_speaks_for_it(self) -> None:
        state = replace(vehicle(), rival_link_ids=(2,))
        found = link(state, situation())
        assert (found.state, found.text) == (FAILS, "two connections claim this serial")


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


class TestGnss:
    def test_it_is_the_gates_own_measure(self) -> None:
        assert checked(gnss, vehicle()).text == "14 satellites, signal level 4"
        found = checked(gnss, vehicle(flight_mode=FlightMode.ATTI))
        assert (found.state, found.text) == (
            FAILS,
            "flies in ATTI, without GNSS; the pilot must steer it",
        )


class TestWind:
    @pytest.mark.parametrize(
        ("level", "state"), [(None, OK), (0, OK), (1, OK), (2, ATTENTION), (7, ATTENTION)]
    )
    def test_strong_wind_wants_attention(self, level: int | None, state: CheckState) -> None:
        assert checked(wind, vehicle(wind_level=level)).state is state


class TestApp:
    def test_its_warnings_stay_until_acknowledged(self) -> None:
        assert checked(app, vehicle()).state is OK
        facts = replace(FACTS, app_warnings=("compass error", "storage full"))
        found = checked(app, vehicle(), facts=facts)
        assert (found.state, found.text) == (ATTENTION, "compass error; storage full")


def test_ages_are_shown_in_tenths_of_a_second() -> None:
    state = vehicle(core_received_at_ns=NOW - S // 5)
    assert checked(link, state).text == "telemetry is 0.2 s old"
