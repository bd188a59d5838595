"""What guidance must reach, flown by the whole station and compared seed by seed.

    python -m studies.guidance --list
    python -m studies.guidance --only wide --seeds 10 --picture docs/images/guidance.png

Each claim is a scenario flown by `sunlit_first` and, under the same skies, by `lawnmower_again` or
in another scenario. Its figure is the geometric mean of the seeds' ratios of the time to 95 % in
sun, or the ratio of the flight times of all seeds together, with a 95 % interval. All claims take
hours. Finished runs are kept, as by `recon score`: a stopped study goes on where it was, and
`--kept` sums up what has been flown so far. At the end it states, by all landings, how probable one
below the reserve is.
"""

import argparse
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import compress
from math import isfinite
from pathlib import Path

import cv2
import numpy as np

from recon.cli.score import Chosen, Flying, runs_folder
from recon.score import RunScore, Scenario
from recon.score.interval import Interval, probability_at_most
from recon.score.kept_runs import KeptRuns
from recon.score.scenario import PERFECT
from recon.score.survey_table import SurveyRatios, survey_ratios
from recon.score.table_rows import NOTHING, bounds, fine, percent, table

FOLDER = Path(__file__).parents[1] / "scenarios"
FIRST_SEED = 1000
"""Nothing is tuned on seeds from here on."""
PLANNER, BASELINE = "sunlit_first", "lawnmower_again"
LOST_MOST = 0.15
LOW_LANDINGS_MOST = 0.01
"""Of all landings, below the battery reserve: vehicles are home with it at 0.99."""
ANY = float("inf")
PLAIN = (
    "cumulus-20",
    "cumulus-40",
    "cumulus-60",
    "two-layers",
    "thin-cirrus",
    "low-sun",
    "one-big-gap",
    "starts-in-shade",
    "wind-shift",
    "holed-11ha",
    "l-shaped-5ha",
    "one-drone",
    "eight-drones",
)
"""Scenarios whose imaging drone sees the field and little around it."""
HEAD = (
    "claim",
    "over",
    "seeds",
    "ratio",
    "95 %",
    "must",
    "lost, %",
    "violations",
    "refusals a mission",
    "stopped by watchdogs",
    "reached",
)
SKY_HEAD = ("claim", "sky, by the runs compared with", "seeds", "ratio", "flight time")
ONE_ROUND = 1.05
"""Times the fastest seed: the sky was open as it was flown."""
NEARLY_ALL = 0.94
"""Of the limit: the sky was closed for nearly all of it."""

RunPairs = tuple[list[RunScore], list[RunScore]]


@dataclass(frozen=True, slots=True)
class Claim:
    """A ratio that guidance must reach: at most `most`, with an upper bound below `bound`."""

    name: str
    scenario: str
    most: float
    bound: float = ANY
    seeds: int = 10
    over: str | None = None
    """The scenario that it is compared with; None: the same one, by the baseline."""
    planner: str = PLANNER
    forecast: str | None = None
    detection: str | None = None
    of_flight_time: bool = False
    lost_most: float = 1.0
    refusals_most: float = 1.0
    holds_most: float = 0.0

    @property
    def against(self) -> str:
        """Name what it is compared with."""
        return self.over or BASELINE

    @property
    def limit_s(self) -> float:
        """The shorter one of the two scenarios' limits."""
        return min(scenario.limit_s for _, scenario in self.compared())

    def flown(self, seeds: range, jobs: int | None) -> RunPairs:
        """Return its runs and the runs they are compared with."""
        flying = Flying(seeds, jobs, fresh=False)
        one, other = self.compared()
        return flying.runs_of(*one), flying.runs_of(*other)

    def kept(self, seeds: range) -> RunPairs:
        """Return the same, of the seeds that both were flown with before."""
        one, other = (KeptRuns.of(runs_folder(), *each) for each in self.compared())
        pairs = [(one.found(seed), other.found(seed)) for seed in seeds]
        both = [(run, against) for run, against in pairs if run and against]
        return [run for run, _ in both], [against for _, against in both]

    def compared(self) -> tuple[tuple[Path, Scenario], tuple[Path, Scenario]]:
        """Return its scenario and the one that it is compared with, each with its file.

        The baseline uses no forecast: it flies with the one that costs least to compute.
        """
        chosen = Chosen(self.planner, self.detection, self.forecast, None, surveys_only=True)
        path = _file(self.scenario)
        if self.over is not None:
            other_path = _file(self.over)
            return (path, chosen.scenario(path)), (other_path, chosen.scenario(other_path))
        baseline = replace(chosen, planner=BASELINE, forecast="climatology")
        return (path, chosen.scenario(path)), (path, baseline.scenario(path))


