"""The photos of a flight: their tags, mosaic and gaps, made by one job at a time."""

from typing import Annotated, Literal

from pydantic import Field

from recon.api.schema.message import Message, StrictMessage

PhotoStepName = Literal["clock", "tags", "gaps", "mosaic", "report"]
PhotoFileName = Literal["mosaic.png", "report.html", "tags.csv", "fly-again.geojson"]
FolderPath = Annotated[str, Field(min_length=1, max_length=1000)]


class PhotoRequest(StrictMessage):
    """Photos to tag by a flight's record. Nothing flies, and the folders are only read."""

    flight: Annotated[str, Field(pattern=r"^[A-Za-z0-9][A-Za-z0-9._-]{0,99}$")] = Field(
        description="of `/api/flights`"
    )
    folders: Annotated[list[FolderPath], Field(min_length=1, max_length=16)] = Field(
        description="whole paths of folders on the station's computer, as of cards"
    )
    clock_offset_s: Annotated[float, Field(ge=-1e9, le=1e9)] | None = Field(
        default=None, description="to add to the camera's clock for UTC; null: estimated"
    )
    field_deg: Annotated[float, Field(ge=10.0, le=120.0)] | None = Field(
        default=None, description="camera's field along the longer side; null: as the photos state"
    )


class CameraClockView(Message):
    """A camera's clock, as found on one vehicle's track."""

    camera: str
    vehicle: str
    photos: int
    offset_s: float = Field(description="to add to the camera's clock for UTC")
    sigma_s: float = Field(description="standard deviation")
    distance_m: float = Field(description="median distance of the photos from the track")
    is_stated: bool
    is_reported: bool = Field(description="each photo was reported by its app")


class PhotoCountsView(Message):
    """How many photos were tagged, by their light."""

    photos: int
    sunlit: int
    mixed: int
    shaded: int
    unknown: int


class PhotoGapsView(Message):
    """Ground that too few photos show in sun."""

    area_m2: float
    regions: int


class PhotoMosaicView(Message):
    """A mosaic's area, by the light in which its ground was photographed."""

    resolution_m: float
    sun_m2: float
    shade_m2: float
    unknown_m2: float
    missing_m2: float = Field(description="on no photo")


class PhotoStepView(Message):
    """One step of the work; the results of steps before a failed one stay."""

    name: PhotoStepName
    state: Literal["waiting", "running", "done", "failed"]
    problem: str = Field(description="why it failed, and what to do; empty if it has not")


class PhotoJobView(Message):
    """The work on a flight's photos: running, or the last that was."""

    flight: str
    folders: list[str]
    out: str = Field(description="folder of the results, on the station's computer")
    state: Literal["running", "done", "failed", "cancelled"]
    steps: list[PhotoStepView]
    doing: str = Field(description="what is counted by `share`")
    share: float | None = Field(description="of what is being done, 0 to 1")
    clocks: list[CameraClockView]
    counts: PhotoCountsView | None
    gaps: PhotoGapsView | None
    mosaic: PhotoMosaicView | None
    files: list[PhotoFileName]
    warnings: list[str]


class PhotosView(Message):
    """The one job on photos."""

    job: PhotoJobView | None = Field(description="null: none was started")
