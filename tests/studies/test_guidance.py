"""A claim about guidance is reached only if each part of it holds, and its table states which."""

from dataclasses import replace
from pathlib import Path

import cv2
import pytest
from studies.guidance import (
    CLAIMS,
    FIRST_SEED,
    REFERENCES,
    Claim,
    Measured,
    drawn,
    landings_text,
    main,
    rows_by_sky,
)
from tests.score.test_survey_table import run_score

from recon.score import RunScore, load_scenario
from recon.score.kept_runs import KeptRuns, runs_digest

CLAIM = Claim("40 %, wide view", "cumulus-40-wide", 0.9, 1.0, 30, lost_most=0.15)
SEEDS = range(10)
SAFE = replace(run_score(0, None), missions=20)


def found(ratio: float, claim: Claim = CLAIM, like: RunScore = SAFE) -> Measured:
    runs = [replace(like, seed=seed, to_95_in_sun_s=ratio * 1000.0) for seed in SEEDS]
    others = [run_score(seed, 1000.0) for seed in SEEDS]
    return Measured.of(claim, runs, others)


def test_what_is_fast_and_safe_is_reached() -> None:
    measured = found(0.8)
    assert measured.is_reached
    assert measured.row[:6] == (
        "40 %, wide view",
        "lawnmower_again",
        "10",
        "0.80",
        "0.80 to 0.80",
        "0.90, below 1",
    )


@pytest.mark.parametrize(
    "short",
    [
        found(0.95),
        found(0.8, like=replace(SAFE, encounters=1)),
        found(0.8, like=replace(SAFE, low_landings=1)),
        found(0.8, like=replace(SAFE, breaches=1)),
        found(0.8, like=replace(SAFE, holds=1)),
        found(0.8, replace(CLAIM, refusals_most=0.02), replace(SAFE, refusals=1)),
        found(1.06, replace(CLAIM, most=1.1, bound=2.0)),
        found(0.8, replace(CLAIM, of_flight_time=True, most=0.5)),
    ],
)
def test_what_falls_short_in_one_part_is_not(short: Measured) -> None:
    assert not short.is_reached
    assert short.row[-1] == "no"


def test_no_low_landing_of_300_is_a_probability_below_a_hundredth() -> None:
    safe = found(0.8, like=replace(SAFE, landings=30))
    text = "Landings below the battery reserve: {}; the probability of one is below {} "
    assert landings_text([safe]).startswith(text.format("0 of 300", "0.0099"))
    one = replace(safe, low_landings=1)
    assert landings_text([safe, one]).startswith(text.format("1 of 600", "0.0079"))


def test_watchdogs_stop_vehicles_only_where_there_are_faults() -> None:
    faults = replace(CLAIM, holds_most=float("inf"))
    assert found(0.8, faults, replace(SAFE, holds=3)).is_reached
    assert [each.scenario for each in CLAIMS if each.holds_most > 0.0] == [
        "faults-wide",
        "clear-sky-faults",
    ]


def test_a_wide_interval_is_not_reached_whatever_its_mean() -> None:
    runs = [run_score(seed, 1600.0 if seed == 3 else 700.0 + seed) for seed in range(4)]
    others = [run_score(seed, 1000.0) for seed in range(4)]
    measured = Measured.of(replace(CLAIM, most=1.0, lost_most=1.0), runs, others)
    assert measured.ratio is not None
    assert measured.ratio.mean < 1.0 < measured.ratio.high
    assert not measured.is_reached


def test_every_claim_is_about_scenarios_that_exist() -> None:
    for claim in (*CLAIMS, *REFERENCES):
        names = [claim.scenario, *([] if claim.over is None else [claim.over])]
        for name in names:
            path = Path(__file__).parents[2] / "scenarios" / f"{name}.toml"
            assert load_scenario(path).name == name


FLOWN = (*CLAIMS, *REFERENCES)


@pytest.mark.parametrize("claim", FLOWN, ids=[claim.name for claim in FLOWN])
def test_every_claims_scenarios_and_methods_can_be_flown(claim: Claim) -> None:
    no_seeds = range(FIRST_SEED, FIRST_SEED)
    assert claim.flown(no_seeds, jobs=1) == ([], [])
    assert claim.limit_s > 0.0


