"""Battery critical: recalled at once; one that returns is landed only if the site says so."""

from tests.station.failsafe.reacting import (
    A,
    hovering,
    in_mission,
    issued_s,
    reactions,
    steered,
    with_cell,
)
from tests.station.failsafe.test_battery_low import drains_to

from recon.model.command import ReturnHome
from recon.model.failsafe_matrix import Activity, FailsafeCondition, Reaction
from recon.model.vehicle import FlightMode

HOME = (A, "return_home", "station: battery critical")
CRITICAL = FailsafeCondition.BATTERY_CRITICAL


def test_in_a_mission_steered_or_holding_it_is_called_home_at_once() -> None:
    for start in (in_mission, steered, hovering):
        w = start()
        seen_s = drains_to(w, 0.095)
        w.run_for(2.0)
        assert reactions(w) == [HOME]
        assert issued_s(w) - seen_s <= 0.2
        assert w.vehicle(A).flight_mode.value is FlightMode.GO_HOME


def test_one_that_returns_is_landed_where_it_is_only_if_the_site_says_so() -> None:
    land = with_cell(CRITICAL, Activity.RETURNING, Reaction.LAND)
    for matrix, expected in ((None, []), (land, [(A, "land", "station: battery critical")])):
        w = in_mission() if matrix is None else in_mission(matrix=matrix)
        w.run_for(20.0)
        w.order(A, ReturnHome())
        w.run_for(2.0)
        drains_to(w, 0.095)
        w.run_for(1.5)
        assert reactions(w) == expected
