"""What sets a vehicle in motion needs to know where it is now, not where it was."""

from recon.model.command import Command, Refusal
from recon.model.units import ns_to_seconds
from recon.safety.path.order_path import is_stop
from recon.safety.situation import Situation

RULE = "link_age"


def link_age(command: Command, situation: Situation) -> Refusal | None:
    """Refuse motion on core telemetry older than 1 s, or extended telemetry older than 3 s.

    A stick that only stops the vehicle may go as long as telemetry still tells whether
    it flies, whatever the extended telemetry's age.
    """
    vehicle, limits = situation.vehicle, situation.settings
    if vehicle is None or not command.moves:
        return None
    stops = is_stop(command, situation)
    core_s = limits.fresh_telemetry_s if stops else limits.motion_telemetry_s
    fault = _fault("core", vehicle.core_received_at_ns, core_s, situation)
    if fault is None and not stops:
        heard_at_ns = vehicle.extended_received_at_ns
        fault = _fault("extended", heard_at_ns, limits.motion_extended_s, situation)
    return None if fault is None else Refusal(RULE, f"{vehicle.display_name}: {fault}")


def _fault(kind: str, heard_at_ns: int | None, most_s: float, situation: Situation) -> str | None:
    if heard_at_ns is None:
        return f"its app has sent no {kind} telemetry yet: wait for it, or look at the app"
    age_s = ns_to_seconds(situation.now_ns - heard_at_ns)
    if age_s <= most_s:
        return None
    return (
        f"its {kind} telemetry is {age_s:.1f} s old, {most_s:g} s at most is needed to set it in "
        "motion: wait until the link is back. Hold, land and return are open"
    )
