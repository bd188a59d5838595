"""One table that says what a flight mode means for an order: told x new mode x place -> verdict.

An order is followed by telemetry alone. Whether a vehicle has started, finished, was taken over by
its pilot or follows its own failsafe is read here and nowhere else; `docs/flight-table.md` is
written from this table. A mode is *new* when the vehicle was not in it before it was told; the
cells of a mode that is not new count only as far as they say carried out, started or finished.
"""

from dataclasses import dataclass
from enum import Enum

from recon.model.vehicle import FlightMode


class Verdict(Enum):
    """What is the case."""

    CARRIED_OUT = "carried out"
    STARTED = "started"
    FINISHED = "finished"
    PILOT = "pilot"
    FAILSAFE = "failsafe"
    UNDECIDED = "undecided"


class Instruction(Enum):
    """What the station has told a vehicle; "sent" until telemetry shows it carried out."""

    NOTHING = "nothing"
    HOLD_SENT = "hold, sent"
    HOLD = "hold"
    MISSION_SENT = "mission, sent"
    MISSION = "mission, flown"
    MISSION_TO_LAND = "mission that lands, flown"
    STICK_SENT = "sticks, sent"
    STICK = "sticks"
    RETURN_SENT = "return, sent"
    RETURN = "return"
    LAND_SENT = "land, sent"
    LAND = "land"


class ModeKind(Enum):
    """Flight modes that mean the same here."""

    WAYPOINT = "mission"
    GO_HOME = "go home"
    LANDING = "landing"
    JOYSTICK = "virtual stick"
    NEUTRAL = "position"
    TAKEOFF = "takeoff"
    PILOT = "pilot's own"
    ATTI_GOOD = "ATTI, good GNSS"
    ATTI_POOR = "ATTI, else"
    UNKNOWN = "unknown"


class Place(Enum):
    """Where it is, by the newest telemetry."""

    AT_END = "at its end"
    ELSEWHERE = "elsewhere"
    GROUND_AT_END = "on the ground at its end"
    GROUND_ELSEWHERE = "on the ground elsewhere"

    @property
    def is_ground(self) -> bool:
        """Whether telemetry says that it does not fly."""
        return self in (Place.GROUND_AT_END, Place.GROUND_ELSEWHERE)


AT_END_M = 5.0
"""A mission that leaves mode 10 farther than this from its end was not flown to its end."""

GOOD_GNSS_LEVEL = 3
"""From this level on DJI holds position by GNSS: no reason to fall back to ATTI by itself."""

KIND_OF_MODE: dict[FlightMode, ModeKind] = {
    FlightMode.GPS_WAYPOINT: ModeKind.WAYPOINT,
    FlightMode.GO_HOME: ModeKind.GO_HOME,
    FlightMode.AUTO_LANDING: ModeKind.LANDING,
    FlightMode.CONFIRM_LANDING: ModeKind.LANDING,
    FlightMode.JOYSTICK: ModeKind.JOYSTICK,
    # An app that cancels a mission passes through GPS_ATTI, and a vehicle that hovers is in it.
    FlightMode.GPS_ATTI: ModeKind.NEUTRAL,
    # With the beginner setting it stands for GPS_ATTI.
    FlightMode.GPS_NOVICE: ModeKind.NEUTRAL,
    FlightMode.ASSISTED_TAKEOFF: ModeKind.TAKEOFF,
    FlightMode.AUTO_TAKEOFF: ModeKind.TAKEOFF,
    FlightMode.MOTORS_JUST_STARTED: ModeKind.TAKEOFF,
    # Only a person with the controller, or its own app, selects these.
    FlightMode.MANUAL: ModeKind.PILOT,
    FlightMode.GPS_COURSE_LOCK: ModeKind.PILOT,
    FlightMode.GPS_HOME_LOCK: ModeKind.PILOT,
    FlightMode.GPS_HOT_POINT: ModeKind.PILOT,
    FlightMode.GPS_ATTI_WRISTBAND: ModeKind.PILOT,
    FlightMode.DRAW: ModeKind.PILOT,
    FlightMode.GPS_FOLLOW_ME: ModeKind.PILOT,
    FlightMode.ACTIVE_TRACK: ModeKind.PILOT,
    FlightMode.TAP_FLY: ModeKind.PILOT,
    FlightMode.GPS_SPORT: ModeKind.PILOT,
    FlightMode.TERRAIN_FOLLOW: ModeKind.PILOT,
    FlightMode.TRIPOD: ModeKind.PILOT,
    FlightMode.ACTIVE_TRACK_SPOTLIGHT: ModeKind.PILOT,
    # Selected by a pilot, but also by the aircraft itself when it loses GNSS.
    FlightMode.ATTI: ModeKind.ATTI_POOR,
    FlightMode.ATTI_COURSE_LOCK: ModeKind.ATTI_POOR,
    FlightMode.UNKNOWN: ModeKind.UNKNOWN,
    FlightMode.OTHER: ModeKind.UNKNOWN,
}

COLUMNS = tuple(ModeKind)

VERDICT_OF_LETTER = {
    "c": Verdict.CARRIED_OUT,
    "s": Verdict.STARTED,
    "f": Verdict.FINISHED,
    "P": Verdict.PILOT,
    "X": Verdict.FAILSAFE,
    "-": Verdict.UNDECIDED,
}

