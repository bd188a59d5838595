"""What the station knows beside the vehicle and its air, as the checklist needs it."""

from dataclasses import dataclass

from recon.model.vehicle import VehicleState


@dataclass(frozen=True, slots=True)
class ClockReading:
    """What the computer's clock said last, and by how much it was set since the station began.

    The station's own time never jumps; the computer's may.
    """

    wall_ns: int
    set_by_ns: int = 0


@dataclass(frozen=True, slots=True)
class StationFacts:
    """`others` are all other vehicles that are connected or may be in the air; `app_warnings` what
    the vehicle's app has said and nobody has seen."""

    clock: ClockReading | None = None
    others: tuple[VehicleState, ...] = ()
    app_warnings: tuple[str, ...] = ()


NO_FACTS = StationFacts()
"""Nothing is known: no mission is flown."""
