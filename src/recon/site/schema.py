"""The tables of site.toml: one struct each, unknown keys refused.

The how-to docs/how-to/prepare-a-site.md explains each key; ranges are checked here,
relations between keys in `recon.site.load`.
"""

from typing import Annotated, Any, Literal

from msgspec import Meta, Struct

Latitude = Annotated[float, Meta(ge=-90.0, le=90.0)]
Longitude = Annotated[float, Meta(ge=-180.0, le=180.0)]
Altitude = Annotated[float, Meta(ge=-1_000.0, le=10_000.0)]
Serial = Annotated[
    str,
    Meta(
        min_length=1,
        max_length=256,
        pattern=r"^[!-~]+$",
        description="a text of 1 to 256 printable ASCII characters without spaces",
    ),
]
"""Serial number, as DJI's; the wire's limit is 256 bytes."""
Text = Annotated[
    str,
    Meta(
        min_length=1,
        max_length=64,
        pattern=r"^[^\x00-\x1f\x7f-\x9f]*$",
        description="a text of 1 to 64 characters without control characters",
    ),
]
FileName = Annotated[
    str,
    Meta(
        min_length=1,
        max_length=200,
        pattern=r"^[^\x00-\x1f\x7f-\x9f]*$",
        description="a file's name of 1 to 200 characters without control characters",
    ),
]
Seconds = Annotated[float, Meta(ge=0.0, le=10.0)]
Pixels = Annotated[int, Meta(ge=2, le=16_384)]


class _Table(Struct, frozen=True, forbid_unknown_fields=True):
    pass


class OriginTable(_Table, frozen=True):
    """[origin]: where the local frame touches the ellipsoid, at the ground's height."""

    latitude_deg: Latitude
    longitude_deg: Longitude
    ground_altitude_m: Altitude


class MarkedFrameTable(_Table, frozen=True):
    """[imager.marked_frame]: telemetry when the frame with the control points was taken."""

    latitude_deg: Latitude
    longitude_deg: Longitude
    height_above_takeoff_m: Annotated[float, Meta(gt=0.0, le=1_000.0)]
    yaw_deg: Annotated[float, Meta(ge=-360.0, le=360.0)]
    pitch_deg: Annotated[float, Meta(ge=-90.0, le=90.0)] = 0.0
    roll_deg: Annotated[float, Meta(ge=-180.0, le=180.0)] = 0.0


class ImageCircleTable(_Table, frozen=True):
    """[imager.image_circle]: the lens's lit circle, in pixels at the camera file's size."""

    col_px: Annotated[float, Meta(ge=0.0, le=16_384.0)]
    row_px: Annotated[float, Meta(ge=0.0, le=16_384.0)]
    radius_px: Annotated[float, Meta(gt=0.0, le=16_384.0)]


class ImagerTable(_Table, frozen=True):
    """[imager], or each of [[imager]]: an imaging drone, its lens, its control points if any."""

    serial: Serial
    placed_by: Literal["control_points", "telemetry"] = "control_points"
    tilt_deg: Annotated[float, Meta(ge=0.0, le=60.0)] | None = None
    """Angle from straight down to the camera's axis, towards the aircraft's front."""
    control_points_image_size_px: tuple[Pixels, Pixels] | None = None
    camera: FileName = "camera-model.txt"
    control_points: FileName | None = None
    marked_frame: MarkedFrameTable | None = None
    image_circle: ImageCircleTable | None = None
    exposure: Literal["auto", "locked"] = "auto"


class GroundImageTable(_Table, frozen=True):
    """[ground_image]: the raster frames are projected on, centred on the origin."""

    width_m: Annotated[float, Meta(gt=0.0, le=20_000.0)] = 512.0
    height_m: Annotated[float, Meta(gt=0.0, le=20_000.0)] = 512.0
    cell_m: Annotated[float, Meta(ge=0.01, le=100.0)] = 1.0


class RehearsalTable(_Table, frozen=True):
    """[rehearsal]: the sky and the wind that `recon demo --site` simulates over the site."""

    cloud_cover_percent: Annotated[float, Meta(ge=0.0, le=100.0)] = 40.0
    """Fair-weather cumulus, as in the demonstration."""
    wind_mps: Annotated[float, Meta(ge=0.0, le=15.0)] = 3.5
    """Ten metres above the ground."""
    wind_from_deg: Annotated[float, Meta(ge=0.0, le=360.0)] = 250.0
    """Where it comes from, clockwise from north."""


class PadTable(_Table, frozen=True):
    """pad: where a vehicle takes off and lands."""

    latitude_deg: Latitude
    longitude_deg: Longitude
    altitude_m: Altitude


