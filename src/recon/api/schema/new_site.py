"""Messages of the page that makes a site."""

from typing import Annotated

from pydantic import Field

from recon.api.schema.message import ActionResponse, Message, StrictMessage
from recon.api.schema.site_drawing import DrawnFeatureView, DrawnGeometry


class NewSiteView(Message):
    """The folder that the site is to be made in."""

    folder: str
    name: str = Field(description="proposed: the folder's")


class NewRegion(StrictMessage):
    """A field to survey."""

    name: Annotated[str, Field(max_length=300)]
    geometry: DrawnGeometry


class NewSiteRequest(StrictMessage):
    """A site to be made; wrong values are refused with a sentence."""

    name: Annotated[str, Field(max_length=300)]
    latitude_deg: float = Field(description="of the middle of the field, the site's origin")
    longitude_deg: float
    ground_above_sea_level_m: float = Field(description="at that place, as maps have it")
    simulated_drones: int
    regions: list[NewRegion] = Field(
        default=[], max_length=200, description="none: a square of 4 ha around the place"
    )
    margin_m: float = Field(default=30.0, description="from the fields to the boundary")
    cloud_cover_percent: float = Field(default=40.0, description="of the rehearsal's sky")
    wind_mps: float = Field(default=3.5, description="10 m above the ground")
    wind_from_deg: float = Field(default=250.0, description="clockwise from north")


class NewSiteShapes(ActionResponse):
    """What a request's layers would be, or why there is no such site."""

    features: list[DrawnFeatureView]
