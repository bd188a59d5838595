"""The flight table: instruction x new flight mode x place -> verdict.

Theory of operation. The station knows what a vehicle does from telemetry alone, because an
acknowledgment is sent before the app acts. The newest flight mode is read against the last
instruction and the place of the vehicle, and yields one verdict:

- *carried out*, *started*, *finished* advance the order's life cycle;
- *pilot*: the pilot has taken over. The station stops commanding and hands authority to the pilot;
- *failsafe*: the aircraft acts on its own. The order fails with an alarm;
- *undecided*: no conclusion. An order that stays undecided for long fails.

An instruction is "sent" until telemetry confirms it. A mode is *new* when the vehicle was not in
it when the instruction was sent: a mode that is not new can confirm, start or finish an order,
but shows neither a takeover nor a failsafe. ATTI with good GNSS is the pilot's choice; with poor
GNSS the aircraft may have fallen back to it.

This is the only place that makes these distinctions; `docs/flight-table.md` is generated from it.
"""

from dataclasses import dataclass
from enum import Enum

from recon.model.vehicle import FlightMode


class Verdict(Enum):
    """What a flight mode shows about an instruction."""

    CARRIED_OUT = "carried out"
    STARTED = "started"
    FINISHED = "finished"
    PILOT = "pilot"
    FAILSAFE = "failsafe"
    UNDECIDED = "undecided"


class Instruction(Enum):
    """The last instruction to a vehicle; "sent" until telemetry confirms it."""

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
    """Groups of flight modes with the same meaning in this table."""

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
    """Where the vehicle is, by the newest telemetry."""

    AT_END = "at its end"
    ELSEWHERE = "elsewhere"
    GROUND_AT_END = "on the ground at its end"
    GROUND_ELSEWHERE = "on the ground elsewhere"

    @property
    def is_ground(self) -> bool:
        """Whether telemetry reports it on the ground."""
        return self in (Place.GROUND_AT_END, Place.GROUND_ELSEWHERE)


AT_END_M = 5.0
"""A mission that leaves mode 10 farther than this from its end was interrupted."""

GOOD_GNSS_LEVEL = 3
"""Level from which DJI holds position by GNSS: no reason for a fallback to ATTI."""

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

# One row for each instruction, one cell for each kind of mode in the order of ModeKind, and in each
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
    (instruction, kind, place): VERDICT_OF_LETTER[letter]
    for instruction, row in _ROWS.items()
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
        """Whether the verdict counts at once: only a pilot can select such a mode.

        Other signs of a takeover or failsafe may be transient (an app that cancels a mission
        passes through position mode before it returns home) and must last before they count.
        """
        return self.kind in (ModeKind.PILOT, ModeKind.ATTI_GOOD)


NO_MODE = Reading(Verdict.UNDECIDED, None, "flight mode not reported")


def kind_of(mode: FlightMode, gnss_level: int | None) -> ModeKind:
    """Return the kind of a flight mode; ATTI with good GNSS is the pilot's choice."""
    kind = KIND_OF_MODE[mode]
    is_good = gnss_level is not None and gnss_level >= GOOD_GNSS_LEVEL
    return ModeKind.ATTI_GOOD if kind is ModeKind.ATTI_POOR and is_good else kind


def read(
    instruction: Instruction,
    mode: FlightMode | None,
    gnss_level: int | None,
    place: Place,
    mode_before: FlightMode | None = None,
) -> Reading:
    """Return the reading of a mode; `mode_before` is the mode when the instruction was sent."""
    if mode is None:
        return NO_MODE
    kind = kind_of(mode, gnss_level)
    verdict = TABLE[instruction, kind, place]
    is_old = mode is mode_before and not place.is_ground and not _is_moved_hold(instruction, kind)
    if is_old and verdict in (Verdict.PILOT, Verdict.FAILSAFE):
        return Reading(Verdict.UNDECIDED, kind, "the mode has not changed since the order")
    return Reading(verdict, kind, _why(verdict, instruction, kind, place))


def _is_moved_hold(instruction: Instruction, kind: ModeKind) -> bool:
    """Whether a hold was left: its mode is old, the position is what changed."""
    return instruction is Instruction.HOLD and kind is ModeKind.NEUTRAL


def _why(verdict: Verdict, instruction: Instruction, kind: ModeKind, place: Place) -> str:
    if verdict is Verdict.FAILSAFE:
        return _why_failsafe(kind, place)
    if verdict is Verdict.PILOT:
        return _why_pilot(instruction, kind)
    return f"{instruction.value}: {kind.value} mode, {place.value}"


def _why_failsafe(kind: ModeKind, place: Place) -> str:
    if place.is_ground:
        return "on the ground without an order: failsafe, or landed by the pilot"
    if kind is ModeKind.GO_HOME:
        return "returning home without an order: failsafe, or the pilot's return button"
    return "landing without an order: failsafe, or the pilot's landing button"


def _why_pilot(instruction: Instruction, kind: ModeKind) -> str:
    if kind is ModeKind.WAYPOINT:
        return "flying a mission that is not the current order: the pilot's, or a late start"
    if kind is ModeKind.JOYSTICK:
        return "controlled by sticks that the station does not send"
    if kind is ModeKind.NEUTRAL:
        return _LEFT[instruction]
    if kind is ModeKind.ATTI_GOOD:
        return "ATTI selected with good GNSS: pilot input"
    return "pilot-only flight mode selected"


_LEFT: dict[Instruction, str] = {
    Instruction.HOLD: f"moved more than {AT_END_M:g} m from its hold position: pilot input",
    Instruction.MISSION: f"left its mission more than {AT_END_M:g} m before its end without "
    "returning or landing: pilot input",
    Instruction.MISSION_TO_LAND: "left its mission without landing: pilot input",
    Instruction.STICK: "left virtual-stick mode: pilot input",
    Instruction.RETURN: "stopped its return and hovers: pilot input",
    Instruction.LAND: "stopped landing and hovers: pilot input",
}