CLAIMS = (
    *(
        Claim(f"{cover} %, wide view", f"cumulus-{cover}-wide", 0.9, 1.0, 30, lost_most=LOST_MOST)
        for cover in (40, 60)
    ),
    Claim("two layers, perfect forecast", "two-layers-wide", 0.9, forecast=PERFECT),
    Claim("clear sky", "clear-sky", 1.05, seeds=6),
    Claim("overcast, flight time", "overcast", 0.2, of_flight_time=True),
    *(Claim(f"plain view, {name}", name, 1.03, 1.08) for name in PLAIN),
    Claim(
        "rendered frames",
        "cumulus-40",
        1.0,
        detection="sunlit_reference",
        refusals_most=0.02,
    ),
    Claim("faults under cloud", "faults-wide", 1.5, over="cumulus-40-wide", holds_most=ANY),
    Claim("faults, clear sky", "clear-sky-faults", 1.5, over="clear-sky", holds_most=ANY),
    Claim("8 drones over 3", "clear-60ha-eight", 1.0 / 2.2, seeds=3, over="clear-60ha-three"),
)


REFERENCES = tuple(
    Claim(
        f"{cover} %, {name}",
        f"cumulus-{cover}-wide",
        ANY,
        planner=planner,
        forecast=by,
        holds_most=ANY,
    )
    for cover in (40, 60)
    for name, planner, by in (
        ("perfect forecast", PLANNER, PERFECT),
        ("waiting for sun", "lawnmower_waits", None),
        ("nearest row in sun", "nearest_sunlit", None),
    )
)
"""Flown with `--references`: what a perfect forecast would bring, and what comes to mind first."""


@dataclass(frozen=True, slots=True)
class Measured:
    """A claim's runs, summed up."""

    claim: Claim
    runs: Sequence[RunScore]
    others: Sequence[RunScore]
    ratios: SurveyRatios
    violations: int
    """Encounters, landings below the reserve, and flights outside the fence."""
    refusals: float
    """For each mission."""
    holds: int
    landings: int
    low_landings: int

    @classmethod
    def of(cls, claim: Claim, runs: Sequence[RunScore], others: Sequence[RunScore]) -> "Measured":
        """Sum up the runs of a claim, and those of the same seeds that they are compared with."""
        ratios = survey_ratios(runs, others, claim.limit_s)
        violations = sum(run.encounters + run.low_landings + run.breaches for run in runs)
        missions = max(1, sum(run.missions for run in runs))
        refusals = sum(run.refusals for run in runs) / missions
        holds, landings = sum(run.holds for run in runs), sum(run.landings for run in runs)
        low = sum(run.low_landings for run in runs)
        return cls(claim, runs, others, ratios, violations, refusals, holds, landings, low)

    @property
    def ratio(self) -> Interval | None:
        """The claim's figure."""
        return self.ratios.flight_time if self.claim.of_flight_time else self.ratios.time

    @property
    def is_reached(self) -> bool:
        """Whether every part of the claim holds."""
        ratio, lost, claim = self.ratio, self.ratios.lost_share, self.claim
        if ratio is None or lost is None:
            return False
        is_fast = ratio.mean <= claim.most and ratio.high < claim.bound
        is_safe = self.violations == 0 and self.refusals <= claim.refusals_most
        is_safe = is_safe and self.holds <= claim.holds_most
        return is_fast and is_safe and lost.mean <= claim.lost_most

    @property
    def row(self) -> tuple[str, ...]:
        """Its line of the table."""
        claim, ratio, lost = self.claim, self.ratio, self.ratios.lost_share
        bound = f", below {claim.bound:g}" if isfinite(claim.bound) else ""
        return (
            claim.name,
            claim.against,
            f"{0 if ratio is None else ratio.count}",
            NOTHING if ratio is None else fine(ratio.mean),
            NOTHING if ratio is None else bounds(ratio, fine, ANY),
            f"{fine(claim.most)}{bound}" if isfinite(claim.most) else NOTHING,
            NOTHING if lost is None else percent(lost.mean),
            f"{self.violations}",
            fine(self.refusals),
            f"{self.holds}",
            "yes" if self.is_reached else "no",
        )


def measured(
    claims: Sequence[Claim], most_seeds: int | None, runs_of: Callable[[Claim, range], RunPairs]
) -> Iterator[Measured]:
    """Sum up the runs of the claims, one after the other."""
    for claim in claims:
        count = min(claim.seeds, most_seeds or claim.seeds)
        yield Measured.of(claim, *runs_of(claim, range(FIRST_SEED, FIRST_SEED + count)))


def rows_by_sky(each: Measured) -> Iterator[tuple[str, ...]]:
    """Return a claim's figures by the other runs' skies: one round, most of the limit, or less."""
    limit_s = each.claim.limit_s
    times_s = [other.to_95_in_sun_s or limit_s for other in each.others]

    def sky(took_s: float) -> str:
        if took_s >= NEARLY_ALL * limit_s:
            return "most of the limit"
        return "one round is enough" if took_s <= ONE_ROUND * min(times_s) else "between"

    skies = [sky(took_s) for took_s in times_s]
    for name in ("one round is enough", "between", "most of the limit", "all"):
        chosen = [name in (found, "all") for found in skies]
        runs, others = list(compress(each.runs, chosen)), list(compress(each.others, chosen))
        ratios = survey_ratios(runs, others, limit_s)
        figures = [
            NOTHING if figure is None else fine(figure.mean)
            for figure in (ratios.time, ratios.flight_time)
        ]
        yield (each.claim.name, name, f"{len(runs)}", *figures)


