"""Temporary zones: drawn and ended by a person while vehicles fly."""

from typing import Annotated, Literal, Self

from pydantic import Field, model_validator

from recon.api.schema.message import ActionResponse, Message, StrictMessage

ZoneKindName = Literal["person", "tractor", "crewed_aircraft"]


class PlaceRequest(StrictMessage):
    """A place on the ground, in WGS84."""

    latitude_deg: float
    longitude_deg: float


class CircleRequest(PlaceRequest):
    """A circle on the ground."""

    radius_m: float


class TemporaryZoneRequest(StrictMessage):
    """A temporary zone to draw: a circle or an outline.

    Everything is kept out of it at once; what cannot be drawn is refused with a sentence.
    """

    kind: ZoneKindName
    circle: CircleRequest | None = None
    outline: Annotated[list[PlaceRequest], Field(max_length=1_000)] | None = Field(
        default=None, description="corners; the last one is joined to the first"
    )
    floor_m: float | None = Field(default=None, description="above ground; null: from the ground")
    ceiling_m: float | None = Field(
        default=None,
        description=(
            "above ground; null: 30 m for a person or a tractor, all heights for a crewed aircraft"
        ),
    )
    reason: str = Field(max_length=2048, description="for those who see the alarm")
    lasts_s: float | None = Field(default=None, description="null: until a person ends it")

    @model_validator(mode="after")
    def _has_one_shape(self) -> Self:
        if (self.circle is None) is (self.outline is None):
            raise ValueError("expected a circle or an outline, and not both")
        return self


class TemporaryZoneView(Message):
    """A temporary zone in force."""

    id: int
    name: str
    kind: ZoneKindName
    ring: list[tuple[float, float]] = Field(description="the closed outline, (longitude, latitude)")
    radius_m: float | None = Field(description="of a circle; null for an outline")
    floor_m: float | None
    ceiling_m: float | None = Field(description="above ground, as the floor; null: all heights")
    reason: str
    by: str
    age_s: float
    ends_in_s: float | None = Field(description="null: until a person ends it")


class TemporaryZoneResponse(ActionResponse):
    """The zone as it was drawn, or why it was not."""

    zone: TemporaryZoneView | None
