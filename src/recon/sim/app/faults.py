"""Faults by name: what companion apps, links and aircraft in the field get wrong, on order.

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
    """What goes wrong. Each says what its duration means."""

    ACK_THEN_NOTHING = "ack-then-nothing"
    """Commands are acknowledged and not carried out, as long as the fault lasts."""
    NO_ACK = "no-ack"
    """Commands are carried out and not acknowledged, as long as the fault lasts."""
    NEGATIVE_ACK = "negative-ack"
    """Commands are refused (Positive = 0) and not carried out, as long as the fault lasts."""
    TELEMETRY_DROPOUT = "telemetry-dropout"
    """No telemetry and no images; commands are still acknowledged and carried out."""
    HALF_OPEN = "half-open"
    """The app neither reads nor writes any more, but its socket stays open for the duration,
    while the app comes back at once on a new one: a phone that changed its network."""
    SECOND_LINK = "second-link"
    """A second connection with the same serial and telemetry, for the duration."""
    RESTART = "restart"
    """The app closes and comes back after the duration, knowing nothing of before: mission
    numbers begin anew, orders not yet carried out are lost. The aircraft flies on."""
    PLACEHOLDER_SERIAL = "placeholder-serial"
    """The serial is `00000`, as apps send it before they know, as long as the fault lasts."""

    BURSTS = "bursts"
    """What the app says is held back and goes out all at once, every one and a half seconds."""
    DELAYED_ACKS = "delayed-acks"
    """Acknowledgments come half a second to three seconds late; the acts come at once."""
    IGNORED_MISSIONS = "ignored-missions"
    """Missions are acknowledged and not flown; everything else works."""
    CORRUPTED_BYTES = "corrupted-bytes"
    """One in ten of the app's packets has one to three bytes changed."""
    SLOW_READER = "slow-reader"
    """The app reads 32 bytes each tenth of a second: commands wait, then the socket is full."""
    FALLS_SILENT = "falls-silent"
    """The drone falls from the sky and its app says nothing any more; the socket stays open. It
    does not end."""
    TAKEOFF_ALTITUDE_LOST = "takeoff-altitude-lost"
    """DJI tells no takeoff altitude: absolute altitudes are NaN, as long as the fault lasts."""
    TAKEOFF_ALTITUDE_STALE = "takeoff-altitude-stale"
    """DJI tells another flight's takeoff altitude, 47 m higher: it jumps at begin and end."""

    CAMERA_STOPS = "camera-stops"
    """No pictures come, though the feed says that it is on, as long as the fault lasts."""
    FRAMES_REPEATED = "frames-repeated"
    """The picture of the fault's begin is sent again and again."""
    FRAMES_BLACK = "frames-black"
    """Pictures are black."""
    FRAMES_TORN = "frames-torn"
    """Pictures are parts of two, one shifted sideways."""
    EXPOSURE_JUMPS = "exposure-jumps"
    """Each picture is exposed for another scene."""

    GUSTS = "gusts"
    """A squall on top of the wind: gusts up to 9 m/s every 8 s, from a direction of its own."""
    PILOT_TAKES = "pilot-takes"
    """The pilot flips the mode switch to sport and holds; missions and sticks of the app do nothing
    until he flips it back, after the duration."""
    GNSS_LOSS = "gnss-loss"
    """The receiver has 3 satellites and no signal worth the name, as long as the fault lasts: the
    aircraft ends what it flies (mode ATTI), and the wind carries it along."""
    LOW_BATTERY = "low-battery"
    """A cell fails: from the start on a fifth of the charge is left at most. It does not end."""


PLACEHOLDER_SERIAL = b"00000"
FAILED_CELL_FRACTION = 0.2
"""What a battery has left at most when a cell fails: under every reserve worth the name."""

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
    FaultKind.CAMERA_STOPS: (5.0, 20.0),
    FaultKind.FRAMES_REPEATED: (5.0, 20.0),
    FaultKind.FRAMES_BLACK: (5.0, 3.0),
    FaultKind.FRAMES_TORN: (5.0, 10.0),
    FaultKind.EXPOSURE_JUMPS: (5.0, 30.0),
    FaultKind.GUSTS: (5.0, 40.0),
    FaultKind.PILOT_TAKES: (5.0, inf),
    FaultKind.GNSS_LOSS: (5.0, inf),
    FaultKind.LOW_BATTERY: (5.0, inf),
}
"""Start and duration when the description leaves them out."""