def landings_text(found: Sequence[Measured]) -> str:
    """Return how many of all landings were below the battery reserve, and how probable one is."""
    low, landings = sum(each.low_landings for each in found), sum(each.landings for each in found)
    most = probability_at_most(low, landings)
    return (
        f"Landings below the battery reserve: {low} of {landings}; the probability of one is below "
        f"{most:.4f} with 95 % confidence (must: {LOW_LANDINGS_MOST:g})"
    )


def _file(scenario: str) -> Path:
    return FOLDER / f"{scenario}.toml"


LINE_PX, LEFT_PX, WIDTH_PX, TOP_PX = 34, 330, 1000, 44
LOWEST, HIGHEST = 0.0, 1.8
INK, GREY, GOOD, SHORT = (40, 40, 40), (190, 190, 190), (60, 120, 20), (40, 60, 190)


def drawn(path: Path, found: Sequence[Measured]) -> None:
    """Draw each ratio with its interval, and the claim's limit as a tick."""
    height_px = TOP_PX + LINE_PX * len(found) + 16
    image = np.full((height_px, WIDTH_PX, 3), 255, np.uint8)

    def across(ratio: float) -> int:
        share = (min(max(ratio, LOWEST), HIGHEST) - LOWEST) / (HIGHEST - LOWEST)
        return round(LEFT_PX + share * (WIDTH_PX - LEFT_PX - 30))

    def text(words: str, x: int, y: int) -> None:
        cv2.putText(image, words, (x, y), cv2.FONT_HERSHEY_SIMPLEX, 0.5, INK, 1, cv2.LINE_AA)

    for ratio in np.arange(LOWEST, HIGHEST + 0.01, 0.2).tolist():
        cv2.line(image, (across(ratio), TOP_PX - 12), (across(ratio), height_px), GREY, 1)
        text(f"{ratio:.1f}", across(ratio) - 12, TOP_PX - 18)
    for number, each in enumerate(found):
        y = TOP_PX + LINE_PX * number + LINE_PX // 2
        text(each.claim.name, 12, y + 5)
        limit = across(each.claim.most)
        cv2.line(image, (limit, y - 12), (limit, y + 12), INK, 2)
        if each.ratio is not None:
            colour = GOOD if each.is_reached else SHORT
            if isfinite(each.ratio.high):
                low, high = across(each.ratio.low), across(each.ratio.high)
                cv2.line(image, (low, y), (high, y), colour, 2)
            cv2.circle(image, (across(each.ratio.mean), y), 6, colour, -1, cv2.LINE_AA)
    cv2.imwrite(str(path), image)


def main() -> None:
    """Fly the claims and print the table."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--list", action="store_true", help="print the claims, fly nothing")
    parser.add_argument("--only", default="", help="claims whose name or scenario contains this")
    parser.add_argument("--kept", action="store_true", help="sum up earlier runs, fly nothing")
    parser.add_argument("--by-sky", action="store_true", help="ratios of open and closed skies too")
    parser.add_argument("--references", action="store_true", help="fly what is compared with")
    parser.add_argument("--seeds", type=int, help="at most so many of each claim")
    parser.add_argument("--jobs", type=int, help="runs at once; default: one for each core")
    parser.add_argument("--picture", type=Path, help="PNG file to draw")
    asked = parser.parse_args()
    known = REFERENCES if asked.references else CLAIMS
    claims = [each for each in known if asked.only in f"{each.name} {each.scenario}"]
    if not claims:
        parser.error(f"--only: expected a part of a claim's name, as by --list, got {asked.only!a}")
    if asked.list:
        rows = [(e.name, e.scenario, e.against, f"{e.seeds}", fine(e.most)) for e in claims]
        print(table(("claim", "scenario", "over", "seeds", "must"), rows))
        return
    found: list[Measured] = []
    print(table(HEAD, ()), flush=True)

    def runs_of(claim: Claim, seeds: range) -> RunPairs:
        return claim.kept(seeds) if asked.kept else claim.flown(seeds, asked.jobs)

    for each in measured(claims, asked.seeds, runs_of):
        found.append(each)
        print(f"| {' | '.join(each.row)} |", flush=True)
    if asked.by_sky:
        print(f"\n{table(SKY_HEAD, [row for each in found for row in rows_by_sky(each)])}")
    print(f"\n{landings_text(found)}")
    if asked.picture is not None:
        drawn(asked.picture, found)


if __name__ == "__main__":
    main()
