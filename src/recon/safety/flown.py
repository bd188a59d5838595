"""What an order that sets a vehicle in motion makes it fly: worked out once, asked by many rules.

A vehicle sets out from where it was last heard. On the way to a mission's first waypoint it may fly
at every height between; so it may on a leg, a goto, a nudge, and while a stick changes its height.
The height it sets out from counts as up to 1 m nearer to where it goes (`height_noise_m`).
"""

from recon.model.command import (
    Command,
    FlyMission,
    GoTo,
    HoldPosition,
    Nudge,
    VirtualStick,
)
from recon.safety.departure import Departure, Unknown, departure
from recon.safety.flown_bodies import (
    goto_pieces,
    hold_pieces,
    mission_pieces,
    nudge_pieces,
    stick_pieces,
    takeoff_pieces,
)
from recon.safety.flown_path import FlownPath, Pieces
from recon.safety.settings import SafetySettings
from recon.safety.situation import Situation


def flown(command: Command, situation: Situation) -> FlownPath | Unknown | None:
    """Return where the order may take its vehicle, or why nobody can say; None for no motion."""
    if not command.moves or situation.vehicle is None:
        return None
    return situation.once(flown, command, _flown)


def _flown(command: Command, situation: Situation) -> FlownPath | Unknown:
    assert situation.vehicle is not None
    begin = departure(situation, situation.vehicle)
    if isinstance(begin, Unknown):
        return begin
    return FlownPath(_pieces(command, begin, situation.settings), begin)


def _pieces(command: Command, begin: Departure, limits: SafetySettings) -> Pieces:
    settings = limits.fences
    match command.body:
        case FlyMission(mission):
            return mission_pieces(mission, begin, settings)
        case GoTo() as goto:
            return goto_pieces(goto, begin, settings)
        case Nudge() as nudge:
            return nudge_pieces(nudge, begin, settings)
        case VirtualStick() as stick:
            return stick_pieces(stick, begin, settings)
        case HoldPosition():
            return hold_pieces(begin, settings)
        case _:
            return takeoff_pieces(begin, limits.prediction.takeoff_height_m, settings)
