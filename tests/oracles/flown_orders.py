"""What must hold of orders and of what is shown, told from bytes and times alone.

Each oracle is fed with what happened on the outside of the station: orders given to it, packets
that reached apps, packets that left them, and the simulator's truth. Times are in seconds.
"""

from collections import deque
from collections.abc import Iterator
from dataclasses import dataclass, field
from math import isinf

from tests.oracles.flown_air import Breach

LATEST_STOP_S = 0.5
"""From an operator's hold to its arrival at the app, the link's own delay included."""
TAKEOFF_ORDER_HOLDS_S = 15.0
"""An order expires after 5 s; a mission waits for an answer, motors need 2 s."""
SHOWN_LATE_S = 0.15
"""What a tick of 50 ms and a split packet may add to a link's delay."""
LIVE_S = 1.0
ALARM_WITHIN_S = 1.5


@dataclass(slots=True)
class _Stop:
    at_s: float
    is_expected: bool


@dataclass(slots=True)
class StopClock:
    """Every hold reaches its app in time, wherever the downlink lives."""

    latencies_s: list[float] = field(default_factory=list)
    _open: dict[str, deque[_Stop]] = field(default_factory=dict)

    def ordered(self, serial: str, at_s: float, *, is_expected: bool) -> None:
        """Note a hold; it is not expected on the ground, or while the downlink is dead."""
        self._open.setdefault(serial, deque()).append(_Stop(at_s, is_expected))

    def arrived(self, serial: str, at_s: float) -> None:
        """Note a hold that reached the app; it answers all that were given before."""
        waiting = self._open.pop(serial, deque())
        self.latencies_s += [at_s - stop.at_s for stop in waiting if stop.is_expected]

    def excuse(self, serial: str) -> None:
        """Expect no open hold of a vehicle any more: its downlink died."""
        for stop in self._open.get(serial, ()):
            stop.is_expected = False

    def late(self, now_s: float) -> Iterator[Breach]:
        """Yield each hold that should have arrived by now, once."""
        for serial, waiting in self._open.items():
            while waiting and now_s - waiting[0].at_s > LATEST_STOP_S:
                stop = waiting.popleft()
                if stop.is_expected:
                    self.latencies_s.append(float("inf"))
                    text = f"not received {LATEST_STOP_S:g} s after the order"
                    yield Breach("hold", (serial,), f"{stop.at_s:.2f}", 0.0, text)


@dataclass(slots=True)
class TakeoffPermits:
    """No vehicle leaves the ground unless an order with takeoff allows it, once."""

    _until_s: dict[str, float] = field(default_factory=dict)

    def allow(self, serial: str, now_s: float, for_s: float = TAKEOFF_ORDER_HOLDS_S) -> None:
        """Note an order with takeoff."""
        self._until_s[serial] = max(now_s + for_s, self._until_s.get(serial, 0.0))

    def withdraw(self, serial: str) -> None:
        """Note that what had allowed it is over."""
        if isinf(self._until_s.get(serial, 0.0)):
            del self._until_s[serial]

    def took_off(self, serial: str, now_s: float) -> Breach | None:
        """Return the breach when nothing allowed a takeoff; a permit is used up."""
        if now_s <= self._until_s.pop(serial, -1.0):
            return None
        return Breach("takeoff", (serial,), f"{now_s:.1f}", 0.0, "took off without such an order")


@dataclass(slots=True)
class PilotGuard:
    """No packet that moves a vehicle reaches it while its pilot flies it and the station knows."""

    grace_s: float = 0.3
    _since_s: dict[str, float] = field(default_factory=dict)
    _known_s: dict[str, float] = field(default_factory=dict)

    def takes(self, serial: str, now_s: float) -> None:
        """The pilot has taken control by the mode switch."""
        self._since_s.setdefault(serial, now_s)

    def reported(self, serial: str, now_s: float) -> None:
        """Telemetry with the pilot's mode has reached the station."""
        if serial in self._since_s:
            self._known_s.setdefault(serial, now_s)

    def ends(self, serial: str) -> None:
        """The pilot has let go, or an operator has taken control."""
        self._since_s.pop(serial, None)
        self._known_s.pop(serial, None)

    def motion_arrived(
        self, serial: str, now_s: float, link_delay_s: float, what: str
    ) -> Breach | None:
        """Return the breach when a packet that moves arrived too late to be excused."""
        known_s = self._known_s.get(serial)
        if known_s is None or now_s - link_delay_s <= known_s + self.grace_s:
            return None
        text = f"{what} reached a pilot's vehicle {now_s - known_s:.2f} s after the station knew"
        return Breach("pilot's vehicle", (serial,), "", now_s - known_s, text)


@dataclass(slots=True)
class ShownAges:
    """No shown value is older than its shown age and the link's delay explain."""

    _made: dict[str, deque[tuple[float, tuple[float, float]]]] = field(default_factory=dict)

    def made(self, serial: str, now_s: float, place: tuple[float, float]) -> None:
        """Note core telemetry that left an app with this latitude and longitude."""
        self._made.setdefault(serial, deque(maxlen=400)).append((now_s, place))

    def shown(
        self,
        serial: str,
        now_s: float,
        place: tuple[float, float],
        shown_age_s: float,
        link_delay_s: float,
    ) -> Breach | None:
        """Return the breach when a shown place looks younger than it is."""
        for made_s, made in reversed(self._made.get(serial, ())):
            if made != place:
                continue
            true_age_s = now_s - made_s
            excess_s = true_age_s - shown_age_s - link_delay_s - SHOWN_LATE_S
            if excess_s <= 0.0:
                return None
            word = "live" if shown_age_s < LIVE_S else "younger"
            text = f"shown {word} at an age of {shown_age_s:.2f} s; it is {true_age_s:.2f} s old"
            return Breach("shown age", (serial,), "", excess_s, text)
        return Breach("shown place", (serial,), "", 0.0, "a place is shown that was never sent")


ALARM_RULES: dict[str, tuple[str, ...]] = {
    "separation": ("separation", "link_lost", "unidentified_lost"),
    "fence": ("fence_ahead", "link_lost"),
    "keep-out zone": ("zone_ahead", "link_lost"),
    "height zone": ("height_limit", "link_lost"),
    "too high": ("height_limit", "link_lost"),
    "too low": ("height_limit", "link_lost"),
    "forced landing": ("battery", "battery_home", "link_lost"),
}
"""Which alarms tell an operator of each kind of breach."""


def missing_alarm(
    breach: Breach, lasted_s: float, alarms: set[tuple[str, str | None, str]]
) -> Breach | None:
    """Return the breach of a breach without an alarm: `alarms` are (rule, serial, key)."""
    rules = ALARM_RULES.get(breach.kind)
    if rules is None or lasted_s < ALARM_WITHIN_S:
        return None
    for rule, serial, key in alarms:
        if rule in rules and (serial in breach.serials or any(s in key for s in breach.serials)):
            return None
    text = f"no alarm {lasted_s:.1f} s after it began: {breach.kind}, {breach.text}"
    return Breach("alarm missing", breach.serials, breach.kind, lasted_s, text)
