"""Reading scenario files; errors have file, line, expected and actual value."""

import tomllib
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st
from tests.score.scenes import SMALL, small, written

from recon.detection import DETECTORS
from recon.forecast import FORECASTERS
from recon.guidance.survey import PLANNERS
from recon.model.survey import PLANNER_GOALS
from recon.score import ScenarioError, load_scenario
from recon.score.scenario_schema import METHOD_NAMES, key_lines, line_of

FOLDER = Path(__file__).parents[2] / "scenarios"
FILES = sorted(FOLDER.rglob("*.toml"))
EXPECTED = {
    "clear-sky",
    "thin-cirrus",
    "cumulus-20",
    "cumulus-40",
    "cumulus-60",
    "two-layers",
    "wind-shift",
    "wind-shift-upwind",
    "overcast",
    "one-big-gap",
    "fault-storm",
    "one-drone",
    "eight-drones",
    "l-shaped-5ha",
    "holed-11ha",
    "large-60ha",
    "starts-in-shade",
    "low-sun",
    "auto-exposure-hard",
    "cumulus-40-wide",
    "cumulus-60-wide",
    "fast-cumulus",
    "fast-cumulus-wide",
    "cumulus-40-upwind",
    "cumulus-40-tilted",
    "two-layers-wide",
    "clear-60ha-three",
    "clear-60ha-eight",
    "faults-wide",
    "clear-sky-faults",
    "clear-sky-steered",
    "stress/cumulus-20",
    "stress/cumulus-40",
    "stress/cumulus-60",
    "stress/two-layers",
}


WITHOUT = "radius_m = 160.0\n"


def with_conditions(line: str) -> str:
    return f"{WITHOUT}[conditions]\n{line}\n"


def fault_of(folder: Path, old: str, new: str) -> str:
    """Return the error for the small scenario with one change, without the folder."""
    assert SMALL.count(old) == 1
    with pytest.raises(ScenarioError) as caught:
        load_scenario(written(folder, SMALL.replace(old, new)))
    return str(caught.value).removeprefix(f"{folder}/")


def test_all_documented_scenarios_exist() -> None:
    assert {str(path.relative_to(FOLDER).with_suffix("")) for path in FILES} == EXPECTED


@pytest.mark.parametrize("path", FILES, ids=lambda path: str(path.relative_to(FOLDER)))
def test_every_scenario_loads(path: Path) -> None:
    scenario = load_scenario(path)
    assert scenario.name == path.stem
    assert scenario.survey.budget.time_s == scenario.limit_s > 0.0
    least, most = (
        scenario.survey.region.outline_m.min(axis=0),
        scenario.survey.region.outline_m.max(axis=0),
    )
    assert (most - least > 100.0).all()


def test_scenarios_have_the_fleet_holes_and_layers_of_their_names() -> None:
    for name, count in (("one-drone", 1), ("cumulus-40", 3), ("eight-drones", 8)):
        assert len(load_scenario(FOLDER / f"{name}.toml").fleet.pads_m) == count
    assert len(load_scenario(FOLDER / "holed-11ha.toml").survey.region.holes_m) == 1
    assert len(load_scenario(FOLDER / "two-layers.toml").clouds) == 2
    assert load_scenario(FOLDER / "clear-sky.toml").clouds == ()


def test_values_of_the_file_are_in_the_scenario(tmp_path: Path) -> None:
    scenario = small(tmp_path)
    assert scenario.sun.start_utc_s == 1_750_435_200.0
    assert scenario.frame.origin.ellipsoid_height_m == 280.0
    assert scenario.fleet.pads_m == ((87.5, -30.0), (112.5, -30.0))
    assert scenario.imager.over_m == (100.0, 75.0)
    assert [clouds.layer.cover for clouds in scenario.clouds] == [0.4]
    assert scenario.faults[0].start_s == 40.0


def test_the_task_may_forbid_a_side_step(tmp_path: Path) -> None:
    assert small(tmp_path).survey.side_step_allowed
    forbidden = SMALL.replace("[task]", "[task]\nside_step = false")
    assert not load_scenario(written(tmp_path, forbidden)).survey.side_step_allowed


