"""The gate: every rule must agree before a command becomes an approved one."""

from dataclasses import dataclass
from typing import Final

from recon.model.command import Command, FlyMission, Hover, Refusal, ReturnHome
from recon.model.vehicle import AltitudeReference, VehicleProfile
from recon.safety.rules import RULES
from recon.safety.situation import Situation

_KEY: Final = object()
"""Held by this module alone: without it nobody makes an `ApprovedCommand`."""


@dataclass(frozen=True, slots=True)
class ApprovedCommand:
    """A command that may be sent, to these links and no others. Made by `approve` only.

    `altitude_offset_m` is what every waypoint's height above takeoff is raised by on the wire; None
    when heights go out as they are.
    """

    command: Command
    link_ids: tuple[int, ...]
    profile: VehicleProfile | None
    altitude_offset_m: float | None
    approved_at_ns: int
    key: object

    def __post_init__(self) -> None:
        if self.key is not _KEY:
            raise TypeError("only recon.safety.approve makes an ApprovedCommand")


def approve(command: Command, situation: Situation) -> ApprovedCommand | Refusal:
    """Return the command approved for its links, or the first rule's refusal. Pure."""
    for rule in RULES:
        refusal = rule(command, situation)
        if refusal is not None:
            return refusal
    return ApprovedCommand(
        command=command,
        link_ids=_link_ids(command, situation),
        profile=None if situation.vehicle is None else situation.vehicle.profile,
        altitude_offset_m=_altitude_offset_m(command, situation),
        approved_at_ns=situation.now_ns,
        key=_KEY,
    )


def _link_ids(command: Command, situation: Situation) -> tuple[int, ...]:
    """Every link that claims to be the vehicle; hover and return spare those on the ground.

    On the ground, apps in the field answer hover and return with a takeoff.
    """
    wakes = isinstance(command.body, Hover | ReturnHome) and not command.takeoff
    return tuple(
        claimant.link_id
        for claimant in situation.claimants
        if not (wakes and claimant.is_flying.value is False)
    )


def _altitude_offset_m(command: Command, situation: Situation) -> float | None:
    vehicle = situation.vehicle
    if not isinstance(command.body, FlyMission) or vehicle is None or vehicle.profile is None:
        return None
    if vehicle.profile.waypoint_altitude is AltitudeReference.WGS84:
        return vehicle.altitude_offset_m.value
    return None
