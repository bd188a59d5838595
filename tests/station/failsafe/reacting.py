"""Simulated vehicles in virtual time under a failsafe matrix, and what the station orders."""

from dataclasses import replace

from tests.station.station_world import World, square_mission, world

from recon.geo.distance import moved_m
from recon.model.command import FlyMission, GoTo, Phase
from recon.model.event import OperatorOrder, OwnerConnected
from recon.model.failsafe_matrix import (
    Activity,
    FailsafeCell,
    FailsafeCondition,
    FailsafeMatrix,
    Reaction,
)
from recon.safety.failsafe import DEFAULT_MATRIX
from recon.station.state.orders import OrderRecord

A, B = "SIM-1", "SIM-2"
OWNER = "the-console-of-an-operator"
HIGH_M = 60.0
STEERED_ORDER = 900


def with_cell(
    condition: FailsafeCondition,
    activity: Activity,
    reaction: Reaction,
    after_s: float = 0.0,
    matrix: FailsafeMatrix = DEFAULT_MATRIX,
) -> FailsafeMatrix:
    """A matrix with one cell changed."""
    row = {**matrix.rows[condition], activity: FailsafeCell(reaction, after_s)}
    return FailsafeMatrix({**matrix.rows, condition: row})


def hovering(
    vehicles: int = 1, *, faults: tuple[str, ...] = (), matrix: FailsafeMatrix = DEFAULT_MATRIX
) -> World:
    """Vehicles that hover at 40 m, for three seconds."""
    w = world(vehicles, faults=faults, keeps_log=False)
    put_matrix(w, matrix)
    w.run_for(3.0)
    return w


def put_matrix(w: World, matrix: FailsafeMatrix) -> None:
    station = w.driver.station
    settings = replace(station.settings, failsafe_matrix=matrix)
    w.driver.station = replace(station, settings=settings)


def in_mission(
    vehicles: int = 1, *, faults: tuple[str, ...] = (), matrix: FailsafeMatrix = DEFAULT_MATRIX
) -> World:
    """Vehicles of which the first flies a square of 400 m at 60 m: four minutes and more."""
    w = hovering(vehicles, faults=faults, matrix=matrix)
    fly(w)
    return w


def fly(w: World, serial: str = A) -> int:
    """Order a long mission, and wait until it is flown."""
    order = w.order(serial, FlyMission(square_mission(HIGH_M, 400.0)))
    assert w.run_until(lambda: w.record(order).phase is Phase.STARTED, 20.0), w.record(order).note
    return order


def steered(*, faults: tuple[str, ...] = (), matrix: FailsafeMatrix = DEFAULT_MATRIX) -> World:
    """A vehicle that is steered 300 m northwards by a client that stays connected."""
    w = hovering(faults=faults, matrix=matrix)
    w.driver.handle(OwnerConnected(OWNER))
    here = w.vehicle(A).position.value
    assert here is not None
    body = GoTo(moved_m(here, 300.0, 0.0), 40.0, 5.0)
    w.driver.handle(OperatorOrder(STEERED_ORDER, body, "test", A, owner=OWNER))
    assert w.run_until(lambda: w.record(STEERED_ORDER).phase is Phase.STARTED, 10.0)
    return w


def now_s(w: World) -> float:
    return w.driver.now_ns / 1e9


def own_orders(w: World) -> list[OrderRecord]:
    """The orders that the failsafe matrix gave, the oldest first."""
    own = (f"station: {condition.words}" for condition in FailsafeCondition)
    issuers = set(own) - {"station: separation"}
    records = w.driver.station.orders.records.values()
    return [record for record in records if record.command.issued_by in issuers]


def reactions(w: World) -> list[tuple[str | None, str, str]]:
    """Of each of them: vehicle, what, and by whom."""
    commands = [record.command for record in own_orders(w)]
    return [(one.serial, one.name, one.issued_by) for one in commands]


def issued_s(w: World) -> float:
    """When the only one was given, in seconds of station time."""
    (record,) = own_orders(w)
    return record.command.issued_at_ns / 1e9


def holds(w: World, serial: str = A) -> bool:
    """Whether the aircraft really stands in the air."""
    motion = w.app(serial).aircraft.motion
    speed_mps = (motion.velocity_north_mps**2 + motion.velocity_east_mps**2) ** 0.5
    return not w.app(serial).aircraft.is_on_ground and speed_mps < 0.5


def alarm_text(w: World, rule: str) -> str:
    """The text of an active alarm, "" without one."""
    book = w.driver.station.alarms.alarms.values()
    texts = [a.condition.text for a in book if a.condition.rule == rule and a.is_active]
    return texts[0] if texts else ""