LINK_FAULTS = (FaultKind.HALF_OPEN, FaultKind.SECOND_LINK, FaultKind.RESTART)
"""Faults that happen once, to the connection."""
AIRCRAFT_FAULTS = (
    FaultKind.PILOT_TAKES,
    FaultKind.LOW_BATTERY,
    FaultKind.GNSS_LOSS,
    FaultKind.GUSTS,
    FaultKind.FALLS_SILENT,
    FaultKind.TAKEOFF_ALTITUDE_LOST,
    FaultKind.TAKEOFF_ALTITUDE_STALE,
)
"""Faults that begin and end once, and do something to the aircraft then."""
STALE_BY_M = 47.0
"""Two pads of one farm's valley and hill."""

ALL_VEHICLES = "*"


@dataclass(frozen=True, slots=True)
class InjectedFault:
    """One fault of one vehicle, or of all."""

    kind: FaultKind
    vehicle: str = ALL_VEHICLES
    start_s: float = 0.0
    duration_s: float = inf
    source: str = field(default="", compare=False)
    """Where it stands in a file, for messages: `FILE: line N: `."""

    def is_for(self, serial: str, number: int) -> bool:
        """Return whether the vehicle with this serial, `number` of the fleet, has the fault."""
        return is_for(self.vehicle, serial, number)

    def end_ns(self, start_ns: int) -> int | None:
        """Return when it ends in a simulation that started then; None: never."""
        end_s = self.start_s + self.duration_s
        return start_ns + seconds_to_ns(end_s) if isfinite(end_s) else None

    def is_active(self, since_start_ns: int) -> bool:
        """Return whether the fault is on at a time since the simulation's start."""
        elapsed_s = since_start_ns / NS_PER_S
        return self.start_s <= elapsed_s < self.start_s + self.duration_s


def parse_fault(text: str) -> InjectedFault:
    """Return the fault a description names; raises `FaultError`."""
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
    """Return whether a fault's `vehicle` means the one with this serial, `number` of the fleet."""
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
        raise FaultError(f"fault {text!r}: expected a {what} in seconds from 0, got {word!r}")
    return value


S_PER_HOUR = 3_600.0


@dataclass(frozen=True, slots=True, kw_only=True)
class RandomFault:
    """A fault that comes now and then to each vehicle that it is for."""

    kind: FaultKind
    vehicle: str
    per_hour: float
    """On average; the times between two begins are exponential."""
    shortest_s: float
    longest_s: float
    """Each lasts as long as is drawn evenly between the two."""
    from_s: float
    until_s: float
    """The last begins before this."""
    source: str = ""

    def is_for(self, serial: str, number: int) -> bool:
        """Return whether the vehicle with this serial, `number` of the fleet, may have it."""
        return is_for(self.vehicle, serial, number)

    def drawn(self, random: Random) -> Iterator[InjectedFault]:
        """Yield one vehicle's faults, in order of time."""
        if self.per_hour < 1e-6:
            return
        start_s = self.from_s
        while (start_s := start_s + random.expovariate(self.per_hour / S_PER_HOUR)) < self.until_s:
            duration_s = random.uniform(self.shortest_s, self.longest_s)
            yield InjectedFault(self.kind, self.vehicle, start_s, duration_s, self.source)


def draw_faults(
    chances: tuple[RandomFault, ...], seed: int, serial: str, number: int
) -> tuple[InjectedFault, ...]:
    """Return all that chance has for one vehicle; one entry's draws do not move another's."""
    return tuple(
        fault
        for row, chance in enumerate(chances)
        if chance.is_for(serial, number)
        for fault in chance.drawn(Random(f"{seed}/{serial}/chance {row}"))
    )
