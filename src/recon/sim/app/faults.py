"""Faults by name: failures of companion apps, links and aircraft that occur in the field.

A fault is written `NAME[:vehicle[:start_s[:duration_s]]]`; the vehicle is a serial, its number in
the fleet (1 is the first), or `*` for all; times count from the start of the simulation.
"""

from collections.abc import Iterator
from dataclasses import dataclass, field
from enum import Enum
from math import inf, isfinite
from random import Random

from recon.model.units import NS_PER_S, seconds_to_ns
from recon.sim.errors import FaultError


class FaultKind(Enum):
    """What fails. "While active": from the fault's start for its duration."""

    ACK_THEN_NOTHING = "ack-then-nothing"
    """Commands are acknowledged and not executed, while active."""
    NO_ACK = "no-ack"
    """Commands are executed and not acknowledged, while active."""
    NEGATIVE_ACK = "negative-ack"
    """Commands are refused (Positive = 0) and not executed, while active."""
    TELEMETRY_DROPOUT = "telemetry-dropout"
    """No telemetry and no images, while active; commands are still acknowledged and executed."""
    HALF_OPEN = "half-open"
    """The app stops reading and writing, but its socket stays open for the duration; it reconnects
    at once on a new one: a phone that changed its network."""
    SECOND_LINK = "second-link"
    """A second connection with the same serial and telemetry, for the duration."""
    RESTART = "restart"
    """The app closes and reconnects after the duration without its memory: mission numbers restart
    and commands not yet executed are lost. The aircraft flies on."""
    PLACEHOLDER_SERIAL = "placeholder-serial"
    """The serial is `00000`, as apps send it before they know the aircraft, while active."""

    BURSTS = "bursts"
    """All packets are held back and sent together every 1.5 seconds, while active."""
    DELAYED_ACKS = "delayed-acks"
    """Acknowledgments are 0.5 to 3 seconds late, while active; execution is not delayed."""
    IGNORED_MISSIONS = "ignored-missions"
    """Missions are acknowledged and not flown, while active; everything else works."""
    CORRUPTED_BYTES = "corrupted-bytes"
    """One in ten of the app's packets has one to three bytes changed, while active."""
    SLOW_READER = "slow-reader"
    """The app reads 32 bytes every 0.1 s, while active: commands queue until the socket is full."""
    FALLS_SILENT = "falls-silent"
    """The aircraft crashes and its app sends nothing more; the socket stays open. Permanent."""
    TAKEOFF_ALTITUDE_LOST = "takeoff-altitude-lost"
    """DJI gives no takeoff altitude: absolute altitudes are NaN, while active."""
    TAKEOFF_ALTITUDE_STALE = "takeoff-altitude-stale"
    """DJI gives another flight's takeoff altitude, 47 m higher: a step at start and end."""
    FALSE_GROUND = "false-ground"
    """Telemetry reports on the ground, whatever the aircraft does, while active."""
    FROZEN_TELEMETRY = "frozen-telemetry"
    """Core and extended telemetry repeat the values of the fault's start, while active."""
    POSITION_JUMP = "position-jump"
    """Reported positions are 60 m too far south: a step at start and end."""

    CAMERA_STOPS = "camera-stops"
    """No frames are sent although the feed is reported as on, while active."""
    FRAMES_REPEATED = "frames-repeated"
    """The frame taken at the fault's start is sent again and again, while active."""
    FRAMES_BLACK = "frames-black"
    """Frames are black, while active."""
    FRAMES_TORN = "frames-torn"
    """Frames are torn: from one row down they are shifted sideways, while active."""
    EXPOSURE_JUMPS = "exposure-jumps"
    """Exposure jumps from frame to frame, while active."""

    PHOTO_TIMER_FAILS = "photo-timer-fails"
    """The camera's timer takes no photo after the twentieth, while active (apps that report)."""
    PHOTO_TIMER_SKIPS = "photo-timer-skips"
    """The camera's timer leaves out every fifth photo, while active (apps that report)."""
    PHOTO_TIMER_LATE = "photo-timer-late"
    """The camera's timer starts 25 s into each mission, while active (apps that report)."""

    GUSTS = "gusts"
    """Gusts up to 9 m/s every 8 s on top of the wind, from a random direction, while active."""
    PILOT_TAKES = "pilot-takes"
    """The pilot switches to sport mode and holds; the app's missions and sticks are ignored until
    the pilot switches back, after the duration."""
    GNSS_LOSS = "gnss-loss"
    """The receiver has 3 satellites and signal level 0, while active: the aircraft aborts what it
    flies (mode ATTI) and drifts with the wind."""
    LOW_BATTERY = "low-battery"
    """A cell fails: from the start on at most 20 % of the charge is left. Permanent."""
    GO_HOME_HEIGHT = "go-home-height"
    """The go-home height set in the aircraft is 20 m, whatever its profile states, while active."""
    HOME_MOVED = "home-moved"
    """The home point set in the aircraft is 320 m east of where it was, from the start until the
    next takeoff."""


