"""[limits] of site.toml: what every vehicle is held to, each key optional."""

from typing import Annotated

import msgspec
from msgspec import Meta, Struct

from recon.model.airspace import FlightLimits
from recon.site.errors import SiteError


class LimitsTable(Struct, frozen=True, forbid_unknown_fields=True):
    """[limits]: absent keys keep the defaults of `FlightLimits`, whose reasons stand there."""

    max_height_above_ground_m: Annotated[float, Meta(ge=20.0, le=500.0)] | None = None
    """DJI's own bounds of the height an aircraft can be limited to."""
    min_height_above_ground_m: Annotated[float, Meta(ge=0.0, le=100.0)] | None = None
    max_distance_from_home_m: Annotated[float, Meta(ge=15.0, le=8_000.0)] | None = None
    """DJI's own bounds of the radius."""
    max_speed_mps: Annotated[float, Meta(ge=1.0, le=15.0)] | None = None
    min_separation_horizontal_m: Annotated[float, Meta(ge=5.0, le=200.0)] | None = None
    """Two GNSS positions may be off by 5 m together: less keeps nothing apart."""
    min_separation_vertical_m: Annotated[float, Meta(ge=2.0, le=100.0)] | None = None
    """The barometers of two aircraft just started agree to a metre or two."""
    boundary_margin_m: Annotated[float, Meta(ge=0.0, le=100.0)] | None = None
    battery_reserve_fraction: Annotated[float, Meta(ge=0.1, le=0.9)] | None = None
    """Aircraft land where they are at about a tenth."""


def limits_from_table(table: LimitsTable, place: str) -> FlightLimits:
    """Return the limits; `place` leads the message of the `SiteError` for two that contradict."""
    given = {
        key: value for key, value in msgspec.structs.asdict(table).items() if value is not None
    }
    limits = FlightLimits(**given)
    low_m, high_m = limits.min_height_above_ground_m, limits.max_height_above_ground_m
    if low_m >= high_m:
        raise SiteError(
            f"{place}.min_height_above_ground_m: expected less than max_height_above_ground_m, "
            f"{high_m:g} m, got {low_m:g} m"
        )
    return limits
