"""What a fleet's return costs: the plan, a look at whose turn it is, the time until all are down.

The baseline of the return is the same plan flown one vehicle after the other. Run:
uv run python -m pytest benches/guidance -s
"""

from time import process_time

import pytest
from tests.guidance.returning_fleet import fly
from tests.guidance.returning_scenes import KEPT, LEAST, SETTINGS, drawn_scene

from recon.guidance.fleet_return import (
    Hovering,
    ReturnPlan,
    claim_left,
    hindrance,
    layer_is_taken_by,
    whole_claim,
)

PLAN_BUDGET_S = 2.0
"""The worker makes it, beside frames that take a third of a second each."""

LOOK_BUDGET_S = 0.05
"""Five times a second within the station's step; a tenth of this on a quiet machine."""


@pytest.mark.parametrize(("count", "pads"), [(8, 8), (8, 1), (24, 24), (24, 6), (64, 64)])
def test_fleet_return(count: int, pads: int) -> None:
    scene = drawn_scene(5, count, pads, 120.0, 2)
    began_s = process_time()
    plan = scene.plan()
    plan_s = process_time() - began_s
    look_s = _longest_look_s(plan)
    down_s = fly(plan, {}, KEPT, LEAST, SETTINGS, seed=5).lasted_s
    alone = [ReturnPlan(plan.layers_up_m, (flight,), ()) for flight in plan.flights]
    one_by_one_s = sum(fly(one, {}, KEPT, LEAST, SETTINGS, seed=5).lasted_s for one in alone)
    print(
        f"\n{count} vehicles, {pads} pads, {len(plan.layers_up_m)} layers, {len(plan.waves)} "
        f"waves, {len(plan.excluded)} excluded: plan {plan_s * 1e3:.0f} ms, look "
        f"{look_s * 1e3:.1f} ms; all down after {down_s:.0f} s, one by one {one_by_one_s:.0f} s"
    )
    assert plan_s < PLAN_BUDGET_S
    assert look_s < LOOK_BUDGET_S
    assert down_s <= one_by_one_s


def _longest_look_s(plan: ReturnPlan) -> float:
    """The longest time to find out who may begin, while the first wave gets under way."""
    flights, longest_s = list(plan.flights), 0.0
    under_way = []
    places = {f.serial: Hovering(f.serial, f.name, f.start_m) for f in flights}
    for _ in range(len(plan.layers_up_m)):
        began_s = process_time()
        claims = [claim_left(f, f.start_m, SETTINGS) for f in under_way]
        moving = {f.serial for f in under_way}
        before, begins = [], None
        for flight in flights:
            hovering = [h for key, h in places.items() if key not in moving | {flight.serial}]
            taken = layer_is_taken_by(flight, before, under_way)
            earlier = [whole_claim(f) for f in before] if taken is None else []
            if taken is None and hindrance(flight, earlier, claims, hovering, KEPT) is None:
                begins = flight
                break
            before.append(flight)
        longest_s = max(longest_s, process_time() - began_s)
        if begins is None:
            break
        under_way.append(begins)
        flights.remove(begins)
    return longest_s
