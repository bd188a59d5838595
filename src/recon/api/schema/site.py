"""The site, ground images, shade and the forecast of sun."""

from typing import Literal

from pydantic import Field

from recon.api.schema.message import Message


class GroundImageView(Message):
    """The newest ground image; corners are (longitude, latitude) NW, NE, SE, SW.

    Of several imaging drones their newest images, the newest on top: as old as the oldest of them.
    """

    frame_id: int = Field(description="of the newest frame in it")
    serials: list[str]
    captured_age_s: float
    captured_sigma_s: float
    registration: Literal["unregistered", "registered", "lost"]
    registration_residual_m: float | None = Field(
        description="median distance of features from their places in the reference frame, on the "
        "ground; null unless registered"
    )
    exposure_locked: bool = Field(
        description="by the site: the pilot locks exposure and white balance before takeoff"
    )
    reference: str = Field(description="the telemetry used for the marked frame")
    corners: list[tuple[float, float]]
    cell_m: float
    rows: int
    cols: int


class LimitsView(Message):
    """The site's limits for every vehicle."""

    max_height_above_ground_m: float
    min_height_above_ground_m: float
    max_distance_from_home_m: float
    max_speed_mps: float
    min_separation_horizontal_m: float
    min_separation_vertical_m: float
    boundary_margin_m: float
    battery_reserve_fraction: float


class LayerView(Message):
    """A layer of the site, and its file in the site's folder."""

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
    """A landing pad; `serial` is null for one that any vehicle may use."""

    name: str
    serial: str | None
    longitude_deg: float
    latitude_deg: float
    altitude_m: float = Field(description="above the WGS84 ellipsoid")


class SiteView(Message):
    """The site: position, limits, areas, pads, quality of the imaging drone's marked pose."""

    name: str
    latitude_deg: float | None
    longitude_deg: float | None
    ground_altitude_m: float | None
    imager_serials: list[str]
    pose_rms_px: float | None
    pose_height_m: float | None
    limits: LimitsView
    terrain: Literal["model", "flat assumed"]
    layers: list[LayerView]
    areas: list[AreaView]
    areas_excluded: int = Field(description="number of areas beyond the limit, not sent")
    areas_drawn_within_m: float = Field(
        description="largest error of the simplified outlines; 0 when not simplified"
    )
    pads: list[PadView]
    outside_planners: list[str] = Field(
        default=[], description="planners of surveys that installed packages offer, by name"
    )


class LightSharesView(Message):
    """Shares of the ground in view; they add up to 1."""

    sun: float
    shade: float
    unknown: float = Field(description="seen, but neither sun nor shade is known there")


class ShadeMapView(Message):
    """The newest shade map; corners are (longitude, latitude) NW, NE, SE, SW."""

    number: int = Field(description="counts the shade maps of this run")
    captured_age_s: float
    known_share: float = Field(description="of all cells: those with a known value")
    sunlit_share: float | None = Field(description="of the known cells")
    in_view: LightSharesView | None = Field(description="null: the frame shows none of the cells")
    mean_confidence: float | None = Field(description="of the known cells")
    corners: list[tuple[float, float]]
    cell_m: float
    rows: int
    cols: int


class HindcastView(Message):
    """Earlier forecasts of one lead, compared with the maps of their time."""

    lead_s: float
    right_share: float = Field(description="of the cells known then and later: called rightly")


class ForecastView(Message):
    """The newest forecast; leads count from the capture of its shade map."""

    number: int = Field(description="number of its shade map")
    issued_age_s: float
    method: str = Field(
        description="the method that made it: the fallback if the chosen one failed"
    )
    lead_s: list[float]
    predicted_share: list[float] = Field(
        description="of all cells, by lead: those predicted from observations"
    )
    sun_share: list[float] = Field(description="expected share of all cells in sun, by lead")
    right: list[HindcastView] = Field(
        description="how often earlier forecasts of this flight were right; leads compared so far"
    )
    prior_sunlit: float = Field(description="probability used where no prediction is available")
    shadows_east_mps: float | None
    shadows_north_mps: float | None
    corners: list[tuple[float, float]]
    cell_m: float
    rows: int
    cols: int


class SunAtView(Message):
    """The light at a place now, and when it changes next; times count from now."""

    number: int = Field(description="number of the shade map")
    light: Literal["sun", "shade", "unknown"]
    known_ahead_s: float = Field(
        description="how far ahead clouds over this place are seen coming; 0: no more than now"
    )
    change_chance: float = Field(description="of a change of light within `known_ahead_s`")
    change_after_s: float | None = Field(
        description="median time until the light changes; null where no change is predicted"
    )
    change_early_s: float | None = Field(description="exceeded in nine of ten cases")
    change_late_s: float | None = Field(description="not exceeded in nine of ten cases")


class SeenFromView(Message):
    """What an imaging drone sees of the shade over a region, from a place."""

    now: float = Field(description="share of the region in view, 0 to 1")
    in_30_s: float = Field(description="share whose shade in so many seconds is in view now")
    in_60_s: float
    in_90_s: float


class UpwindPlaceView(Message):
    """Where an imaging drone sees most of the shade that comes over a region."""

    serial: str
    latitude_deg: float
    longitude_deg: float
    height_above_takeoff_m: float
    yaw_deg: float
    speed_mps: float
    distance_m: float = Field(description="from where it is; 0: it hovers well there")
    takes_s: float
    here: SeenFromView
    there: SeenFromView
    sentence: str = Field(description="what it sees and costs; the drone's name goes before it")


class UpwindView(Message):
    """A place upwind, or why none is known: both are usual answers."""

    place: UpwindPlaceView | None
    reason: str = Field(description="why no place is known; empty with one")


class ShadeLineView(Message):
    """State of shade detection and sun forecast from the imaging drone's frames."""

    detection: str = Field(description="the method that detects shade")
    forecaster: str = Field(description="the method that forecasts sun")
    frames_rejected: int
    frames_dropped: int = Field(description="ground images dropped because the worker was busy")
    rejected: str | None = Field(
        description="why the newest frame was rejected; null if it was not"
    )
    error: str | None
    reference: str = Field(
        description="which earlier flight's knowledge of the land is used, or why none is; empty "
        "if there was none"
    )
    lock_problem: str = Field(
        description="what shows that a camera stated to be locked is not; empty if nothing does"
    )
    map: ShadeMapView | None
    forecast: ForecastView | None
