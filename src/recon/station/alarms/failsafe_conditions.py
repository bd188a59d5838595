"""What the failsafe matrix adds to the alarms: what will be done and when, and what was done.

A condition that is an alarm already stays that one alarm, and its text states the reaction. The
rows about the imaging drone, the station and its operators have alarms of their own, one for all
vehicles.
"""

from collections import defaultdict
from collections.abc import Iterator, Mapping
from dataclasses import replace

from recon.model.failsafe_matrix import FailsafeCell, FailsafeCondition, Reaction
from recon.model.names import first_names
from recon.model.units import NS_PER_S
from recon.safety.failsafe import ROWS
from recon.safety.failsafe import imaging_drone_lost as imaging_row
from recon.safety.failsafe import operator_gone as operator_row
from recon.safety.failsafe import station_overloaded as overload_row
from recon.station.failsafe.facts import lost_imagers
from recon.station.failsafe.runner import cell_of, may_react
from recon.station.state.alarm_book import Condition, Severity
from recon.station.state.failsafe_state import Occurrence, ReactionOutcome
from recon.station.state.station import Station

_SHARED_RULES: Mapping[str, tuple[FailsafeCondition, ...]] = {
    rule: tuple(one for one, row in ROWS.items() if rule in row.alarm_rules)
    for rule in {rule for row in ROWS.values() for rule in row.alarm_rules}
}
_WILL: Mapping[Reaction, str] = {
    Reaction.HOLD: "the station holds it",
    Reaction.RETURN: "the station recalls it",
    Reaction.LAND: "the station lands it",
}
MAX_NAMES = 8


def with_reaction(station: Station, condition: Condition, now_ns: int) -> Condition:
    """Return an alarm's condition with what the matrix does about it, if it does anything."""
    serial, shared = condition.serial, _SHARED_RULES.get(condition.rule, ())
    if serial is None or not shared:
        return condition
    known = station.failsafe_state.occurrences.get(serial)
    if known is None:
        return condition
    for one in shared:
        words = "" if one not in known else _reaction_words(station, serial, known[one], now_ns)
        if words:
            return replace(condition, text=f"{condition.text}; {words}")
    return condition


def conditions(station: Station, now_ns: int) -> Iterator[Condition]:
    """Yield the alarms of the rows that have one of their own."""
    texts = {
        FailsafeCondition.IMAGING_DRONE_LOST: (imaging_row.RULE, Severity.WARNING, _imaging_text),
        FailsafeCondition.STATION_OVERLOADED: (overload_row.RULE, Severity.ERROR, _late_text),
        FailsafeCondition.OPERATOR_GONE: (operator_row.RULE, Severity.ERROR, _operator_text),
    }
    for one, (rule, severity, text_of) in texts.items():
        affected = _affected(station, one)
        if affected:
            text = text_of(station, now_ns) + _reactions(station, affected, now_ns)
            yield Condition(rule, severity, rule, "", text)


def _affected(station: Station, condition: FailsafeCondition) -> dict[str, Occurrence]:
    """Return the vehicles for which it holds and is at least an alarm, by serial."""
    state = station.failsafe_state
    return {
        serial: known[condition]
        for serial, known in state.occurrences.items()
        if condition in known and known[condition].seen_ns == state.run_at_ns
        if _cell(station, serial, known[condition]).reaction is not Reaction.NOTHING
    }


def _imaging_text(station: Station, now_ns: int) -> str:
    names = [imager.display_name for imager, _ in lost_imagers(station, now_ns)]
    are = "drone {} is" if len(names) == 1 else "drones {} are"
    lost = are.format(", ".join(names))
    return f"the imaging {lost} lost in flight: ground image and sun forecast grow old"


def _late_text(station: Station, _now_ns: int) -> str:
    gap_s = station.failsafe_state.late_gap_s
    return (
        f"the station is late: no step for {gap_s:.1f} s; it is overloaded or was suspended: close "
        "other programs, and steer nothing until this ends"
    )


def _operator_text(station: Station, now_ns: int) -> str:
    since_ns = station.failsafe_state.no_client_since_ns or now_ns
    return f"no operator connected for {(now_ns - since_ns) / NS_PER_S:.0f} s: open the console"


def _reactions(station: Station, affected: Mapping[str, Occurrence], now_ns: int) -> str:
    """Return what is done with which vehicles, to follow the alarm's text."""
    names: dict[str, list[str]] = defaultdict(list)
    for serial, occurrence in affected.items():
        words = _reaction_words(station, serial, occurrence, now_ns)
        if words:
            vehicle = station.fleet.vehicles.get(serial)
            names[words].append(serial if vehicle is None else vehicle.display_name)
    return "".join(f"; {first_names(found, MAX_NAMES)}: {words}" for words, found in names.items())


def _cell(station: Station, serial: str, occurrence: Occurrence) -> FailsafeCell:
    return cell_of(station, occurrence, station.failsafe_state.activities[serial])


def _reaction_words(station: Station, serial: str, occurrence: Occurrence, now_ns: int) -> str:
    if occurrence.outcome is not ReactionOutcome.PENDING:
        return occurrence.outcome_text
    cell, vehicle = _cell(station, serial, occurrence), station.fleet.vehicles.get(serial)
    if vehicle is None or not cell.reaction.is_order or not may_react(station, vehicle):
        return ""
    row, will = ROWS[occurrence.condition], _WILL[cell.reaction]
    if row.is_ordered_on_return:
        lasts = f"after {cell.after_s:g} s or more" if cell.after_s else "then"
        return f"{will} when the link is back {lasts}"
    left_s = cell.after_s - (now_ns - occurrence.since_ns) / NS_PER_S
    return f"{will} in {max(0.0, left_s):.0f} s unless {row.ends}"