PLACEHOLDER_SERIAL = b"00000"
FAILED_CELL_FRACTION = 0.2
"""Most that is left when a cell fails: below every reserve a site would set."""

_DEFAULT_TIMES_S: dict[FaultKind, tuple[float, float]] = {
    FaultKind.ACK_THEN_NOTHING: (0.0, inf),
    FaultKind.NO_ACK: (0.0, inf),
    FaultKind.NEGATIVE_ACK: (0.0, inf),
    FaultKind.TELEMETRY_DROPOUT: (5.0, 3.0),
    FaultKind.HALF_OPEN: (5.0, 30.0),
    FaultKind.SECOND_LINK: (5.0, 10.0),
    FaultKind.RESTART: (5.0, 2.0),
    FaultKind.PLACEHOLDER_SERIAL: (0.0, inf),
    FaultKind.BURSTS: (0.0, inf),
    FaultKind.DELAYED_ACKS: (0.0, inf),
    FaultKind.IGNORED_MISSIONS: (0.0, inf),
    FaultKind.CORRUPTED_BYTES: (0.0, inf),
    FaultKind.SLOW_READER: (5.0, 30.0),
    FaultKind.FALLS_SILENT: (30.0, inf),
    FaultKind.TAKEOFF_ALTITUDE_LOST: (0.0, inf),
    FaultKind.TAKEOFF_ALTITUDE_STALE: (0.0, 30.0),
    FaultKind.FALSE_GROUND: (5.0, inf),
    FaultKind.FROZEN_TELEMETRY: (5.0, 10.0),
    FaultKind.POSITION_JUMP: (5.0, 10.0),
    FaultKind.CAMERA_STOPS: (5.0, 20.0),
    FaultKind.FRAMES_REPEATED: (5.0, 20.0),
    FaultKind.FRAMES_BLACK: (5.0, 3.0),
    FaultKind.FRAMES_TORN: (5.0, 10.0),
    FaultKind.EXPOSURE_JUMPS: (5.0, 30.0),
    FaultKind.PHOTO_TIMER_FAILS: (0.0, inf),
    FaultKind.PHOTO_TIMER_SKIPS: (0.0, inf),
    FaultKind.PHOTO_TIMER_LATE: (0.0, inf),
    FaultKind.GUSTS: (5.0, 40.0),
    FaultKind.PILOT_TAKES: (5.0, inf),
    FaultKind.GNSS_LOSS: (5.0, inf),
    FaultKind.LOW_BATTERY: (5.0, inf),
    FaultKind.GO_HOME_HEIGHT: (0.0, inf),
    FaultKind.HOME_MOVED: (5.0, inf),
}
"""Start and duration when the description leaves them out."""

LINK_FAULTS = (FaultKind.HALF_OPEN, FaultKind.SECOND_LINK, FaultKind.RESTART)
"""One-off faults of the connection."""
AIRCRAFT_FAULTS = (
    FaultKind.PILOT_TAKES,
    FaultKind.LOW_BATTERY,
    FaultKind.GNSS_LOSS,
    FaultKind.GUSTS,
    FaultKind.FALLS_SILENT,
    FaultKind.TAKEOFF_ALTITUDE_LOST,
    FaultKind.TAKEOFF_ALTITUDE_STALE,
    FaultKind.GO_HOME_HEIGHT,
    FaultKind.HOME_MOVED,
)
"""Faults that change the aircraft at their start and at their end."""
STALE_BY_M = 47.0
"""Difference between two pads of one farm, in the valley and on the hill."""

LOW_GO_HOME_M = 20.0
"""The least that DJI's aircraft can be set to."""
HOME_MOVED_BY_M = 320.0
"""Home recorded anew at the controller, on the other side of a field."""

JUMP_DEG = -60.0 / 111_070.0
"""Jump in latitude: more than any flight between two packets."""

