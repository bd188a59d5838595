"""Two planners or detections compared seed by seed."""

from dataclasses import replace

from recon.score.run_score import RunScore
from recon.score.shade_figures import ShadeFigures
from recon.score.survey_table import survey_table


def run_score(seed: int, to_95_in_sun_s: float | None) -> RunScore:
    return RunScore(
        seed=seed,
        shade=ShadeFigures(),
        to_right_s=None,
        registration_m=None,
        forecasts={},
        in_sun_share=(),
        to_95_imaged_s=300.0,
        to_95_in_sun_s=to_95_in_sun_s,
        counted_in_sun=0,
        wrongly_in_sun=0,
        survey_s=4_000.0,
        flight_s=1_000.0,
        missions=10,
        photos=0,
        shaded_photos=0,
        encounters=0,
        landings=3,
        low_landings=0,
        end="",
    )


def test_it_pairs_the_seeds_and_counts_an_unfinished_survey_as_the_limit() -> None:
    ours = [run_score(seed=1, to_95_in_sun_s=500.0), run_score(seed=2, to_95_in_sun_s=1_000.0)]
    theirs = [
        run_score(seed=2, to_95_in_sun_s=None),
        run_score(seed=1, to_95_in_sun_s=400.0),
        run_score(seed=3, to_95_in_sun_s=1.0),
    ]
    lines = survey_table(ours, theirs, "lawnmower_again", 3_200.0).splitlines()
    assert lines[0] == "| over lawnmower_again | ratio | 95 % | runs |"
    # The geometric mean of 500/400 and 1000/3200.
    assert lines[2].startswith("| time to 95 % in sun | 0.62 |")
    assert lines[2].endswith("| 2 |")
    assert lines[3].startswith("| seeds lost by more than 5 %, % | 50.0 |")


def test_the_flight_time_is_that_of_all_seeds_also_of_one_in_which_nothing_flies() -> None:
    ours = [replace(run_score(seed, 500.0), flight_s=200.0 * seed) for seed in range(3)]
    theirs = [run_score(seed, 500.0) for seed in range(3)]
    lines = survey_table(ours, theirs, "lawnmower_again", 3_200.0).splitlines()
    assert lines[4].startswith("| flight time | 0.20 |")
    assert lines[4].endswith("| 3 |")
