"""The stream of a vehicle to one steered order: who holds it, where it leads, how far it came."""

from dataclasses import dataclass

from recon.guidance.path_following import SteeredPath
from recon.guidance.steering import Goal, Steered
from recon.model.command import Command
from recon.model.units import seconds_to_ns
from recon.model.vehicle import FlightMode


@dataclass(frozen=True, slots=True)
class StreamSettings:
    """Times in seconds."""

    period_s: float = 0.1
    """10 Hz: aircraft take 5 to 25 Hz, and may hover below."""

    slots: int = 10
    """The streams' sticks are spread over the period: ten vehicles' sticks do not wait for each
    other, and the station's other work gets its turn between."""

    most_at_once: int = 16
    """Most streams at once. With 64 vehicles in the air the gate takes some 4 ms for each stick: 16
    streams are two thirds of a core, and a stop given meanwhile waits for a few sticks at most."""

    stick_timeout_s: float = 1.0
    """An app that hears no more sticks stops after this; the station sends the zero itself."""

    max_telemetry_age_s: float = 1.0
    """Largest age of telemetry, as for the gate; beyond it a neutral setpoint is sent."""

    resumes_s: float = 3.0
    """Telemetry that comes back within this resumes the stream. Later the vehicle may be
    anywhere, and its operator may have turned to something else."""

    neutral_to_hold_s: float = 0.15
    """Time between the zero at a stream's end and the hold that follows: the zero may have to wait
    75 ms for the gap after the stick before it and for the next tick, and an app that reads two
    packets at once loses the second."""

    obeyed_s: float = 3.0
    """An aircraft goes over to sticks within a second, and its mode is reported at 2 Hz."""

    hold_at_most_s: float = 900.0
    """Longest hold at a stream's goal, then the vehicle is left to its own position hold. Longer
    than half a battery: to hold on, order it again."""

    hold_speed_mps: float = 5.0
    """Back to a place to be held: faster than any wind's drift, slower than a flight."""


@dataclass(frozen=True)
class SetpointStream:
    """One steered order being carried out. Times are station time.

    `owner` names the connection whose end ends it. `link_id` is the vehicle's link at its start:
    no stream outlives that. `seen_at_ns` is when the telemetry last steered by was received.
    `mode_before` is the flight mode at its start. `closing` is why it ends, once zero has been
    sent and hold is to follow.
    """

    command: Command
    owner: str | None
    goal: Goal
    steered: Steered
    link_id: int | None
    started_at_ns: int
    next_due_ns: int
    seen_at_ns: int
    mode_before: FlightMode | None = None
    last_stick_id: int = 0
    packets_sent: int = 0
    first_sent_at_ns: int | None = None
    is_obeyed: bool = False
    arrived_at_ns: int | None = None
    closing: str | None = None
    path: SteeredPath | None = None
    """Of an order along a path; `goal` is then on its present leg."""


def following_due_ns(due_ns: int, now_ns: int, settings: StreamSettings) -> int:
    """Return the next time of a cadence after `now_ns`: late steps do not shift it."""
    period_ns = seconds_to_ns(settings.period_s)
    missed = max(0, (now_ns - due_ns) // period_ns)
    return due_ns + (missed + 1) * period_ns


def first_due_ns(others_due_ns: tuple[int, ...], now_ns: int, settings: StreamSettings) -> int:
    """Return the second stick's time, in the slot of the period that fewest others use.

    It is most of a period away: the first one goes at once, and apps need a gap between.
    """
    period_ns = seconds_to_ns(settings.period_s)
    slot_ns = period_ns // settings.slots
    used = [due_ns % period_ns // slot_ns for due_ns in others_due_ns]
    slot = min(range(settings.slots), key=lambda number: (used.count(number), number))
    earliest_ns = now_ns + period_ns * 4 // 5
    wait_ns = (slot * slot_ns - earliest_ns) % period_ns
    return earliest_ns + wait_ns
