"""What a decision of a survey costs, for each vehicle that is decided on: `sunlit_first` beside the
plain rows of `lawnmower_again`, under bands of shade that move, with a forecast of five minutes.

The work is bounded by expanded nodes, so a replay is exact on any machine; seconds are measured
here. Run: uv run python -m pytest benches/guidance -s
"""

from time import process_time

import numpy as np
import pytest
from tests.guidance.survey import flyers
from tests.guidance.survey.fields import rectangle, survey_of

from recon.model.survey import SurveyBudget

FLOWN_S = 900.0


def bands(places_m: flyers.FloatArray, time_s: float) -> flyers.BoolArray:
    """Bands of shade, 130 m wide and 140 m apart, move north-east at 2 m/s."""
    along_m = (places_m[:, 0] + places_m[:, 1]) / np.sqrt(2.0) - 2.0 * time_s
    return np.asarray(np.mod(along_m, 270.0) < 140.0)


@pytest.mark.parametrize(
    ("east_m", "north_m", "drones", "budget_s"),
    [(500.0, 400.0, 3, 0.2), (1000.0, 600.0, 8, 1.0)],
    ids=["20 ha, 3 drones", "60 ha, 8 drones"],
)
def test_decisions(
    east_m: float, north_m: float, drones: int, budget_s: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    took_s = {
        planner: _decisions_s(planner, east_m, north_m, drones, monkeypatch)
        for planner in ("lawnmower_again", "sunlit_first")
    }
    print()
    for planner, found_s in took_s.items():
        p50, p99, most = 1e3 * np.quantile(found_s, [0.5, 0.99, 1.0])
        print(f"{planner:16} {len(found_s):4} decisions: {p50:.0f}, {p99:.0f}, {most:.0f} ms")
    assert len(took_s["sunlit_first"]) > 2 * drones
    assert max(took_s["sunlit_first"]) < budget_s


def _decisions_s(
    planner: str, east_m: float, north_m: float, drones: int, monkeypatch: pytest.MonkeyPatch
) -> list[float]:
    """Return the seconds of each decision of a survey, as the processor counts them."""
    took_s: list[float] = []
    plain = flyers.step

    def timed(state, *given):  # type: ignore[no-untyped-def]
        began_s = process_time()
        after, missions = plain(state, *given)
        lasted_s = process_time() - began_s
        new = [s for s, one in after.decisions.items() if one is not state.decisions.get(s)]
        decided = max(len(new), len(missions))
        if decided:
            took_s.append(lasted_s / decided)
        return after, missions

    survey = survey_of(rectangle(east_m, north_m), planner=planner, budget=SurveyBudget(rounds=20))
    fleet = flyers.fleet(drones)
    flights = flyers.Flights(flyers.begun(survey, fleet), fleet, sky=bands, foresees=True)
    with monkeypatch.context() as patch:
        patch.setattr(flyers, "step", timed)
        flights.run(FLOWN_S)
    return took_s