class VehicleTable(_Table, frozen=True):
    """One of [[vehicles]]: a vehicle's properties and limits. Absent keys keep the default."""

    serial: Serial
    name: Text | None = None
    number: Annotated[int, Meta(ge=1, le=9_999)] | None = None
    """None: the station gives it one, kept in numbers.toml."""
    model: Text | None = None
    camera: Annotated[str, Meta(max_length=40)] | None = None
    """The name of a survey camera."""
    waypoint_altitude: Literal["wgs84", "takeoff"] | None = None
    mount: Literal["gimbal", "fixed"] | None = None
    pad: PadTable | None = None
    app: Literal["legacy"] | None = None
    max_waypoints: Annotated[int, Meta(ge=0, le=99)] | None = None
    battery_factor: Annotated[float, Meta(ge=0.1, le=10.0)] | None = None
    endurance_min: Annotated[float, Meta(ge=1.0, le=240.0)] | None = None
    go_home_height_m: Annotated[float, Meta(ge=20.0, le=500.0)] | None = None
    """The range is DJI's."""
    failsafe: Literal["go_home", "hover", "land"] | None = None
    camera_interval_s: Annotated[float, Meta(ge=0.5, le=60.0)] | None = None
    priority: Annotated[int, Meta(ge=0, le=100)] | None = None
    video_latency_s: Seconds | None = None
    video_latency_sigma_s: Seconds | None = None
    packet_gap_s: Seconds | None = None


class LayersTable(_Table, frozen=True):
    """[layers]: GeoJSON files in the folder, each optional."""

    boundary: FileName | None = None
    keep_out: FileName | None = None
    height_zones: FileName | None = None
    landing_pads: FileName | None = None
    survey_regions: FileName | None = None


class LimitsTable(_Table, frozen=True):
    """[limits]: absent keys keep the defaults of `FlightLimits`, whose reasons are there."""

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


ReactionName = Literal["nothing", "alarm", "hold", "return", "land"]


class ReactionTable(_Table, frozen=True):
    """A cell of [failsafe.CONDITION] with a delay: { do = "hold", after_s = 5 }."""

    do: ReactionName
    after_s: Annotated[float, Meta(ge=0.0, le=600.0)] | None = None
    """An aircraft of this size flies half an hour: ten minutes later is too late for anything."""


class FailsafeRowTable(_Table, frozen=True):
    """[failsafe.CONDITION]: a reaction by what the vehicle does; absent keys keep the default.

    Each cell is a reaction's name or a `ReactionTable`.
    """

    mission: Any = None
    steered: Any = None
    holding: Any = None
    returning: Any = None


class FailsafeTable(_Table, frozen=True):
    """[failsafe]: the rows that differ from the default."""

    link_lost: dict[str, Any] = {}
    telemetry_lost: dict[str, Any] = {}
    gnss_lost: dict[str, Any] = {}
    battery_low: dict[str, Any] = {}
    battery_critical: dict[str, Any] = {}
    wind: dict[str, Any] = {}
    attitude: dict[str, Any] = {}
    geofence: dict[str, Any] = {}
    separation: dict[str, Any] = {}
    imaging_drone_lost: dict[str, Any] = {}
    station_overloaded: dict[str, Any] = {}
    operator_gone: dict[str, Any] = {}


class TileServerTable(_Table, frozen=True):
    """[tile_server]: where `recon maps fetch` gets tiles from; a station asks no server."""

    url: Annotated[str, Meta(min_length=1, max_length=500)]
    attribution: Annotated[str, Meta(max_length=200)] = ""


class FetchTable(_Table, frozen=True):
    """[fetch]: where `recon site fetch` gets heights and weather from; a station asks nobody."""

    elevation: Annotated[str, Meta(min_length=1, max_length=1_000)] | None = None
    elevation_datum: Literal["wgs84", "geoid"] | None = None
    weather: Annotated[str, Meta(min_length=1, max_length=2_000)] | None = None


class SiteTable(_Table, frozen=True):
    """The whole file. The tables are converted one by one, so that an error names its table."""

    name: Text
    origin: dict[str, Any]
    limits: dict[str, Any] = {}
    imager: dict[str, Any] | list[dict[str, Any]] | None = None
    ground_image: dict[str, Any] | None = None
    layers: dict[str, Any] = {}
    elevation: dict[str, Any] | None = None
    failsafe: dict[str, Any] = {}
    tile_server: dict[str, Any] | None = None
    fetch: dict[str, Any] = {}
    rehearsal: dict[str, Any] = {}
    vehicles: list[dict[str, Any]] = []
