"""The gate: every rule must agree before a command becomes an approved one.

Theory of operation. `approve` asks the rules in their fixed order; the first refusal ends it.

    command -> rules 1..n -> refusal                      (a value with rule, sentence, parameters)
                          -> ApprovedCommand until `expires_at_ns` -> sent, or expired unsent

Default deny: an unknown order type, unknown telemetry and a rule that raises an exception all
refuse motion. The one exception is a stop: a failing rule never holds back an emergency order
without takeoff. An approval is short (`approval_holds_s`), since the facts behind it age; a mission
may first wait for the answer to the one before it, land and camera orders keep their own expiry.
Steered orders are judged as a whole and never sent themselves; each of their sticks is approved.
"""

from dataclasses import InitVar, dataclass, replace
from typing import Final, NoReturn

from recon.model.command import (
    CAMERA_BODIES,
    EMERGENCY_BODIES,
    STEERED_BODIES,
    Command,
    FlyMission,
    Hover,
    LandNow,
    Refusal,
    ReturnHome,
)
from recon.model.mission import Mission
from recon.model.units import Stamped, seconds_to_ns
from recon.model.vehicle import AltitudeReference, VehicleProfile
from recon.safety.rules import RULES, Rule
from recon.safety.rules.dji_limits import dji_limits
from recon.safety.situation import Situation
from recon.vehicles.mission_repair import joined

_KEY: Final = object()
"""Held by this module alone: an `ApprovedCommand` cannot be made without it."""


@dataclass(frozen=True)
class ApprovedCommand:
    """A command that may be sent, to these links and no others. Made by `approve` only.

    The key is asked for and not kept: neither `dataclasses.replace` nor a copy nor a pickle makes
    another approved command out of one. `command` expires when the approval does.
    `altitude_offset_m` is what every waypoint's height above takeoff is raised by on the wire; None
    when heights go out as they are.
    """

    # Not `slots=True`: until Python 3.11.4 that puts a `__setstate__` of its own in place of ours.
    __slots__ = ("altitude_offset_m", "approved_at_ns", "command", "link_ids", "profile")

    command: Command
    link_ids: tuple[int, ...]
    profile: VehicleProfile | None
    altitude_offset_m: float | None
    approved_at_ns: int
    key: InitVar[object]

    def __post_init__(self, key: object) -> None:
        if key is not _KEY:
            raise TypeError("only recon.safety.approve makes an ApprovedCommand")

    def __reduce_ex__(self, _protocol: object) -> NoReturn:
        raise TypeError("an ApprovedCommand is not copied or pickled: ask recon.safety.approve")

    def __setstate__(self, _state: object) -> NoReturn:
        raise TypeError("an ApprovedCommand is not restored: ask recon.safety.approve")


def judge(command: Command, situation: Situation) -> Refusal | None:
    """Return the first rule's refusal, or None: nothing speaks against the command. Pure."""
    refusals = (_asked(rule, command, situation) for rule in RULES)
    return next((refusal for refusal in refusals if refusal is not None), None)


def judge_parts(
    command: Command, parts: tuple[Mission, ...], situation: Situation
) -> Refusal | None:
    """Return the first refusal of a mission that is flown in parts, or None. Pure.

    Where it leads and what it costs is judged of the whole; what DJI takes, of each part.
    """
    whole = replace(command, body=FlyMission(joined(parts)))
    packets = [replace(command, body=FlyMission(part)) for part in parts]
    refusals = (
        _asked(rule, asked, situation)
        for rule in RULES
        for asked in (packets if rule is dji_limits else (whole,))
    )
    return next((refusal for refusal in refusals if refusal is not None), None)


def _asked(rule: Rule, command: Command, situation: Situation) -> Refusal | None:
    """A rule's answer; one that fails refuses what moves, and never keeps a stop from going out."""
    try:
        return rule(command, situation)
    except Exception as fault:
        if isinstance(command.body, EMERGENCY_BODIES) and not command.takeoff:
            return None
        name = getattr(rule, "__name__", "?")
        return Refusal(
            "rule_fault",
            f"the rule {name} could not be worked out, a fault in the station's own code "
            f"({type(fault).__name__}: {fault}): nothing that moves a vehicle is sent unjudged; "
            "fly it by its controller, and start the station again",
        )


def approve(command: Command, situation: Situation) -> ApprovedCommand | Refusal:
    """Return the command approved for its links, or the first rule's refusal. Pure."""
    refusal = judge(command, situation) or _not_for_the_wire(command)
    if refusal is not None:
        return refusal
    return ApprovedCommand(
        command=replace(command, expires_at_ns=_holds_until_ns(command, situation)),
        link_ids=_link_ids(command, situation),
        profile=None if situation.vehicle is None else situation.vehicle.profile,
        altitude_offset_m=_altitude_offset_m(command, situation),
        approved_at_ns=situation.now_ns,
        key=_KEY,
    )


def _not_for_the_wire(command: Command) -> Refusal | None:
    """A steered order is judged as a whole, and goes out as sticks that are each approved."""
    if not isinstance(command.body, STEERED_BODIES):
        return None
    return Refusal("not_for_the_wire", f"{command.name} is steered by the station with sticks")


def _link_ids(command: Command, situation: Situation) -> tuple[int, ...]:
    """Every link that claims to be the vehicle; hover and return spare those on the ground.

    On the ground, apps in the field answer hover and return with a takeoff. Only a hover may ask
    for one.
    """
    is_hover = isinstance(command.body, Hover) and not command.takeoff
    wakes = is_hover or isinstance(command.body, ReturnHome)
    return tuple(
        claiming_link.link_id
        for claiming_link in situation.claiming_links
        if not (wakes and claiming_link.may_be_on_ground)
    )


def _holds_until_ns(command: Command, situation: Situation) -> int:
    """Return when the approval ends: an order that may do harm late must not wait in a queue."""
    body, limits = command.body, situation.settings
    if isinstance(body, (LandNow, *CAMERA_BODIES)):
        return command.expires_at_ns
    is_mission = isinstance(body, FlyMission)
    holds_s = limits.mission_approval_holds_s if is_mission else limits.approval_holds_s
    until_ns = min(command.expires_at_ns, situation.now_ns + seconds_to_ns(holds_s))
    offset = _altitude_offset(command, situation)
    if offset is None or offset.received_at_ns is None:
        return until_ns
    max_age_ns = seconds_to_ns(limits.altitude_offset_max_age_s)
    return min(until_ns, offset.received_at_ns + max_age_ns + 1)


def _altitude_offset_m(command: Command, situation: Situation) -> float | None:
    offset = _altitude_offset(command, situation)
    return None if offset is None else offset.value


def _altitude_offset(command: Command, situation: Situation) -> Stamped[float] | None:
    vehicle = situation.vehicle
    if not isinstance(command.body, FlyMission) or vehicle is None or vehicle.profile is None:
        return None
    is_wgs84 = vehicle.profile.waypoint_altitude is AltitudeReference.WGS84
    return vehicle.altitude_offset_m if is_wgs84 else None