def test_the_task_may_allow_a_move_upwind_and_the_site_has_room_for_it(tmp_path: Path) -> None:
    plain = small(tmp_path)
    assert not plain.survey.upwind_allowed
    allowing = load_scenario(written(tmp_path, SMALL.replace("[task]", "[task]\nupwind = true")))
    assert allowing.survey.upwind_allowed
    boundaries = [each.site.layers.boundary for each in (allowing, plain)]
    widths_m = [
        0.0 if b is None else float(b.outline_m[:, 0].max() - b.outline_m[:, 0].min())
        for b in boundaries
    ]
    assert widths_m[0] > widths_m[1] + 300.0


def test_method_names_are_those_of_the_registries() -> None:
    assert METHOD_NAMES["detection"] == ("ideal", *DETECTORS)
    assert METHOD_NAMES["forecast"] == ("none", "perfect", *FORECASTERS)
    assert METHOD_NAMES["planner"] == tuple(PLANNERS) == tuple(PLANNER_GOALS)


@pytest.mark.parametrize(
    ("kind", "name"), [(kind, name) for kind, names in METHOD_NAMES.items() for name in names]
)
def test_every_registered_method_is_accepted(tmp_path: Path, kind: str, name: str) -> None:
    scenario = small(tmp_path, SMALL.replace("[imager]", f'[methods]\n{kind} = "{name}"\n[imager]'))
    methods = scenario.methods
    found = {"planner": scenario.survey.planner}
    found |= {"detection": methods.detection, "forecast": methods.forecast}
    assert found[kind] == name


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ("T16:00:00Z", "T06:00:00Z", "start_utc: expected a time at which the sun is 5 degrees"),
        ("cover = 0.4", "cover = 1.4", "clouds[0].cover: expected 0 to 1, got 1.4"),
        ("cover = 0.4", "covers = 0.4", "got 'covers'; did you mean 'cover'?"),
        ("cover = 0.4", 'cover = "much"', "clouds[0].cover: expected a number, got 'much'"),
        ("survey_drones = 2", "survey_drones = 0", "expected a whole number of 1 to 16, got 0"),
        ("survey_drones = 2", "drones = 2", "expected only the keys survey_drones,"),
        ("latitude_deg = 41.9", "latitude_deg = 141.9", "a number of -89 to 89, got 141.9"),
        ("limit_min = 10.0", "limit_min = -1.0", "task.limit_min: expected a number"),
        ("limit_min = 10.0", "speed_mps = 14.0\nlimit_min = 10.0", "fly at 8.8 m/s at most"),
        ("[200.0, 0.0],", "[200.0],", "task.region_m[1]: expected [east, north] in metres, got a"),
        ("[200.0, 0.0],\n    [200.0, 150.0]", "[200.0, 150.0],\n    [200.0, 0.0]", "cannot be sur"),
        ('"pilot-takes:1:40:30"', '"gremlins"', "faults[0]: fault 'gremlins': expected one of"),
        ('"pilot-takes:1:40:30"', '"pilot-takes:7"', "faults[0]: expected a vehicle of SIM-1, S"),
        (
            WITHOUT,
            with_conditions("period_s = 300"),
            "conditions.period_s: expected 0.2 to 60, got",
        ),
        (WITHOUT, with_conditions("hot_spot = [0.6, 0.2]"), "expected the lower value first, got"),
        (
            WITHOUT,
            with_conditions("hot_spot = true"),
            "hot_spot: expected a number or [lowest, high",
        ),
        (
            WITHOUT,
            with_conditions("hot_spot = [1.0]"),
            "hot_spot: expected a number or [lowest, high",
        ),
        (WITHOUT, with_conditions("exposure_locked = 1"), "expected true or false, got 1"),
        (
            WITHOUT,
            with_conditions("hotspot = 1"),
            "conditions: expected only the keys sun_elevation",
        ),
        (WITHOUT, with_conditions("sun_elevation_deg = 80"), "as the sun has on that day, got 80"),
        (
            "speed_10m_mps = 4.0",
            "speed_10m_mps = 50.0",
            "wind.speed_10m_mps: expected 0 to 40, got",
        ),
        ("limit_min = 10.0", "limit_min = nan", "task.limit_min: expected a number, got nan"),
        ("[200.0, 150.0]", "[nan, 150.0]", "task.region_m[2][0]: expected a number, got nan"),
        ("[200.0, 150.0]", "[inf, 150.0]", "task.region_m[2][0]: expected a number of -50000 to"),
        ("2025-06-20T16:00:00Z", "2025-06-20T16:00:00", "expected a moment like 2025-06-20T16:00"),
        ("2025-06-20T16:00:00Z", '"today"', "start_utc: expected a moment like 2025-06-20T16:00"),
        ("[imager]", '[methods]\nplanner = "magic"\n[imager]', "or 'sunlit_first', got 'magic'"),
        (
            "[imager]",
            '[methods]\ndetection = "otsu"\nforecast = "perfect"\n[imager]',
            "methods.forecast: expected detection ideal with the forecast perfect, got detection "
            "otsu: choose detection ideal, or another forecast",
        ),
    ],
)
def test_errors_name_file_and_line(tmp_path: Path, old: str, new: str, words: str) -> None:
    text = fault_of(tmp_path, old, new)
    assert words in text
    assert text.startswith("small.toml:")


