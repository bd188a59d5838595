"""[failsafe] of site.toml: what it changes, and one clear sentence for what makes no sense."""

import math
import shutil
from pathlib import Path
from typing import Any

import pytest

from recon.model.errors import SiteError
from recon.model.failsafe_matrix import Activity, FailsafeCell, FailsafeCondition, Reaction
from recon.safety.failsafe import DEFAULT_MATRIX
from recon.site import demo_site_folder, load_site
from recon.site.failsafe import failsafe_from_tables, failsafe_report, failsafe_warnings
from recon.station.kernel.build import first_state

PLACE = Path("site.toml")
TELEMETRY, BATTERY = FailsafeCondition.TELEMETRY_LOST, FailsafeCondition.BATTERY_LOW


def problem(tables: dict[str, Any]) -> str:
    with pytest.raises(SiteError) as found:
        failsafe_from_tables(PLACE, tables)
    return str(found.value)


class TestWhatItChanges:
    def test_without_the_table_it_is_the_default(self) -> None:
        assert failsafe_from_tables(PLACE, {}) == DEFAULT_MATRIX
        assert failsafe_report(DEFAULT_MATRIX) == "failsafe matrix: default"

    def test_a_name_has_the_usual_delay_and_a_table_its_own(self) -> None:
        matrix = failsafe_from_tables(
            PLACE,
            {
                "telemetry_lost": {"mission": {"do": "hold", "after_s": 5}},
                "battery_low": {"holding": "land", "mission": {"do": "return"}},
                "wind": {"mission": "return"},
            },
        )
        assert matrix.cell(TELEMETRY, Activity.MISSION) == FailsafeCell(Reaction.HOLD, 5.0)
        assert matrix.cell(BATTERY, Activity.HOLDING) == FailsafeCell(Reaction.LAND, 15.0)
        wind = matrix.cell(FailsafeCondition.WIND, Activity.MISSION)
        assert wind == FailsafeCell(Reaction.RETURN, 30.0)
        changed = [cell[:2] for cell in matrix.differences(DEFAULT_MATRIX)]
        assert changed == [
            (TELEMETRY, Activity.MISSION),
            (BATTERY, Activity.HOLDING),
            (FailsafeCondition.WIND, Activity.MISSION),
        ]
        assert failsafe_report(matrix) == "failsafe matrix: 3 cells differ from the default"

    def test_what_does_less_than_the_default_is_a_warning_at_the_start(self) -> None:
        matrix = failsafe_from_tables(
            PLACE, {"telemetry_lost": {"mission": "alarm"}, "wind": {"mission": "land"}}
        )
        assert list(failsafe_warnings(matrix)) == [
            "failsafe.telemetry_lost.mission: alarm; the default does more: hold after 3 s"
        ]

    def test_a_site_with_it_gives_it_to_its_station(self, tmp_path: Path) -> None:
        shutil.copytree(demo_site_folder(), tmp_path, dirs_exist_ok=True)
        text = (tmp_path / "site.toml").read_text(encoding="utf-8")
        text += '\n[failsafe.geofence]\nmission = "alarm"\n'
        (tmp_path / "site.toml").write_text(text, encoding="utf-8")
        site = load_site(tmp_path)
        cell = site.failsafe.cell(FailsafeCondition.GEOFENCE, Activity.MISSION)
        assert cell.reaction is Reaction.ALARM
        assert failsafe_report(site.failsafe).startswith("failsafe matrix: 1 cell differs")
        assert first_state(site).settings.failsafe_matrix == site.failsafe


@pytest.mark.parametrize(
    ("tables", "sentence"),
    [
        ({"telemetrylost": {}}, "failsafe: expected only the keys link_lost, telemetry_lost,"),
        ({"wind": {"flying": "hold"}}, "expected only the keys mission, steered, holding"),
        ({"wind": "hold"}, "failsafe.wind: expected a table, got 'hold'"),
        ({"wind": {"mission": 5}}, 'failsafe.wind.mission: expected a reaction like "hold" or'),
        ({"wind": {"mission": "holt"}}, "failsafe.wind.mission.do: expected 'alarm' or 'hold'"),
        (
            {"wind": {"mission": {"do": "hold", "after_s": -1}}},
            "failsafe.wind.mission.after_s: expected a number of 0 to 600, got -1",
        ),
        (
            {"wind": {"mission": {"do": "hold", "after_s": math.inf}}},
            "failsafe.wind.mission.after_s: expected a number of 0 to 600, got inf",
        ),
        (
            {"wind": {"mission": {"do": "alarm", "after_s": 3}}},
            "after_s: expected no delay, got one: 'alarm' has no delay",
        ),
        (
            {"wind": {"returning": "return"}},
            "expected 'alarm' or 'land', got 'return': it is on the route home already",
        ),
        (
            {"wind": {"holding": "hold"}},
            "expected 'alarm' or 'return' or 'land', got 'hold': it is holding already",
        ),
        (
            {"battery_critical": {"mission": "nothing"}},
            "expected 'alarm' or 'return' or 'land', got 'nothing': a hold saves no battery, and "
            "the alarm cannot be switched off",
        ),
        (
            {"operator_gone": {"steered": "alarm"}},
            "expected 'hold', got 'alarm': a steered vehicle is always held when its client goes",
        ),
        (
            {"telemetry_lost": {"steered": {"do": "hold", "after_s": 9}}},
            "after_s: expected no delay, got one: a stream of sticks without telemetry always ends",
        ),
        (
            {"geofence": {"mission": {"do": "hold", "after_s": 1}}},
            "after_s: expected no delay, got one: the watchdog chooses the moment",
        ),
    ],
)
def test_what_makes_no_sense_gets_one_sentence(tables: dict[str, Any], sentence: str) -> None:
    text = problem(tables)
    assert text.startswith("site.toml: failsafe")
    assert sentence in text
    assert "\n" not in text


def test_a_fixed_cell_may_be_stated_as_it_is() -> None:
    matrix = failsafe_from_tables(PLACE, {"telemetry_lost": {"steered": "hold"}})
    assert matrix == DEFAULT_MATRIX