def test_what_is_kept_are_the_seeds_that_both_were_flown_with(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("studies.guidance.runs_folder", lambda: tmp_path)
    one, other = (KeptRuns.of(tmp_path, *each) for each in CLAIM.compared())
    for seed in (FIRST_SEED, FIRST_SEED + 2):
        one.keep(run_score(seed, 700.0))
    for seed in (FIRST_SEED + 1, FIRST_SEED + 2):
        other.keep(run_score(seed, 1000.0))
    both = ([run_score(FIRST_SEED + 2, 700.0)], [run_score(FIRST_SEED + 2, 1000.0)])
    assert CLAIM.kept(range(FIRST_SEED, FIRST_SEED + 3)) == both
    assert CLAIM.kept(range(FIRST_SEED, FIRST_SEED + 2)) == ([], [])


def test_claims_of_one_scenario_share_the_runs_of_its_baseline() -> None:
    usual, other = replace(CLAIM, forecast=None), replace(CLAIM, forecast="perfect")
    (path, flown), (baseline_path, baseline) = other.compared()
    assert (flown.methods.forecast, flown.survey.planner) == ("perfect", "sunlit_first")
    assert baseline.survey.planner == "lawnmower_again"
    assert path == baseline_path
    assert runs_digest(path, baseline, "") == runs_digest(path, usual.compared()[1][1], "")
    assert runs_digest(path, flown, "") != runs_digest(path, usual.compared()[0][1], "")


def test_by_sky_a_seed_counts_where_the_other_run_has_it_and_one_that_never_flew_counts() -> None:
    times_s = ((270.0, 275.0, 1000.0), (280.0, 280.0, 1000.0), (500.0, 1000.0, 400.0))
    flown = [replace(run_score(n, a), flight_s=f) for n, (a, _, f) in enumerate(times_s)]
    others = [replace(run_score(n, b), flight_s=1000.0) for n, (_, b, _) in enumerate(times_s)]
    flown.append(replace(run_score(3, None), flight_s=0.0))
    others.append(replace(run_score(3, None), flight_s=1000.0))
    rows = {row[1]: row[2:] for row in rows_by_sky(Measured.of(CLAIM, flown, others))}
    assert rows == {
        "one round is enough": ("2", "0.99", "1.00"),
        "between": ("1", "0.50", "0.40"),
        "most of the limit": ("1", "1.00", "0.00"),
        "all": ("4", "0.84", "0.60"),
    }


def test_a_sky_that_is_closed_in_every_seed_is_no_open_one() -> None:
    never = [run_score(seed, None) for seed in range(2)]
    rows = {row[1]: row[2] for row in rows_by_sky(Measured.of(CLAIM, never, never))}
    assert rows == {
        "one round is enough": "0",
        "between": "0",
        "most of the limit": "2",
        "all": "2",
    }


def test_of_one_seed_no_interval_is_drawn(tmp_path: Path) -> None:
    alone = Measured.of(CLAIM, [run_score(0, 800.0)], [run_score(0, 1000.0)])
    drawn(tmp_path / "one.png", [alone])
    image = cv2.imread(str(tmp_path / "one.png"))
    assert image is not None
    coloured = (image.max(axis=2).astype(int) - image.min(axis=2) > 40).any(axis=0).nonzero()[0]
    assert 0 < coloured[-1] - coloured[0] < 20


def test_a_name_that_no_claim_has_is_a_sentence(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr("sys.argv", ["guidance", "--only", "sunny"])
    with pytest.raises(SystemExit):
        main()
    assert "--only: expected a part of a claim's name, as by --list, got 'sunny'" in (
        capsys.readouterr().err
    )


def test_the_picture_has_a_line_for_each_claim(tmp_path: Path) -> None:
    drawn(tmp_path / "two.png", [found(0.8), found(0.95)])
    drawn(tmp_path / "one.png", [found(0.8)])
    two, one = (cv2.imread(str(tmp_path / name)) for name in ("two.png", "one.png"))
    assert two is not None
    assert one is not None
    assert two.shape[0] > one.shape[0]
    assert (two[: one.shape[0] - 16] == one[:-16]).all()
