"""The wire: packets of the drone interface, their bytes, and the deframer (docs/icd.md).

Raw numbers exactly as they travel; what they mean is the business of ``recon.vehicles``.
"""

from typing import TypeAlias

from recon.wire import _native
from recon.wire._native import *
from recon.wire.errors import *

Packet: TypeAlias = (
    _native.CoreTelemetry
    | _native.ExtendedTelemetry
    | _native.Image
    | _native.Acknowledgment
    | _native.MessageString
    | _native.CompressedImage
    | _native.VirtualStickCommand
    | _native.ExecuteWaypointMission
    | _native.CameraControl
    | _native.EmergencyCommand
    | _native.UnknownPacket
)
"""Any packet."""
