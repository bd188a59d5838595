"""Exposure and white balance, locked from the station and confirmed by what the app reads back."""

from tests.station.returning_world import ReturningWorld, returning_world

from recon.model.command import LockCamera, Phase
from recon.model.event import OperatorOrder
from recon.model.vehicle import Failsafe
from recon.station.state.orders import OrderRecord

PLACE, PAD = (0.0, 0.0, 40.0), (0.0, -40.0)


def ordered(world: ReturningWorld, number: int, is_locked: bool) -> OrderRecord:
    driver = world.world.driver
    driver.handle(OperatorOrder(number, LockCamera(is_locked), "ann", serial="SIM-1"))
    world.runs(3.0)
    return driver.station.orders.records[number]


def test_it_is_locked_and_unlocked_and_done_when_read_back() -> None:
    world = returning_world([PLACE], [PAD], photo_interval_s=2.0, failsafe=Failsafe.GO_HOME)
    reporter = world.world.app("SIM-1").reporter
    assert reporter is not None
    for number, is_locked in ((500, True), (501, False)):
        record = ordered(world, number, is_locked)
        assert record.phase is Phase.DONE, record.note
        assert reporter.is_locked is is_locked


def test_an_app_that_does_not_read_it_back_is_not_believed() -> None:
    world = returning_world(
        [PLACE],
        [PAD],
        photo_interval_s=2.0,
        failsafe=Failsafe.GO_HOME,
        faults=("ack-then-nothing:SIM-1",),
    )
    assert ordered(world, 500, True).phase is Phase.ACKNOWLEDGED


def test_a_plain_app_is_never_sent_the_order() -> None:
    world = returning_world([PLACE], [PAD])
    record = ordered(world, 500, True)
    assert record.refusal is not None
    assert record.refusal.rule == "dji_limits"
    assert "lock them in the app" in record.refusal.reason