ALL_VEHICLES = "*"


@dataclass(frozen=True, slots=True)
class InjectedFault:
    """One fault of one vehicle, or of all."""

    kind: FaultKind
    vehicle: str = ALL_VEHICLES
    start_s: float = 0.0
    duration_s: float = inf
    source: str = field(default="", compare=False)
    """Position in the fault file, as a prefix for messages: `FILE: line N: `."""

    def is_for(self, serial: str, number: int) -> bool:
        """Return whether the vehicle with this serial, or number in the fleet, has the fault."""
        return is_for(self.vehicle, serial, number)

    def end_ns(self, start_ns: int) -> int | None:
        """Return when it ends in a simulation that started at `start_ns`; None: never."""
        end_s = self.start_s + self.duration_s
        return start_ns + seconds_to_ns(end_s) if isfinite(end_s) else None

    def is_active(self, since_start_ns: int) -> bool:
        """Return whether the fault is active, this long after the simulation's start."""
        elapsed_s = since_start_ns / NS_PER_S
        return self.start_s <= elapsed_s < self.start_s + self.duration_s


def parse_fault(text: str) -> InjectedFault:
    """Return the fault described by `text` (see the module); raises `FaultError`."""
    name, *rest = text.split(":")
    kind = _kind(name)
    if len(rest) > 3:
        raise FaultError(
            f"fault {text!r}: expected NAME[:vehicle[:start_s[:duration_s]]], "
            f"got {len(rest) + 1} parts"
        )
    vehicle, start, duration = (*rest, "", "", "")[:3]
    default_start_s, default_duration_s = default_times_s(kind)
    return InjectedFault(
        kind,
        vehicle or ALL_VEHICLES,
        _seconds(start, default_start_s, "start", text),
        _seconds(duration, default_duration_s, "duration", text),
    )


def is_for(vehicle: str, serial: str, number: int) -> bool:
    """Return whether a fault's `vehicle` selects this serial, or this number in the fleet."""
    return vehicle in (ALL_VEHICLES, serial, str(number))


def default_times_s(kind: FaultKind) -> tuple[float, float]:
    """Return start and duration when a description leaves them out."""
    return _DEFAULT_TIMES_S[kind]


def _kind(name: str) -> FaultKind:
    try:
        return FaultKind(name)
    except ValueError:
        known = ", ".join(kind.value for kind in FaultKind)
        raise FaultError(f"fault {name!r}: expected one of {known}") from None


def _seconds(word: str, default: float, what: str, text: str) -> float:
    if not word:
        return default
    try:
        value = float(word)
    except ValueError:
        value = -1.0
    if not (isfinite(value) and value >= 0.0):
        raise FaultError(f"fault {text!r}: expected a {what} of 0 seconds or more, got {word!r}")
    return value


S_PER_HOUR = 3_600.0


@dataclass(frozen=True, slots=True, kw_only=True)
class RandomFault:
    """A fault that occurs at random times (Poisson process), drawn for each vehicle it selects."""

    kind: FaultKind
    vehicle: str
    per_hour: float
    """Mean rate; the times between two starts are exponentially distributed."""
    shortest_s: float
    longest_s: float
    """Durations are uniform between the two."""
    from_s: float
    until_s: float
    """No fault starts after this time."""
    source: str = ""

    def is_for(self, serial: str, number: int) -> bool:
        """Return whether the vehicle with this serial, or number in the fleet, may have it."""
        return is_for(self.vehicle, serial, number)

    def drawn(self, random: Random) -> Iterator[InjectedFault]:
        """Yield the faults of one vehicle, in order of time."""
        if self.per_hour < 1e-6:
            return
        start_s = self.from_s
        while (start_s := start_s + random.expovariate(self.per_hour / S_PER_HOUR)) < self.until_s:
            duration_s = random.uniform(self.shortest_s, self.longest_s)
            yield InjectedFault(self.kind, self.vehicle, start_s, duration_s, self.source)


def draw_faults(
    chances: tuple[RandomFault, ...], seed: int, serial: str, number: int
) -> tuple[InjectedFault, ...]:
    """Return all random faults of one vehicle; each entry has its own random generator."""
    return tuple(
        fault
        for row, chance in enumerate(chances)
        if chance.is_for(serial, number)
        for fault in chance.drawn(Random(f"{seed}/{serial}/chance {row}"))
    )
