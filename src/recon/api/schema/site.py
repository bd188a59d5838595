"""What the station tells of the site."""

from typing import Literal

from pydantic import Field

from recon.api.schema.message import Message


class GroundImageView(Message):
    """The newest frame laid on the ground; corners are (longitude, latitude) NW, NE, SE, SW."""

    frame_id: int
    serial: str
    captured_age_s: float
    captured_sigma_s: float
    registration: Literal["unregistered"]
    reference: str = Field(description="which telemetry stands for the marked frame")
    corners: list[tuple[float, float]]
    cell_m: float
    rows: int
    cols: int


class LimitsView(Message):
    """What the site allows every vehicle."""

    max_height_above_ground_m: float
    min_height_above_ground_m: float
    max_distance_from_home_m: float
    max_speed_mps: float
    min_separation_horizontal_m: float
    min_separation_vertical_m: float
    boundary_margin_m: float
    battery_reserve_fraction: float


class LayerView(Message):
    """A layer of the site, and the file in its folder that tells it."""

    name: str
    file: str


class AreaView(Message):
    """An outline to draw: closed rings of (longitude, latitude), the outer one first."""

    kind: Literal["boundary", "keep_out", "height", "survey"]
    name: str
    rings: list[list[tuple[float, float]]]
    floor_m: float | None
    ceiling_m: float | None
    datum: Literal["ground", "wgs84"] | None


class PadView(Message):
    """A place to land; `serial` is null for one that any vehicle may use."""

    name: str
    serial: str | None
    longitude_deg: float
    latitude_deg: float
    altitude_m: float = Field(description="above the WGS84 ellipsoid")


class SiteView(Message):
    """The site: its place, what holds in its air, and the quality of the eye's marked pose."""

    name: str
    latitude_deg: float | None
    longitude_deg: float | None
    ground_altitude_m: float | None
    imager_serial: str | None
    pose_rms_px: float | None
    pose_height_m: float | None
    limits: LimitsView
    terrain: Literal["model", "flat assumed"]
    layers: list[LayerView]
    areas: list[AreaView]
    areas_left_out: int = Field(description="how many areas are too many to be drawn")
    areas_drawn_within_m: float = Field(
        description="how far the outlines may be off; 0 when every corner is there"
    )
    pads: list[PadView]
