"""The wire: packets of the drone interface, their bytes, and the deframer (docs/icd.md).

Raw numbers exactly as they travel; what they mean is the business of ``recon.vehicles``.
"""

from typing import TypeAlias

from recon.wire._native import (
    Acknowledgment,
    CameraControl,
    CompressedImage,
    CoreTelemetry,
    Counters,
    Deframer,
    EmergencyCommand,
    ExecuteWaypointMission,
    ExtendedTelemetry,
    Image,
    Limits,
    MessageString,
    UnknownPacket,
    VirtualStickCommand,
    Waypoint,
    checksum,
    decode,
    encode,
)
from recon.wire.errors import FieldError, HashError, ShortError, SizeError, SyncError, WireError

Packet: TypeAlias = (
    CoreTelemetry
    | ExtendedTelemetry
    | Image
    | Acknowledgment
    | MessageString
    | CompressedImage
    | VirtualStickCommand
    | ExecuteWaypointMission
    | CameraControl
    | EmergencyCommand
    | UnknownPacket
)
"""Any packet."""

__all__ = [
    "Acknowledgment",
    "CameraControl",
    "CompressedImage",
    "CoreTelemetry",
    "Counters",
    "Deframer",
    "EmergencyCommand",
    "ExecuteWaypointMission",
    "ExtendedTelemetry",
    "FieldError",
    "HashError",
    "Image",
    "Limits",
    "MessageString",
    "Packet",
    "ShortError",
    "SizeError",
    "SyncError",
    "UnknownPacket",
    "VirtualStickCommand",
    "Waypoint",
    "WireError",
    "checksum",
    "decode",
    "encode",
]
