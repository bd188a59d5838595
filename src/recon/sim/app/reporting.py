"""An app that tells more than its packets: facts and photos, in texts of `recon 1` (docs/icd.md).

Its camera's timer runs while the aircraft flies a mission or is steered, at a phase of its own.
What it truly took stays here, for tests and scores: the station learns what the texts say.
"""

import json
from collections.abc import Callable
from dataclasses import dataclass, field
from random import Random
from typing import Any

from recon import wire
from recon.model.geo import GeoPoint
from recon.model.units import NS_PER_S, seconds_to_ns, wrap_degrees
from recon.model.vehicle import FlightMode
from recon.sim.app.faults import FaultKind
from recon.sim.app.telemetry import position_deg
from recon.sim.flight.aircraft import Aircraft

MESSAGE_DEBUG = 0
SURVEYING = (FlightMode.GPS_WAYPOINT, FlightMode.JOYSTICK)
"""Modes in which rows are flown: by a mission, or steered."""
LEAST_NS = NS_PER_S
"""Least time between two texts of a kind."""
LOOK_NS = NS_PER_S // 10
"""The app looks this often whether there is something to tell."""
CHANGING = frozenset(
    (
        "battery_cells_v",
        "battery_temperature_c",
        "storage_left_mb",
        "storage_left_photos",
        "photo_count",
    )
)
"""What changes all the time, and is no reason to send facts."""
REPEAT_NS = 10 * NS_PER_S
"""Facts are sent this often in any case."""
MOST_IN_A_TEXT = 16
MOST_WAITING = 256
FAILS_AFTER, SKIPS_EVERY, LATE_NS = 20, 5, 25 * NS_PER_S
"""Photos until a timer fails; which of them one that skips leaves out; how late one starts."""
STORAGE_PHOTOS, STORAGE_MB = 7_000, 58_000
PHOTO_MB = 8


@dataclass(frozen=True, slots=True)
class TruePhoto:
    """A photo, and where the aircraft truly was: metres from home."""

    index: int
    at_ns: int
    north_m: float
    east_m: float
    height_m: float
    yaw_deg: float


