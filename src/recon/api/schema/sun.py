"""What the station tells of shade on the ground, and of what is foreseen of it."""

from pydantic import Field

from recon.api.schema.message import Message


class ShadeMapView(Message):
    """The newest shade map; corners are (longitude, latitude) NW, NE, SE, SW."""

    number: int = Field(description="counts the shade maps of this run")
    captured_age_s: float
    known_share: float = Field(description="of all cells: those of which anything is known")
    sunlit_share: float | None = Field(description="of the known cells")
    mean_confidence: float | None = Field(description="of the known cells")
    corners: list[tuple[float, float]]
    cell_m: float
    rows: int
    cols: int


class ForecastView(Message):
    """The newest forecast; leads count from the moment its shade map was taken."""

    number: int = Field(description="that of the shade map it is made from")
    issued_age_s: float
    method: str = Field(description="what made it: the fallback, where the chosen one fell back")
    lead_s: list[float]
    predicted_share: list[float] = Field(
        description="of all cells, by lead: those foreseen from something seen"
    )
    prior_sunlit: float = Field(description="what is said where nothing better is known")
    shadows_east_mps: float | None
    shadows_north_mps: float | None
    corners: list[tuple[float, float]]
    cell_m: float
    rows: int
    cols: int


class ShadeLineView(Message):
    """How the line from the eye's frames to shade maps and forecasts stands."""

    detection: str = Field(description="the method that reads shade")
    forecaster: str = Field(description="the method that foresees sun")
    frames_rejected: int
    frames_dropped: int = Field(description="ground images that were never read: no time")
    rejected: str | None = Field(description="why the newest frame was not read, if it was not")
    error: str | None
    map: ShadeMapView | None
    forecast: ForecastView | None
