"""Who gives memory back first, and when a limit's alarm ends: without sockets."""

from recon.link.settings import MIB
from recon.link.shared_limits import MEMORY, PLACES, BufferBudget, LimitAlarms
from recon.model.event import LinkLimitReached

S = 1_000_000_000


def test_within_the_budget_nothing_goes() -> None:
    budget = BufferBudget(10 * MIB, max_links=10)
    budget.note(1, 6 * MIB)
    budget.note(2, 6 * MIB)
    budget.note(1, 4 * MIB)
    assert budget.to_free(lambda _: False) is None


def test_the_oldest_unidentified_link_with_more_than_its_share_goes_first() -> None:
    budget = BufferBudget(10 * MIB, max_links=10)
    for link_id, held_mib in ((1, 9), (2, 1), (4, 2), (3, 3)):
        budget.note(link_id, held_mib * MIB)
    over = budget.to_free(lambda link_id: link_id == 1)
    assert over is not None
    assert over.link_id == 3
    assert "unidentified link 3 closed" in over.problem
    budget.note(3, 0)
    assert getattr(budget.to_free(lambda link_id: link_id == 1), "link_id", None) == 4


def test_among_identified_links_the_largest_packet_goes() -> None:
    budget = BufferBudget(10 * MIB, max_links=10)
    budget.note(1, 5 * MIB)
    budget.note(2, 6 * MIB)
    over = budget.to_free(lambda _: True)
    assert over is not None
    assert over.link_id == 2
    assert "half-received packet of link 2 dropped" in over.problem


def test_a_limit_is_one_alarm_until_it_is_over() -> None:
    alarms = LimitAlarms(lingers_s=10.0)
    assert alarms.reached(MEMORY, "too much", 0) == LinkLimitReached(MEMORY, "too much")
    assert alarms.reached(MEMORY, "again", 5 * S) is None
    assert alarms.reached(PLACES, "full", 5 * S) == LinkLimitReached(PLACES, "full")
    assert alarms.over(15 * S, has_places=False) == []
    assert alarms.over(15 * S + 1, has_places=False) == [LinkLimitReached(MEMORY, None)]
    assert alarms.over(16 * S, has_places=True) == [LinkLimitReached(PLACES, None)]
    assert alarms.over(17 * S, has_places=True) == []
