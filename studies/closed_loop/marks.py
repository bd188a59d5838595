"""What was so of each vehicle lately, and the class of a violation by it: see the package's rules.

Marks come from the simulator, from the bytes that passed and from the orders given. Nothing here
reads the station's conclusions.
"""

from collections.abc import Sequence
from dataclasses import dataclass, field
from enum import Enum

from tests.oracles.flown_air import Breach

PILOT_S = FAULT_S = 12.0
"""From 15 m/s a vehicle needs 6 s to stand still, and the other one as long after it."""
FRESH_S = GUST_S = 8.0
ALARMED_S = 20.0
BRAKES_S = 3.0
"""A landing that an order ends goes on down while the descent is braked."""


class ViolationClass(Enum):
    """Who or what a violation is due to."""

    PHYSICS = "physics"
    PILOT = "pilot"
    FAULT = "fault"
    PERSON = "person"
    STATION = "station"


class Mark(Enum):
    """Something that was so of a vehicle."""

    PILOT_FLIES = "its pilot flew it"
    NO_TELEMETRY = "no telemetry arrived for 1 s"
    NO_COMMANDS = "it received or obeyed nothing"
    WRONG_HEIGHT = "its heights were wrong"
    FORCED_LANDING = "it landed or fell automatically"
    GUST = "wind pushed it"
    DAMAGED = "bytes of it were changed on their way"


@dataclass(slots=True)
class VehicleMarks:
    """When each mark was last so, and what is so since when. Times in seconds."""

    last_s: dict[Mark, float] = field(default_factory=dict)
    why: dict[Mark, str] = field(default_factory=dict)
    known_since_s: float | None = None
    """Since when telemetry arrives."""
    left_by_pilot: bool = False
    """No motion packet has reached it since its pilot flew it."""
    is_coming_down: bool = False
    """No packet that moves has reached it since land or return; a hold may have left it low."""
    landing_ended_s: float | None = None
    """When a packet that moves last reached it while it landed."""
    is_given_to_pilot: bool = False
    """A person has given it to its pilot; the watchdogs may only warn of it."""
    battery_alarm_since_s: float | None = None
    landed_s: float | None = None
    low_at_m: tuple[float, float] | None = None
    """Where it came down or was stopped on its way down, until it has climbed again."""
    has_wrong_plane: bool = False
    """It has landed on a slope, where the simulator's heights end."""

    def mark(self, mark: Mark, now_s: float, why: str = "") -> None:
        """Note that something is so now."""
        self.last_s[mark] = now_s
        self.why[mark] = why

    def brakes_descent(self, now_s: float) -> bool:
        """Whether an order has ended its landing only just."""
        return self.landing_ended_s is not None and now_s - self.landing_ended_s < BRAKES_S

    def was(self, mark: Mark, now_s: float, within_s: float) -> bool:
        """Whether something was so lately."""
        last_s = self.last_s.get(mark)
        return last_s is not None and now_s - last_s <= within_s


@dataclass(frozen=True, slots=True)
class StationMarks:
    """What concerns all vehicles."""

    started_s: float = -1e9
    """When the station was last started with vehicles in the air."""
    are_holds_off: bool = False


PLACES = ("fence", "keep-out zone", "height zone", "too high", "too low", "home distance")
FAULTS = (Mark.NO_TELEMETRY, Mark.NO_COMMANDS, Mark.WRONG_HEIGHT, Mark.FORCED_LANDING)


def classify(
    breach: Breach, vehicles: Sequence[VehicleMarks], station: StationMarks, now_s: float
) -> tuple[ViolationClass, str]:
    """Return the class of a violation that begins now, and the reason."""
    if breach.kind in ("pilot's vehicle", "shown age", "code fault"):
        return ViolationClass.STATION, "no excuse"
    if breach.kind == "shown place":
        return _of_shown_place(vehicles[0], now_s)
    if breach.kind == "takeoff":
        return _of_takeoff(vehicles, now_s)
    if breach.kind == "hold":
        return _of_hold(vehicles, now_s)
    if any(v.left_by_pilot or v.was(Mark.PILOT_FLIES, now_s, PILOT_S) for v in vehicles):
        return ViolationClass.PILOT, "flown there by its pilot"
    for vehicle in vehicles:
        for mark in FAULTS:
            if vehicle.was(mark, now_s, FAULT_S):
                return ViolationClass.FAULT, f"{mark.value} ({vehicle.why[mark]})"
    if any(v.was(Mark.GUST, now_s, GUST_S) for v in vehicles):
        return ViolationClass.PHYSICS, Mark.GUST.value
    if now_s - station.started_s < FRESH_S or any(_is_fresh(v, now_s) for v in vehicles):
        return ViolationClass.PHYSICS, "known to the station too shortly"
    return _of_persons(breach, vehicles, station, now_s)


def _of_persons(
    breach: Breach, vehicles: Sequence[VehicleMarks], station: StationMarks, now_s: float
) -> tuple[ViolationClass, str]:
    if breach.kind in PLACES and vehicles[0].is_coming_down:
        return ViolationClass.PERSON, "land or return, which is always sent"
    if breach.kind == "separation" and any(
        v.is_given_to_pilot and v.is_coming_down for v in vehicles
    ):
        return (
            ViolationClass.PERSON,
            "return or landing of a vehicle that is its pilot's: never held",
        )
    if breach.kind == "separation" and station.are_holds_off:
        return ViolationClass.PERSON, "an operator had switched the holds off"
    if breach.kind == "forced landing":
        since_s = vehicles[0].battery_alarm_since_s
        if since_s is not None and now_s - since_s >= ALARMED_S:
            return ViolationClass.PERSON, "left in the air under a battery alarm"
    return ViolationClass.STATION, "nothing else explains it"


def _of_takeoff(vehicles: Sequence[VehicleMarks], now_s: float) -> tuple[ViolationClass, str]:
    vehicle = vehicles[0]
    if vehicle.was(Mark.NO_TELEMETRY, now_s, 3.0):
        return ViolationClass.FAULT, Mark.NO_TELEMETRY.value
    if vehicle.landed_s is not None and now_s - vehicle.landed_s < 1.0:
        return ViolationClass.PHYSICS, "it had landed only just"
    return ViolationClass.STATION, "nothing else explains it"


def _of_shown_place(vehicle: VehicleMarks, now_s: float) -> tuple[ViolationClass, str]:
    if vehicle.was(Mark.DAMAGED, now_s, FAULT_S):
        return ViolationClass.FAULT, f"{Mark.DAMAGED.value} ({vehicle.why[Mark.DAMAGED]})"
    return ViolationClass.STATION, "no excuse"


def _of_hold(vehicles: Sequence[VehicleMarks], now_s: float) -> tuple[ViolationClass, str]:
    for mark in (Mark.NO_TELEMETRY, Mark.NO_COMMANDS):
        if vehicles[0].was(mark, now_s, 1.0):
            return ViolationClass.FAULT, f"{mark.value} ({vehicles[0].why[mark]})"
    return ViolationClass.STATION, "nothing else explains it"


def _is_fresh(vehicle: VehicleMarks, now_s: float) -> bool:
    return vehicle.known_since_s is None or now_s - vehicle.known_since_s < FRESH_S
