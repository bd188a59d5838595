"""Faults by name: what companion apps in the field get wrong, on order.

A fault is written `NAME[:vehicle[:start_s[:duration_s]]]`; the vehicle is a serial, its number in
the fleet (1 is the first), or `*` for all; times count from the start of the simulation.
"""

from dataclasses import dataclass
from enum import Enum
from math import inf, isfinite

from recon.model.units import NS_PER_S
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
    FaultKind.PILOT_TAKES: (5.0, inf),
    FaultKind.GNSS_LOSS: (5.0, inf),
    FaultKind.LOW_BATTERY: (5.0, inf),
}
"""Start and duration when the description leaves them out."""

LINK_FAULTS = (FaultKind.HALF_OPEN, FaultKind.SECOND_LINK, FaultKind.RESTART)
"""Faults that happen once, to the connection."""
AIRCRAFT_FAULTS = (FaultKind.PILOT_TAKES, FaultKind.LOW_BATTERY, FaultKind.GNSS_LOSS)
"""Faults that happen once, to the aircraft."""

ALL_VEHICLES = "*"


@dataclass(frozen=True, slots=True)
class Fault:
    """One fault of one vehicle, or of all."""

    kind: FaultKind
    vehicle: str = ALL_VEHICLES
    start_s: float = 0.0
    duration_s: float = inf

    def is_for(self, serial: str, number: int) -> bool:
        """Return whether the vehicle with this serial, `number` of the fleet, has the fault."""
        return self.vehicle in (ALL_VEHICLES, serial, str(number))

    def is_active(self, since_start_ns: int) -> bool:
        """Return whether the fault is on at a time since the simulation's start."""
        elapsed_s = since_start_ns / NS_PER_S
        return self.start_s <= elapsed_s < self.start_s + self.duration_s


def parse_fault(text: str) -> Fault:
    """Return the fault a description names; raises `FaultError`."""
    name, *rest = text.split(":")
    kind = _kind(name)
    if len(rest) > 3:
        raise FaultError(
            f"fault {text!r}: expected NAME[:vehicle[:start_s[:duration_s]]], "
            f"got {len(rest) + 1} parts"
        )
    vehicle, start, duration = (*rest, "", "", "")[:3]
    default_start_s, default_duration_s = _DEFAULT_TIMES_S[kind]
    return Fault(
        kind,
        vehicle or ALL_VEHICLES,
        _seconds(start, default_start_s, "start", text),
        _seconds(duration, default_duration_s, "duration", text),
    )


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
