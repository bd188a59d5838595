"""Messages of the page that makes a site."""

from typing import Annotated

from pydantic import Field

from recon.api.schema.message import Message, StrictMessage


class NewSiteView(Message):
    """The folder that the site is to be made in."""

    folder: str
    name: str = Field(description="proposed: the folder's")


class NewSiteRequest(StrictMessage):
    """A site to be made; wrong values are refused with a sentence."""

    name: Annotated[str, Field(max_length=300)]
    latitude_deg: float
    longitude_deg: float
    ground_above_sea_level_m: float = Field(description="at that place, as maps have it")
    simulated_drones: int
