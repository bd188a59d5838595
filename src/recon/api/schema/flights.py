"""Recorded flights, for after them."""

from typing import Literal

from pydantic import Field

from recon.api.schema.message import Message

FlightFileName = Literal[
    "tracks.gpx",
    "tracks.geojson",
    "tracks.csv",
    "surveys.kml",
    "sun.tif",
    "coverage.png",
    "report.html",
]


class FlightView(Message):
    """A flight record in the station's folder."""

    name: str
    size_bytes: int
    changed_at_unix_ms: int = Field(description="when it was last written to")
    is_recording: bool = Field(description="it is this run's, and grows")


class FlightFiguresView(Message):
    """What a report states of a flight; shares are 0 to 1, null where nothing is known.

    Photos are estimated from the tracks and the survey's camera timer.
    """

    record: str
    site: str
    begin_utc: str
    end_utc: str
    vehicles: list[str]
    surveys: list[str]
    airborne_s: float
    region_m2: float | None
    photographed_share: float | None
    sunlit_share: float | None = Field(description="of the region, in sun on a photo")
    well_sunlit_share: float | None = Field(description="in sun on photos enough for a mosaic")
    mean_sun_share: float | None = Field(
        description="of the region in sun, mean over the shade maps that show any of it"
    )
    shade_maps: int
    shade_maps_of_the_region: int = Field(description="those that show any of it")
    alarms: int
    trouble: str = Field(description="why the record ends early; empty if it does not")
