"""The fleet return's times, each with its reason."""

from dataclasses import dataclass, field

from recon.guidance.fleet_return import FleetReturnSettings


@dataclass(frozen=True, slots=True)
class ReturnSettings:
    """Times in seconds."""

    plan: FleetReturnSettings = field(default_factory=FleetReturnSettings)

    look_every_s: float = 0.2
    """How often it is looked whose turn it is; each flight lasts a minute or so."""

    stands_within_s: float = 12.0
    """From 15 m/s an aircraft stands within 6 s of a hold, which is sent up to 2 s late."""

    heard_within_s: float = 3.0
    """A vehicle that waits and is not heard for so long may do anything: it is left out."""

    judged_again_s: float = 1.0
    """A flight that the gate does not let begin yet is judged again after this."""

    planned_within_s: float = 20.0
    """A plan takes a tenth of a second, behind one frame's work or two. Longer than this the worker
    does not work, and those that hover must not wait for it."""

    planned_again_s: float = 2.0
    """Between two plans for the same vehicles, when somebody moves in their way."""

    gate_waits_s: float = 30.0
    """With nobody of the return in the air before it, the gate may wait this long for telemetry or
    for other vehicles; then its refusal stands."""

    pad_clearing_s: float = 30.0
    """From a landing to the next one at the same pad, at least: time to carry the first vehicle
    away. An alarm asks for it."""

    same_pad_m: float = 5.0
    """Pads nearer than this are one: on neither could two vehicles stand."""

    moved_m: float = 10.0
    """A waiting vehicle this far from where it was has been moved by its pilot, or has drifted away
    without holding its place; either way it is not flown any further."""

    hovers_after_s: float = 3.0
    """A flight out of its mission and its landing for so long was ended by somebody."""


SETTINGS = ReturnSettings()
