"""The last question before a packet leaves: may this order still be sent?

An approval judges a snapshot. An order that had to wait may leave in another situation: its order
was withdrawn, telemetry or traffic changed, another holder has control, an all stop is in force. So
the gate is asked again at the moment of sending, about anything that has waited.
"""

from dataclasses import replace

from recon.model.command import Refusal
from recon.model.units import seconds_to_ns
from recon.safety import ApprovedCommand, judge
from recon.station.control.situation_builder import situation
from recon.station.state.station import Station

RULE = "dispatch"
"""Rule of refusals outside the gate: an order that has ended, a fault in judging it."""

SAME_MOMENT_S = 0.05
"""Time of a tick: orders sent within it were judged by the facts of that moment."""


def objection(station: Station, approved: ApprovedCommand, now_ns: int) -> Refusal | None:
    """Return why an approved order may not be sent now, else None."""
    command = approved.command
    record = station.orders.records.get(command.id)
    if record is not None and record.phase.is_final:
        return Refusal(RULE, f"not sent: its order has ended ({record.note})")
    if now_ns - approved.approved_at_ns <= seconds_to_ns(SAME_MOMENT_S):
        return None
    try:
        refusal = judge(command, situation(station, command, now_ns))
    except Exception as fault:  # in the station's own code: it must not keep a stop from going out
        is_stop = command.is_emergency and not command.takeoff
        why = f"not sent: it could not be judged again ({fault})"
        return None if is_stop else Refusal(RULE, why)
    if refusal is None:
        return None
    return replace(refusal, reason=f"not sent, the situation has changed: {refusal.reason}")
