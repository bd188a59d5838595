"""A survey's mission as an order: its way there at the first height that the gate lets it fly."""

from collections.abc import Iterator
from dataclasses import replace

from recon.model.authority import AuthorityHolder
from recon.model.command import FlyMission, Refusal
from recon.model.event import OperatorOrder
from recon.model.survey import MissionFor
from recon.model.vehicle import VehicleState
from recon.safety import judge
from recon.safety.rules.height_zones import RULE as HEIGHT_ZONES
from recon.safety.rules.keep_out import RULE as KEEP_OUT
from recon.safety.rules.max_height import RULE as MAX_HEIGHT
from recon.safety.rules.min_height import RULE as MIN_HEIGHT
from recon.safety.rules.separation import RULE as SEPARATION
from recon.station.control.situation_builder import command_of, situation
from recon.station.operations.survey.approach import with_approaches
from recon.station.state.station import Station
from recon.station.state.survey_record import SurveyRecord

HEIGHT_RULES = frozenset({HEIGHT_ZONES, KEEP_OUT, MAX_HEIGHT, MIN_HEIGHT})
"""What another height of the way may mend; any other refusal stands at every height."""


def order_of(
    station: Station,
    record: SurveyRecord,
    given: MissionFor,
    vehicle: VehicleState,
    now_ns: int,
) -> tuple[OperatorOrder, Refusal | str]:
    """Return the order, without its number; and why it is not asked for, or words for its refusal.

    Limits and zones are the gate's alone: where it refuses every height, the first is ordered, so
    that its refusal is on record. A mission that would come too near to another vehicle is not
    ordered but waits: the other vehicle may soon have flown on.
    """
    orders = tuple(_orders(station, record, given, vehicle))
    for order in orders:
        command = command_of(station, order, now_ns)
        refusal = judge(command, situation(station, command, now_ns))
        if refusal is not None and refusal.rule == SEPARATION:
            return order, refusal
        if refusal is None or refusal.rule not in HEIGHT_RULES:
            return order, ""
    tried = "" if len(orders) == 1 else "; nor is another height of its way to the first row free"
    return orders[0], tried


def _orders(
    station: Station, record: SurveyRecord, given: MissionFor, vehicle: VehicleState
) -> Iterator[OperatorOrder]:
    member = record.members[given.serial]
    number, count = tuple(record.members).index(given.serial), len(record.members)
    limits = station.airspace.airspace.limits
    order = OperatorOrder(
        0,
        FlyMission(given.mission),
        f"{record.started_by}: survey {record.survey.name}",
        serial=given.serial,
        takeoff=member.may_take_off and vehicle.is_flying.value is False,
        asked_as=AuthorityHolder.GUIDANCE,
    )
    for mission in with_approaches(given.mission, vehicle, number, count, limits):
        yield replace(order, body=FlyMission(mission))
