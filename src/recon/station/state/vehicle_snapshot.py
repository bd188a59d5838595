"""The last known state of a vehicle in flight, as stored in the recovery snapshot."""

from typing import Annotated

import msgspec

LARGEST_M = 20_000.0
LARGEST_MPS = 150.0

Latitude = Annotated[float, msgspec.Meta(ge=-90.0, le=90.0)]
Longitude = Annotated[float, msgspec.Meta(ge=-180.0, le=180.0)]
Metres = Annotated[float, msgspec.Meta(ge=-LARGEST_M, le=LARGEST_M)]
Speed = Annotated[float, msgspec.Meta(ge=-LARGEST_MPS, le=LARGEST_MPS)]
Fraction = Annotated[float, msgspec.Meta(ge=0.0, le=1.0)]


class PositionSnapshot(msgspec.Struct, frozen=True):
    """A position (WGS84)."""

    latitude_deg: Latitude
    longitude_deg: Longitude


class VehicleSnapshot(msgspec.Struct, frozen=True, kw_only=True):
    """A vehicle's last telemetry. Heights are above its takeoff point; None is unknown.

    `altitude_offset_m` is altitude minus height above takeoff. It stays constant during a flight,
    so a different offset means a different flight.
    """

    received_at_ns: int
    is_flying: bool | None
    is_simulated: bool
    position: PositionSnapshot | None
    height_above_takeoff_m: Metres | None
    velocity_north_mps: Speed | None
    velocity_east_mps: Speed | None
    velocity_down_mps: Speed | None
    battery_fraction: Fraction | None
    altitude_offset_m: Metres | None
    takeoff_point: PositionSnapshot | None
    altitude_offset_at_takeoff_m: Metres | None