@pytest.mark.parametrize(
    ("old", "new", "line"),
    [
        ("cover = 0.4", "cover = 1.4", 24),
        ("cover = 0.4", "covers = 0.4", 24),
        ("survey_drones = 2", "survey_drones = 0", 18),
        ("[200.0, 0.0],", "[200.0],", 11),
        ("[imager]", '[methods]\ndetection = "otsu"\nforecast = "perfect"\n[imager]', 22),
        ('"pilot-takes:1:40:30"', '"gremlins"', 3),
        ("[wind]\nspeed_10m_mps = 4.0", "[wind]\nspeed_10m_mps = 99.0", 28),
    ],
)
def test_error_lines_are_those_of_the_keys(tmp_path: Path, old: str, new: str, line: int) -> None:
    assert fault_of(tmp_path, old, new).startswith(f"small.toml:{line}: ")


def test_missing_file_invalid_toml_and_invalid_text_are_errors(tmp_path: Path) -> None:
    with pytest.raises(ScenarioError, match="cannot read scenario file: No such file"):
        load_scenario(tmp_path / "none.toml")
    with pytest.raises(ScenarioError, match=r"small.toml:2: expected a TOML file, got: "):
        load_scenario(written(tmp_path, 'about = "x"\nlimit = = 3\n'))
    (tmp_path / "bytes.toml").write_bytes(b'about = "x"\n\xff\xfe')
    with pytest.raises(ScenarioError, match=r"bytes.toml:2: expected UTF-8 text"):
        load_scenario(tmp_path / "bytes.toml")


@given(st.binary(max_size=200))
def test_arbitrary_bytes_raise_a_scenario_error(
    tmp_path_factory: pytest.TempPathFactory, data: bytes
) -> None:
    path = tmp_path_factory.mktemp("any") / "any.toml"
    path.write_bytes(data)
    with pytest.raises(ScenarioError):
        load_scenario(path)


@pytest.mark.parametrize("path", FILES, ids=lambda path: str(path.relative_to(FOLDER)))
def test_key_lines_match_the_file(path: Path) -> None:
    text = path.read_text(encoding="utf-8")
    lines = key_lines(text)
    for table, values in tomllib.loads(text).items():
        tables = values if isinstance(values, list) else [values]
        for index, each in enumerate(tables):
            for key in each if isinstance(each, dict) else ():
                where = f"{table}[{index}]" if isinstance(values, list) else table
                line = line_of(lines, f"{where}.{key}")
                assert line is not None
                assert text.splitlines()[line - 1].startswith(f"{key} =")
