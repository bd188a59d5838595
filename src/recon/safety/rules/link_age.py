"""Motion needs recent telemetry: the position must be the present one."""

from recon.model.command import Command, Refusal
from recon.model.units import ns_to_seconds
from recon.safety.path.order_path import is_stop
from recon.safety.situation import Situation

RULE = "link_age"


def link_age(command: Command, situation: Situation) -> Refusal | None:
    """Refuse motion on core telemetry older than 1 s, or extended telemetry older than 3 s.

    A stick that only stops the vehicle is accepted while telemetry still shows whether
    it flies, whatever the extended telemetry's age.
    """
    vehicle, limits = situation.vehicle, situation.settings
    if vehicle is None or not command.moves:
        return None
    stops = is_stop(command, situation)
    core_s = limits.fresh_telemetry_s if stops else limits.motion_telemetry_s
    name = vehicle.display_name
    refusal = _late(f"{name}: core", vehicle.core_received_at_ns, core_s, situation)
    if refusal is None and not stops:
        extended_at_ns = vehicle.extended_received_at_ns
        refusal = _late(f"{name}: extended", extended_at_ns, limits.motion_extended_s, situation)
    return refusal


def _late(
    what: str, received_at_ns: int | None, most_s: float, situation: Situation
) -> Refusal | None:
    if received_at_ns is None:
        return Refusal(RULE, f"{what} telemetry not received yet; check its companion app")
    age_s = ns_to_seconds(situation.now_ns - received_at_ns)
    if age_s <= most_s:
        return None
    return Refusal(
        RULE,
        f"{what} telemetry must be at most {most_s:g} s old for motion; got {age_s:.1f} s; wait "
        "for the link, or order hold, land or return",
        parameters={"age_s": age_s, "max_s": most_s},
    )
