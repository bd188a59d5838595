"""Two vehicles with pads 5 m apart come home together: the separation holds must not make it worse.

Each pair is flown twice, with the holds switched on and off, and judged by the simulator's truth in
shares of what must be kept: below 1 the two are nearer than 15 m and than 6 m in height.
"""

from dataclasses import dataclass
from math import cos, hypot, pi, sin
from random import Random

import pytest
from tests.station.returning_world import (
    LEAST_HEIGHT_M,
    LEAST_LEVEL_M,
    ReturningWorld,
    returning_world,
)

from recon.model.command import Body, LandNow, ReturnHome
from recon.model.event import SeparationHoldSwitched

PADS_M = [(0.0, 0.0), (5.0, 0.0)]
LATEST_S = 70.0

Place = tuple[float, float, float]


@dataclass(frozen=True, slots=True)
class Homecoming:
    """Where each of the two is, what it is ordered, and when."""

    places_m: tuple[Place, Place]
    bodies: tuple[Body, Body]
    at_s: tuple[float, float]

    def flown(self, *, holds: bool) -> tuple[float, list[str]]:
        """Return the least closeness while both fly, and who was held, in order."""
        made = returning_world(self.places_m, PADS_M)
        if not holds:
            made.world.driver.handle(SeparationHoldSwitched(False, "test"))
        serials, held = list(made.pads_m), list[str]()
        nearest, now_s, ordered = closeness(made), 0.0, set[str]()
        while now_s < LATEST_S and all(made.flies(serial) for serial in serials):
            for serial, body, at_s in zip(serials, self.bodies, self.at_s, strict=True):
                if at_s <= now_s and serial not in ordered:
                    ordered.add(serial)
                    made.world.order(serial, body)
            nearest = min(nearest, closeness(made))
            made.runs(0.2)
            now_s += 0.2
            now_held = made.world.driver.station.watchdog_state.held
            held += [serial for serial in now_held if serial not in held]
        return nearest, held


def closeness(made: ReturningWorld) -> float:
    one, other = (made.place_m(serial) for serial in made.pads_m)
    level_m = hypot(one[0] - other[0], one[1] - other[1])
    return max(level_m / LEAST_LEVEL_M, abs(one[2] - other[2]) / LEAST_HEIGHT_M)


def drawn(seed: int) -> Homecoming:
    """Any two routes home: from above or from the side, landing or returning, one later or not."""
    rng = Random(seed)
    bodies: list[Body] = [rng.choice((LandNow(), ReturnHome(), ReturnHome())) for _pad in PADS_M]
    places: list[Place] = []
    for body, (east_m, north_m) in zip(bodies, PADS_M, strict=True):
        far_m = rng.uniform(0.0, 2.0) if isinstance(body, LandNow) else rng.uniform(5.0, 80.0)
        bearing = rng.uniform(0.0, 2.0 * pi)
        up_m = rng.uniform(15.0, 60.0)
        places.append((east_m + far_m * sin(bearing), north_m + far_m * cos(bearing), up_m))
    at_s = rng.uniform(0.0, 8.0), rng.uniform(0.0, 8.0)
    return Homecoming((places[0], places[1]), (bodies[0], bodies[1]), at_s)


def test_the_upper_one_is_held_when_it_sinks_past_a_lower_one_that_hovers() -> None:
    both = Homecoming(
        ((0.0, 0.0, 34.0), (5.0, 0.0, 24.0)), (LandNow(), ReturnHome()), (7.0, 1_000.0)
    )
    nearest, held = both.flown(holds=True)
    assert held == ["SIM-1"]
    assert nearest >= 1.0
    assert both.flown(holds=False)[0] < 1.0


def test_the_lower_one_is_not_held_while_it_lands_below_one_that_comes_home() -> None:
    """SIM-2 is the one to yield by its serial; held, it would hang in the way of the other."""
    both = Homecoming(
        ((-100.0, 50.0, 58.0), (5.0, 0.0, 50.0)), (ReturnHome(), ReturnHome()), (1.0, 0.0)
    )
    nearest, held = both.flown(holds=True)
    assert "SIM-2" not in held
    assert nearest >= 1.0


@pytest.mark.parametrize("seed", range(10))
def test_holding_never_makes_a_homecoming_worse(seed: int) -> None:
    both = drawn(seed)
    with_holds, held = both.flown(holds=True)
    without, _nobody = both.flown(holds=False)
    assert with_holds >= min(1.0, without - 0.02), held