# One row for each thing told, one cell for each kind of mode in the order of ModeKind, and in each
# cell four letters: in the air at its end, elsewhere; on the ground at its end, elsewhere.
# The columns: mission go-home landing stick position takeoff pilot ATTI+ ATTI- unknown.
_ROWS: dict[Instruction, str] = {
    Instruction.NOTHING: "         ---- ---- ---- ---- ---- ---- PP-- PP-- ---- ----",
    # A mission sent just before may still begin: a stop is repeated until it holds.
    Instruction.HOLD_SENT: "       ---- ---- ---- ---- cc-- ---- PP-- PP-- cc-- cc--",
    Instruction.HOLD: "            PP-- XX-- XX-- PP-- cP-- ---- PP-- PP-- ---- ----",
    Instruction.MISSION_SENT: "    ss-- XX-- XX-- ---- ---- cccc PP-- PP-- ---- ----",
    Instruction.MISSION: "         ccXX XXXX XXXX PPXX fPXX --XX PPXX PPXX --XX --XX",
    Instruction.MISSION_TO_LAND: " ccfX XXfX cXfX PPfX PPfX --fX PPfX PPfX --fX --fX",
    Instruction.STICK_SENT: "      ---- XX-- XX-- cc-- ---- ---- PP-- PP-- ---- ----",
    Instruction.STICK: "           PPXX XXXX XXXX ccXX PPXX --XX PPXX PPXX --XX --XX",
    Instruction.RETURN_SENT: "     --ff ccff --ff --ff --ff --ff PPff PPff --ff --ff",
    Instruction.RETURN: "          PPff ccff ccff PPff PPff --ff PPff PPff --ff --ff",
    Instruction.LAND_SENT: "       --ff --ff ccff --ff --ff --ff PPff PPff --ff --ff",
    Instruction.LAND: "            PPff XXff ccff PPff PPff --ff PPff PPff --ff --ff",
}

TABLE: dict[tuple[Instruction, ModeKind, Place], Verdict] = {
    (told, kind, place): VERDICT_OF_LETTER[letter]
    for told, row in _ROWS.items()
    for kind, cell in zip(COLUMNS, row.split(), strict=True)
    for place, letter in zip(Place, cell, strict=True)
}


@dataclass(frozen=True, slots=True)
class Reading:
    """A verdict, the kind of mode it comes from, and why."""

    verdict: Verdict
    kind: ModeKind | None
    why: str

    @property
    def is_at_once(self) -> bool:
        """Whether nothing is waited for: only a person brings about such a mode.

        Other signs of the pilot or a failsafe may pass (an app that cancels a mission shows
        position mode before it goes home), and count when they have lasted.
        """
        return self.kind in (ModeKind.PILOT, ModeKind.ATTI_GOOD)


UNTOLD = Reading(Verdict.UNDECIDED, None, "its app does not say its flight mode")


def kind_of(mode: FlightMode, gnss_level: int | None) -> ModeKind:
    """Return the kind of a flight mode; ATTI with good GNSS is the pilot's choice."""
    kind = KIND_OF_MODE[mode]
    is_good = gnss_level is not None and gnss_level >= GOOD_GNSS_LEVEL
    return ModeKind.ATTI_GOOD if kind is ModeKind.ATTI_POOR and is_good else kind


def read(
    told: Instruction,
    mode: FlightMode | None,
    gnss_level: int | None,
    place: Place,
    mode_before: FlightMode | None = None,
) -> Reading:
    """Return what a mode means; `mode_before` is the one the vehicle was in when it was told."""
    if mode is None:
        return UNTOLD
    kind = kind_of(mode, gnss_level)
    verdict = TABLE[told, kind, place]
    is_old = mode is mode_before and not place.is_ground and not _is_moved_hold(told, kind)
    if is_old and verdict in (Verdict.PILOT, Verdict.FAILSAFE):
        return Reading(Verdict.UNDECIDED, kind, "it was in this mode before")
    return Reading(verdict, kind, _why(verdict, told, kind, place))


def _is_moved_hold(told: Instruction, kind: ModeKind) -> bool:
    """Whether the place is the news: a vehicle that holds is in position mode anyway."""
    return told is Instruction.HOLD and kind is ModeKind.NEUTRAL


def _why(verdict: Verdict, told: Instruction, kind: ModeKind, place: Place) -> str:
    if verdict is Verdict.FAILSAFE:
        return _why_failsafe(kind, place)
    if verdict is Verdict.PILOT:
        return _why_pilot(told, kind)
    return f"{told.value}: {kind.value} mode, {place.value}"


def _why_failsafe(kind: ModeKind, place: Place) -> str:
    if place.is_ground:
        return "it is on the ground, which was not ordered: its failsafe, or the pilot landed it"
    if kind is ModeKind.GO_HOME:
        return "it flies home, which was not ordered: its failsafe, or the pilot's return button"
    return "it lands, which was not ordered: its failsafe, or the pilot's button"


def _why_pilot(told: Instruction, kind: ModeKind) -> str:
    if kind is ModeKind.WAYPOINT:
        return "it flies a mission not ordered now: the pilot's, or one carried out late"
    if kind is ModeKind.JOYSTICK:
        return "it is flown by sticks that the station does not send"
    if kind is ModeKind.NEUTRAL:
        return _LEFT[told]
    if kind is ModeKind.ATTI_GOOD:
        return "ATTI was selected while GNSS is good: only a pilot does that"
    return "a flight mode was selected that only a pilot selects"


_LEFT: dict[Instruction, str] = {
    Instruction.HOLD: f"it has moved more than {AT_END_M:g} m from where it was to hold: the pilot",
    Instruction.MISSION: f"it left its mission more than {AT_END_M:g} m from its end without going "
    "home or landing: the pilot",
    Instruction.MISSION_TO_LAND: "it left its mission and does not land: the pilot",
    Instruction.STICK: "it is no longer flown by the station's sticks: the pilot",
    Instruction.RETURN: "it has stopped its way home and hovers: the pilot",
    Instruction.LAND: "it has stopped landing and hovers: the pilot",
}
