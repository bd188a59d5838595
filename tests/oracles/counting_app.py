"""A companion app that counts what it carries out, so that repeated and missing commands show.

Its aircraft is a point that flies straight; what matters here is the session, not the flight.
"""

import random
from collections import Counter
from dataclasses import dataclass, field
from math import hypot

from recon import wire
from recon.model.geo import GeoPoint
from recon.model.units import seconds_to_ns
from recon.model.vehicle import FlightMode

CORE_EVERY_NS = 100_000_000
EXTENDED_EVERY = 5
METRES_PER_DEGREE = 111_320.0
FLYING_HEIGHT_M = 40.0
LANDING_MPS = 4.0
GROUND_S = 6.0
STICK_S = 1.0


@dataclass(slots=True)
class Temper:
    """How often an app refuses a command, or acknowledges it and does nothing."""

    refuses: float = 0.02
    ignores: float = 0.02


@dataclass(slots=True)
class CountingApp:
    """One vehicle; it outlives its connections. Bytes and times in, bytes out."""

    serial: str
    home: GeoPoint
    rng: random.Random
    temper: Temper = field(default_factory=Temper)
    executed: Counter[tuple[str, float]] = field(default_factory=Counter)
    """How often each marked command was carried out: kind and mark."""
    emergencies: Counter[int] = field(default_factory=Counter)
    stick_times_ns: list[int] = field(default_factory=list)
    """When a stick that moves came."""
    silent_until_ns: int = 0
    north_m: float = 0.0
    east_m: float = 0.0
    height_m: float = FLYING_HEIGHT_M
    is_flying: bool = True
    mode: FlightMode = FlightMode.GPS_ATTI
    _legs: list[tuple[float, float, float]] = field(default_factory=list)
    _velocity_mps: tuple[float, float] = (0.0, 0.0)
    _stick_until_ns: int = 0
    _grounded_until_ns: int = 0
    _images: bool = False
    _deframer: wire.Deframer = field(default_factory=wire.Deframer)
    _outgoing: list[bytes] = field(default_factory=list)
    _next_core_ns: int = 0
    _cores: int = 0

    def connected(self) -> None:
        """Begin a new connection: half packets of the old one are gone."""
        self._deframer = wire.Deframer()
        self._outgoing.clear()
        self._cores = 0

    def receive(self, data: bytes, now_ns: int) -> None:
        """Take bytes from the station and carry out what they ask."""
        for packet in self._deframer.feed(data, now_ns):
            self._obey(packet, now_ns)

    def advance(self, now_ns: int) -> list[bytes]:
        """Return what it sends now."""
        if now_ns >= self._next_core_ns:
            self._next_core_ns = now_ns + CORE_EVERY_NS
            self._fly(CORE_EVERY_NS / 1e9, now_ns)
            if now_ns >= self.silent_until_ns:
                self._report()
        sent, self._outgoing = self._outgoing, []
        return sent

    @property
    def next_due_ns(self) -> int:
        """When it flies on and reports next."""
        return self._next_core_ns

    def _obey(self, packet: wire.Packet, now_ns: int) -> None:
        refused = self.rng.random() < self.temper.refuses
        ignored = self.rng.random() < self.temper.ignores
        is_emergency = isinstance(packet, wire.EmergencyCommand)
        positive = is_emergency or not refused
        self._outgoing.append(
            wire.encode(wire.Acknowledgment(positive=int(positive), source_pid=type(packet).PID))
        )
        if not positive or (ignored and isinstance(packet, wire.ExecuteWaypointMission)):
            return
        match packet:
            case wire.EmergencyCommand():
                self.emergencies[packet.action] += 1
                self._emergency(packet.action)
            case wire.CameraControl():
                self._images = packet.action == 1
                if self._images:
                    self.executed["camera", round(packet.target_fps_hz, 4)] += 1
            case wire.ExecuteWaypointMission():
                self.executed["mission", round(packet.waypoints[1].loiter_time_s, 6)] += 1
                self._begin_mission(packet)
            case wire.VirtualStickCommand():
                self._stick(packet, now_ns)

    def _emergency(self, action: int) -> None:
        if not self.is_flying:
            return
        self._legs.clear()
        self._velocity_mps = (0.0, 0.0)
        if action == 2:
            self._legs = [(0.0, 0.0, 10.0)]
        modes = (FlightMode.GPS_ATTI, FlightMode.AUTO_LANDING, FlightMode.GO_HOME)
        self.mode = modes[action]

    def _begin_mission(self, packet: wire.ExecuteWaypointMission) -> None:
        self.mode = FlightMode.GPS_WAYPOINT
        self._legs = [(*self._place(w), w.speed_mps) for w in packet.waypoints]

    def _place(self, waypoint: wire.Waypoint) -> tuple[float, float]:
        north_m = (waypoint.latitude_deg - self.home.latitude_deg) * METRES_PER_DEGREE
        return north_m, (waypoint.longitude_deg - self.home.longitude_deg) * METRES_PER_DEGREE

    def _stick(self, packet: wire.VirtualStickCommand, now_ns: int) -> None:
        if self.mode in (FlightMode.GPS_WAYPOINT, FlightMode.AUTO_LANDING, FlightMode.GO_HOME):
            return
        self._velocity_mps = (packet.velocity_x_mps, packet.velocity_y_mps)
        if self._velocity_mps != (0.0, 0.0):
            self.stick_times_ns.append(now_ns)
        self.mode = FlightMode.JOYSTICK
        self._stick_until_ns = now_ns + seconds_to_ns(STICK_S)

    def _fly(self, dt_s: float, now_ns: int) -> None:
        if not self.is_flying:
            if now_ns >= self._grounded_until_ns:  # the pilot takes off for the next flight
                self.is_flying, self.height_m, self.mode = (
                    True,
                    FLYING_HEIGHT_M,
                    FlightMode.GPS_ATTI,
                )
            return
        if self.mode is FlightMode.JOYSTICK and now_ns >= self._stick_until_ns:
            self._velocity_mps, self.mode = (0.0, 0.0), FlightMode.GPS_ATTI
        if self._legs:
            self._along(dt_s)
        elif self.mode is FlightMode.AUTO_LANDING:
            self._sink(dt_s, now_ns)
        self.north_m += self._velocity_mps[0] * dt_s
        self.east_m += self._velocity_mps[1] * dt_s

    def _along(self, dt_s: float) -> None:
        north_m, east_m, speed_mps = self._legs[0]
        left_north_m, left_east_m = north_m - self.north_m, east_m - self.east_m
        left_m = hypot(left_north_m, left_east_m)
        if left_m <= speed_mps * dt_s:
            self.north_m, self.east_m = north_m, east_m
            self._velocity_mps = (0.0, 0.0)
            self._legs.pop(0)
            if not self._legs:
                is_home = self.mode is FlightMode.GO_HOME
                self.mode = FlightMode.AUTO_LANDING if is_home else FlightMode.GPS_ATTI
            return
        self._velocity_mps = (speed_mps * left_north_m / left_m, speed_mps * left_east_m / left_m)

    def _sink(self, dt_s: float, now_ns: int) -> None:
        self.height_m = max(0.0, self.height_m - LANDING_MPS * dt_s)
        if self.height_m == 0.0:
            self.is_flying, self.mode = False, FlightMode.GPS_ATTI
            self._grounded_until_ns = now_ns + seconds_to_ns(GROUND_S)

    def _report(self) -> None:
        self._outgoing.append(wire.encode(self._core()))
        if self._cores % EXTENDED_EVERY == 0:
            self._outgoing.append(wire.encode(self._extended()))
            if self._images:
                self._outgoing.append(
                    wire.encode(wire.CompressedImage(target_fps_hz=1.0, jpeg=JPEG))
                )
        self._cores += 1

    def _core(self) -> wire.CoreTelemetry:
        home = self.home
        return wire.CoreTelemetry(
            is_flying=int(self.is_flying),
            latitude_deg=home.latitude_deg + self.north_m / METRES_PER_DEGREE,
            longitude_deg=home.longitude_deg + self.east_m / METRES_PER_DEGREE,
            altitude_m=home.ellipsoid_height_m + self.height_m,
            height_above_takeoff_m=self.height_m,
            velocity_north_mps=self._velocity_mps[0],
            velocity_east_mps=self._velocity_mps[1],
            velocity_down_mps=0.0,
            yaw_deg=0.0,
            pitch_deg=0.0,
            roll_deg=0.0,
        )

    def _extended(self) -> wire.ExtendedTelemetry:
        return wire.ExtendedTelemetry(
            gnss_satellite_count=18,
            gnss_signal_level=5,
            max_height_reached=0,
            max_distance_reached=0,
            battery_percent=90,
            battery_warning=0,
            wind_level=0,
            camera_state=2 if self._images else 1,
            flight_mode=int(self.mode),
            mission_id=0,
            serial=self.serial.encode(),
        )


JPEG = bytes.fromhex("ffd8ffd9")
