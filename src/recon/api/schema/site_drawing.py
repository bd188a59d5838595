"""The site's layers, vehicles and cameras: read, changed and saved."""

from typing import Annotated, Literal

from pydantic import Field

from recon.api.schema.message import ActionResponse, Message, StrictMessage
from recon.model.airspace import SiteLayer

Position = Annotated[list[float], Field(min_length=2, max_length=3)]
Ring = Annotated[list[Position], Field(max_length=10_000)]

Attribute = Annotated[str, Field(max_length=1_000)] | int | float | bool | None


class DrawnGeometry(StrictMessage):
    """GeoJSON: a polygon with its holes, or a point. Longitude first, degrees of WGS84."""

    type: Literal["Polygon", "Point"]
    coordinates: list[Ring] | Position


class DrawnFeatureView(StrictMessage):
    """A feature of a layer; its attributes are those of the layer's file."""

    layer: Annotated[SiteLayer, Field(strict=False)]
    geometry: DrawnGeometry
    properties: dict[Annotated[str, Field(max_length=100)], Attribute] = Field(
        default={}, max_length=40
    )


class SavedChangeView(Message):
    """A change of the site that can be undone."""

    what: str
    by: str
    utc: str


class SiteFolderView(Message):
    """What can be saved in the site's folder."""

    revision: str = Field(description="to be sent with a change: it is refused after another one")
    locked_reason: str | None = Field(description="why nothing can be saved here; null: it can")
    undo: SavedChangeView | None


class SiteDrawingView(SiteFolderView):
    """The layers as they are in the site's folder, unsimplified."""

    features: list[DrawnFeatureView]


class SiteChangeRequest(StrictMessage):
    """A change of what was read with this revision."""

    revision: Annotated[str, Field(max_length=64)]


class SiteUndoRequest(SiteChangeRequest):
    """Takes back the newest change of the site."""


class SiteDrawingRequest(SiteChangeRequest):
    """All layers as they are to be: what is missing is removed."""

    features: list[DrawnFeatureView] = Field(max_length=2_000)


class SiteDrawingResponse(ActionResponse):
    """Whether a drawing was accepted, or why not; the layers after it."""

    feature: int | None = Field(description="the refused one's index in the request, if it is one")
    layers: list[SiteLayer] = Field(description="those that change")
    also: list[Literal["vehicles", "calibration"]] = Field(
        description="what an undo has changed beside layers"
    )
    drawing: SiteDrawingView | None


class SiteVehicleView(StrictMessage):
    """A vehicle of the site, as a row of a table. Wrong values are refused with a sentence."""

    serial: Annotated[str, Field(max_length=300)]
    name: Annotated[str, Field(max_length=300)] | None = Field(
        default=None, description="null: the serial"
    )
    number: int | None = Field(
        default=None, description="its key, colour and shape; null: the station gives it one"
    )
    camera: Annotated[str, Field(max_length=100)] | None = Field(
        default=None, description="a survey camera of `/api/cameras`"
    )
    waypoint_altitude: Literal["wgs84", "takeoff"] | None = Field(
        default=None, description="the app's altitude reference; null: missions are refused"
    )


class SiteVehiclesView(SiteFolderView):
    """The vehicles in the site's folder, connected or not."""

    vehicles: list[SiteVehicleView]


class SiteVehiclesRequest(SiteChangeRequest):
    """All vehicles as they are to be: what is missing is removed."""

    vehicles: list[SiteVehicleView] = Field(max_length=200)


class SiteVehiclesResponse(ActionResponse):
    """Whether the vehicles were accepted, or why not; the vehicles after it."""

    row: int | None = Field(description="the refused one's index in the request, if it is one")
    changes: list[str] = Field(description="one sentence for each vehicle that changes")
    vehicles: SiteVehiclesView | None


class ControlPointView(StrictMessage):
    """A control point on the globe, and where it is in the frame; a surveyed one has no pixel."""

    name: Annotated[str, Field(max_length=100)]
    latitude_deg: float
    longitude_deg: float
    altitude_m: float | None = Field(
        default=None, description="above the WGS84 ellipsoid; null: on the site's ground"
    )
    col_px: float | None = Field(default=None, description="from 0 at the first pixel's centre")
    row_px: float | None = None


class FrozenFrameRequest(StrictMessage):
    """The imaging drone whose newest frame is kept for marking."""

    serial: Annotated[str, Field(max_length=300)]


class FrozenFrameView(Message):
    """A kept frame of an imaging drone, or why none can be kept."""

    accepted: bool
    reason: str | None
    frame_id: int | None
    cols: int
    rows: int
    latitude_deg: float | None = Field(description="the aircraft's, when the frame was taken")
    longitude_deg: float | None
    surveyed: list[ControlPointView] = Field(description="of the site's file, without pixels")


class CalibrationRequest(StrictMessage):
    """Control points marked on a kept frame."""

    serial: Annotated[str, Field(max_length=300)]
    frame_id: int
    points: list[ControlPointView] = Field(max_length=200)


class PointResidualView(Message):
    """Observed minus predicted, in pixels of the frame and on the ground."""

    name: str
    col_px: float
    row_px: float
    ground_m: float | None


class CalibrationView(ActionResponse):
    """The camera's pose by the points, or why they give no pose."""

    rms_px: float | None = Field(description="of the frame's pixels")
    residuals: list[PointResidualView]
    height_above_ground_m: float | None
    tilt_deg: float | None = Field(description="of the camera's axis from straight down")


class ImportedFeatureView(Message):
    """A feature of an imported file, not in the site yet."""

    name: str
    geometry: DrawnGeometry
    layer: SiteLayer | None = Field(description="what it is by its file, if that says so")
    properties: dict[str, str | float] = Field(description="of that layer: heights, datum, notes")


class ImportedView(Message):
    """Polygons and points of an imported file, in WGS84, or why it was refused."""

    features: list[ImportedFeatureView]
    excluded: list[str] = Field(description="each shape that is left out, with the reason")
    warnings: list[str] = Field(description="what was changed, and how accurate places are")
    is_fit_for_fences: bool = Field(
        description="false where nobody knows how far from their true place the shapes are"
    )
    has_open_paths: bool = Field(description="whether `close_paths` would take more of it")
    reason: str | None
