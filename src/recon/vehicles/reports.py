"""Packets into reports (ICD 3.1, decisions on noisy values)."""

from collections.abc import Callable
from enum import IntEnum
from math import isfinite
from typing import Any, TypeVar

from recon import wire
from recon.model.geo import LatLon
from recon.model.report import (
    AckReport,
    AnsweredKind,
    CoreReport,
    ExtendedReport,
    IgnoredReport,
    ImageReport,
    MessageReport,
    MessageSeverity,
    Report,
)
from recon.model.vehicle import Attitude, BatteryWarning, CameraState, FlightMode, VelocityNed
from recon.vehicles.app_texts import read_app_text
from recon.vehicles.printable import printable

PLACEHOLDER_SERIAL = b"00000"
"""What apps send before they know the aircraft's serial."""

HIGHEST_M = 20_000.0
FASTEST_MPS = 150.0
"""Values beyond are treated as unknown: a good hash does not make them plausible."""

_E = TypeVar("_E", bound=IntEnum)


def to_report(packet: wire.Packet) -> Report:
    """Return the report of a packet from an app; never raises, whatever its values."""
    reader = _READERS.get(type(packet))
    if reader is None:
        return _unexpected(packet)
    return reader(packet)


def _core(packet: wire.CoreTelemetry) -> CoreReport:
    return CoreReport(
        is_flying=_flag(packet.is_flying),
        position=_position(packet.latitude_deg, packet.longitude_deg),
        reported_altitude_m=_height(packet.altitude_m),
        height_above_takeoff_m=_height(packet.height_above_takeoff_m),
        velocity_ned=_velocity(packet),
        attitude=_attitude(packet),
    )


def _extended(packet: wire.ExtendedTelemetry) -> ExtendedReport:
    return ExtendedReport(
        serial=to_serial(packet.serial),
        gnss_satellite_count=packet.gnss_satellite_count,
        gnss_signal_level=_level(packet.gnss_signal_level, 10),
        max_height_reached=_flag(packet.max_height_reached),
        max_distance_reached=_flag(packet.max_distance_reached),
        battery_fraction=packet.battery_percent / 100 if packet.battery_percent <= 100 else None,
        battery_warning=_member(BatteryWarning, packet.battery_warning),
        wind_level=_level(packet.wind_level, 127),
        camera_state=_member(CameraState, packet.camera_state),
        flight_mode=_member(FlightMode, packet.flight_mode),
        mission_id=packet.mission_id,
    )


def _image(packet: wire.Image) -> ImageReport:
    return ImageReport(target_fps_hz=_finite(packet.target_fps_hz), rgb=packet.pixels)


def _compressed(packet: wire.CompressedImage) -> ImageReport:
    return ImageReport(target_fps_hz=_finite(packet.target_fps_hz), jpeg=packet.jpeg)


def _acknowledgment(packet: wire.Acknowledgment) -> AckReport | IgnoredReport:
    answered = _member(AnsweredKind, packet.source_pid)
    if answered is None:
        return IgnoredReport(f"acknowledgment of PID {packet.source_pid}, not a command")
    return AckReport(answered=answered, positive=packet.positive == 1)


def _message(packet: wire.MessageString) -> Report:
    told = read_app_text(packet.text)
    if told is not None:
        return told
    severity = _member(MessageSeverity, packet.type)
    if severity is None:
        return IgnoredReport(f"message type must be 0 to 3; got {packet.type}")
    return MessageReport(severity=severity, text=printable(packet.text))


def _unexpected(packet: wire.Packet) -> IgnoredReport:
    if isinstance(packet, wire.UnknownPacket):
        return IgnoredReport(f"unknown PID {packet.pid}")
    return IgnoredReport(f"{type(packet).__name__} is sent to apps only")


_READERS: dict[type, Callable[[Any], Report]] = {
    wire.CoreTelemetry: _core,
    wire.ExtendedTelemetry: _extended,
    wire.Image: _image,
    wire.CompressedImage: _compressed,
    wire.Acknowledgment: _acknowledgment,
    wire.MessageString: _message,
}


def to_serial(raw: bytes) -> str | None:
    """Return a sanitised serial, or None for an empty one and the placeholder, padded or not."""
    if raw.strip(b"\0 \t\r\n") in (b"", PLACEHOLDER_SERIAL):
        return None
    return printable(raw, limit_chars=4 * 256)


def _flag(value: int) -> bool | None:
    return bool(value) if value in (0, 1) else None


def _finite(value: float) -> float | None:
    return value if isfinite(value) else None


def _level(value: int, largest: int) -> int | None:
    return value if 0 <= value <= largest else None


def _member(kind: type[_E], value: int) -> _E | None:
    try:
        return kind(value)
    except ValueError:
        return None


def _position(latitude_deg: float, longitude_deg: float) -> LatLon | None:
    point = LatLon(latitude_deg, longitude_deg)
    is_placeholder = latitude_deg == 0.0 and longitude_deg == 0.0
    return point if point.is_valid() and not is_placeholder else None


def _height(value: float) -> float | None:
    return value if abs(value) <= HIGHEST_M else None


def _velocity(packet: wire.CoreTelemetry) -> VelocityNed | None:
    values = (packet.velocity_north_mps, packet.velocity_east_mps, packet.velocity_down_mps)
    return VelocityNed(*values) if all(abs(v) <= FASTEST_MPS for v in values) else None


def _attitude(packet: wire.CoreTelemetry) -> Attitude | None:
    values = (packet.yaw_deg, packet.pitch_deg, packet.roll_deg)
    return Attitude(*values) if all(map(isfinite, values)) else None