@dataclass(slots=True)
class AppReporter:
    """The facts and photos of one app; `has` says which faults are active at a time."""

    serial: str
    home: GeoPoint
    aircraft: Aircraft
    interval_s: float
    takes_missions: bool
    series: int
    random: Random
    has: Callable[[FaultKind, int], bool]
    failsafe: str = "go_home"
    is_locked: bool = False
    taken: list[TruePhoto] = field(default_factory=list)
    """All photos that were taken, in order."""
    _waiting: list[tuple[int, dict[str, Any]]] = field(default_factory=list)
    """Photos not reported yet, each with its time."""
    _mission_since_ns: int | None = None
    _shutter_ns: int = 0
    _look_ns: int = 0
    _due_count: int = 0
    """Photos that were due in missions, taken or not."""
    _sent_facts: str = ""
    _facts_ns: int | None = None
    _photos_ns: int | None = None

    @property
    def next_due_ns(self) -> int:
        """Return when `texts` is to be called next."""
        if self._mission_since_ns is None:
            return self._look_ns
        return min(self._look_ns, self._shutter_ns)

    def connected(self) -> None:
        """Begin a connection: facts are sent first."""
        self._facts_ns = None

    def lock(self, is_locked: bool) -> str:
        """Lock exposure and white balance, or unlock both."""
        self.is_locked = is_locked
        return f"camera {'locked' if is_locked else 'unlocked'}"

    def texts(self, now_ns: int, is_connected: bool) -> list[bytes]:
        """Advance to a time; return the packets to send. Without a connection they wait."""
        self._run_timer(now_ns)
        if now_ns >= self._look_ns:
            self._look_ns = now_ns + LOOK_NS
        if not is_connected:
            return []
        found = []
        if self._facts_ns is None or now_ns - self._facts_ns >= LEAST_NS:
            found += self._facts(now_ns)
        is_due = self._photos_ns is None or now_ns - self._photos_ns >= LEAST_NS
        if self._waiting and is_due:
            found.append(self._photos(now_ns))
        return found

    def _run_timer(self, now_ns: int) -> None:
        if self.aircraft.flight_mode not in SURVEYING:
            self._mission_since_ns = None
            return
        if self._mission_since_ns is None:
            self._mission_since_ns = now_ns
            phase_s = self.random.uniform(0.0, self.interval_s)
            self._shutter_ns = now_ns + seconds_to_ns(phase_s)
            if self.has(FaultKind.PHOTO_TIMER_LATE, now_ns):
                self._shutter_ns += LATE_NS
        if now_ns >= self._shutter_ns:
            self._shutter_ns += seconds_to_ns(self.interval_s)
            self._due_count += 1
            if not self._is_missed(now_ns):
                self._take(now_ns)

    def _is_missed(self, now_ns: int) -> bool:
        if self.has(FaultKind.PHOTO_TIMER_FAILS, now_ns) and self._due_count > FAILS_AFTER:
            return True
        is_skipped = self._due_count % SKIPS_EVERY == 0
        return is_skipped and self.has(FaultKind.PHOTO_TIMER_SKIPS, now_ns)

    def _take(self, now_ns: int) -> None:
        motion, estimate = self.aircraft.motion, self.aircraft.estimate
        index = len(self.taken) + 1
        place = (motion.north_m, motion.east_m, motion.height_m, motion.yaw_deg)
        self.taken.append(TruePhoto(index, now_ns, *place))
        latitude_deg, longitude_deg = position_deg(self.home, estimate.north_m, estimate.east_m)
        photo = {
            "index": index,
            "latitude_deg": round(latitude_deg, 8),
            "longitude_deg": round(longitude_deg, 8),
            "height_above_takeoff_m": round(estimate.height_m, 2),
            "yaw_deg": round(wrap_degrees(estimate.yaw_deg), 1),
            "gimbal_pitch_deg": -90.0,
            "lens": "wide",
            "file": f"DJI_{index:04d}.JPG",
        }
        self._waiting = [*self._waiting, (now_ns, photo)][-MOST_WAITING:]

    def _photos(self, now_ns: int) -> bytes:
        sent, self._waiting = self._waiting[:MOST_IN_A_TEXT], self._waiting[MOST_IN_A_TEXT:]
        self._photos_ns = now_ns
        photos = [
            {**photo, "age_s": round((now_ns - at_ns) / NS_PER_S, 3)} for at_ns, photo in sent
        ]
        return _text(
            {"kind": "photos", "series": self.series, "serial": self.serial, "photos": photos}
        )

    def _facts(self, now_ns: int) -> list[bytes]:
        known = self._known_facts()
        facts = json.dumps({name: each for name, each in known.items() if name not in CHANGING})
        is_old = self._facts_ns is None or now_ns - self._facts_ns >= REPEAT_NS
        if facts == self._sent_facts and not is_old:
            return []
        self._sent_facts, self._facts_ns = facts, now_ns
        return [_text(known)]

    def _known_facts(self) -> dict[str, Any]:
        aircraft, settings, count = self.aircraft, self.aircraft.settings, len(self.taken)
        home = position_deg(self.home, aircraft.home_north_m, aircraft.home_east_m)
        return {
            "kind": "facts",
            "go_home_height_m": settings.go_home_height_m,
            "failsafe": self.failsafe,
            "home_latitude_deg": round(home[0], 8),
            "home_longitude_deg": round(home[1], 8),
            "max_height_m": settings.max_height_m,
            "max_distance_m": settings.max_distance_m,
            "model": "simulated",
            "firmware": "1.0",
            "app": "recon sim",
            "battery_cells_v": [round(3.4 + 0.8 * aircraft.battery.fraction, 2)] * 4,
            "battery_temperature_c": 25.0,
            "rtk": "off",
            "storage_left_mb": STORAGE_MB - PHOTO_MB * count,
            "storage_left_photos": max(0, STORAGE_PHOTOS - count),
            "gimbal_pitch_deg": -90.0,
            "camera_mode": "interval",
            "photo_interval_s": self.interval_s,
            "exposure_locked": self.is_locked,
            "white_balance_locked": self.is_locked,
            "can_fly_missions": self.takes_missions,
            "max_waypoints": 99 if self.takes_missions else 0,
            "dji_check_passed": True,
            "reports_photos": True,
            "photo_series": self.series,
            "photo_count": count,
            "orders": ["lock_camera"],
        }


def _text(found: dict[str, Any]) -> bytes:
    text = b"recon 1 " + json.dumps(found, separators=(",", ":")).encode()
    return wire.encode(wire.MessageString(type=MESSAGE_DEBUG, text=text))
