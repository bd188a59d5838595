"""The one snapshot all rules look at."""

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any, TypeVar

from recon.model.command import Command
from recon.model.control import ControlAuthority, Intent, OperatorLease, StopLatch
from recon.model.units import Stamped
from recon.model.vehicle import VehicleState
from recon.safety.airspace import OPEN_AIRSPACE, PreparedAirspace
from recon.safety.settings import SafetySettings

T = TypeVar("T")


@dataclass(frozen=True, slots=True)
class ClockReading:
    """The computer's clock at its last reading, and how far it was set since the station started.

    The station's own time never jumps; the computer's may.
    """

    wall_ns: int
    set_by_ns: int = 0


@dataclass(frozen=True, slots=True)
class PlannedFlights:
    """What a vehicle's survey takes yet: its greatest height above takeoff, and photos, about."""

    highest_m: float | None = None
    photos: int | None = None


@dataclass(frozen=True, slots=True)
class StationFacts:
    """`others` are all other vehicles that are connected or may be in the air; `app_warnings` the
    app's unacknowledged warnings; `planned` what its survey takes, unknown without one."""

    clock: ClockReading | None = None
    others: tuple[VehicleState, ...] = ()
    app_warnings: tuple[str, ...] = ()
    planned: PlannedFlights = PlannedFlights()


NO_FACTS = StationFacts()
"""Facts of an unknown station, with which no mission is flown."""


@dataclass(frozen=True, slots=True)
class ClaimingLink:
    """An open link reporting this serial; whether it is in the air, as believed and as reported."""

    link_id: int
    is_flying: Stamped[bool]
    reported_is_flying: Stamped[bool] = Stamped()

    @property
    def may_be_on_ground(self) -> bool:
        """Whether it reports the ground, and is not believed to fly all the same."""
        is_down = False in (self.is_flying.value, self.reported_is_flying.value)
        return is_down and self.is_flying.value is not True


@dataclass(frozen=True, slots=True)
class Traffic:
    """Another vehicle that is or may be in the air, and its last commanded motion."""

    vehicle: VehicleState
    intent: Intent = Intent()


@dataclass(frozen=True, slots=True)
class Override:
    """An operator's override of a vehicle's preflight checklist."""

    by: str
    reason: str
    at_ns: int


@dataclass(frozen=True, slots=True)
class Situation:
    """What is known when a command is judged.

    `vehicle` is the state of the command's vehicle, or of the unidentified link it names; None when
    there is neither. `claiming_links` are its open links, its own first; more than one while its
    identity is unsettled. `stick_height_above_takeoff_m` is what its newest stick asked for.
    `traffic` are the other vehicles in the air, lost ones included. `stop_latch` is the all stop in
    force. `lease` names the person who operates the vehicle. `waiting_link_ids` are links that
    report the command's serial and are not admitted; to a stop they are claiming links as well.
    """

    now_ns: int
    vehicle: VehicleState | None
    claiming_links: tuple[ClaimingLink, ...]
    waiting_link_ids: tuple[int, ...] = ()
    settings: SafetySettings = SafetySettings()
    airspace: PreparedAirspace = OPEN_AIRSPACE
    authority: ControlAuthority = ControlAuthority()
    lease: OperatorLease | None = None
    stop_latch: StopLatch | None = None
    intent: Intent = Intent()
    stick_height_above_takeoff_m: float | None = None
    traffic: tuple[Traffic, ...] = ()
    preflight_override: Override | None = None
    facts: StationFacts = NO_FACTS
    _worked_out: dict[object, tuple[Command, Any]] = field(
        default_factory=dict, init=False, repr=False, compare=False
    )

    def once(self, command: Command, work: Callable[[Command, "Situation"], T]) -> T:
        """Return what `work` makes of the command here; several rules that ask share one answer."""
        known = self._worked_out.get(work)
        # By identity: to compare two missions takes longer than most rules.
        if known is None or known[0] is not command:
            known = (command, work(command, self))
            self._worked_out[work] = known
        answer: T = known[1]
        return answer
