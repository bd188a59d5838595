"""A vehicle as it was last heard, in the words of the audit."""

from typing import Annotated

import msgspec

from recon.model.authority import AuthorityHolder

Latitude = Annotated[float, msgspec.Meta(ge=-90.0, le=90.0)]
Longitude = Annotated[float, msgspec.Meta(ge=-180.0, le=180.0)]
Metres = Annotated[float, msgspec.Meta(ge=-20_000.0, le=20_000.0)]
Speed = Annotated[float, msgspec.Meta(ge=-150.0, le=150.0)]
Fraction = Annotated[float, msgspec.Meta(ge=0.0, le=1.0)]


class Place(msgspec.Struct, frozen=True):
    """A place on the ground (WGS84)."""

    latitude_deg: Latitude
    longitude_deg: Longitude


class VehicleSnapshot(msgspec.Struct, frozen=True, kw_only=True):
    """A vehicle as it was last heard. Heights are above its takeoff point; None is unknown.

    `altitude_offset_m` is altitude minus height above takeoff; it stays the same through a flight,
    and so tells one flight from the next.
    """

    heard_ns: int
    is_flying: bool | None
    is_simulated: bool
    holder: AuthorityHolder
    holder_name: str
    place: Place | None
    height_above_takeoff_m: Metres | None
    velocity_north_mps: Speed | None
    velocity_east_mps: Speed | None
    velocity_down_mps: Speed | None
    battery_fraction: Fraction | None
    altitude_offset_m: Metres | None
    home: Place | None
    altitude_offset_at_takeoff_m: Metres | None
    commanded: str
    last_command_id: int
    next_own_id: int
