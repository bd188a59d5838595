"""Requests for orders, authority and preflight overrides."""

from typing import Annotated, Literal, Self

from pydantic import Field, model_validator

from recon.api.schema.message import GivenRequest, StrictMessage
from recon.api.schema.vehicles import HolderName
from recon.model.command import (
    STEERED_BODIES,
    TAKEOFF_BODIES,
    FlyMission,
    GoTo,
    HoldPosition,
    Hover,
    LandNow,
    LockCamera,
    Nudge,
    ReturnHome,
    StartCamera,
    StickFrame,
    StopCamera,
    VirtualStick,
)
from recon.model.geo import LatLon
from recon.model.mission import Mission, Waypoint

STEERED_KINDS = frozenset(kind.name for kind in STEERED_BODIES)
TAKEOFF_KINDS = frozenset(kind.name for kind in TAKEOFF_BODIES)


class HoverOrder(StrictMessage):
    """Stop and hold."""

    kind: Literal["hover"]

    def body(self) -> Hover:
        """Return what is ordered."""
        return Hover()


class LandOrder(StrictMessage):
    """Land where the vehicle is."""

    kind: Literal["land"]

    def body(self) -> LandNow:
        """Return what is ordered."""
        return LandNow()


class ReturnHomeOrder(StrictMessage):
    """Return at the aircraft's own go-home height and land."""

    kind: Literal["return_home"]

    def body(self) -> ReturnHome:
        """Return what is ordered."""
        return ReturnHome()


class CameraStartOrder(StrictMessage):
    """Send images."""

    kind: Literal["camera_start"]
    fps_hz: float

    def body(self) -> StartCamera:
        """Return what is ordered."""
        return StartCamera(fps_hz=self.fps_hz)


class CameraStopOrder(StrictMessage):
    """Stop sending images."""

    kind: Literal["camera_stop"]

    def body(self) -> StopCamera:
        """Return what is ordered."""
        return StopCamera()


class CameraLockOrder(StrictMessage):
    """Lock exposure and white balance at what they are, or unlock both."""

    kind: Literal["camera_lock"]
    is_locked: bool

    def body(self) -> LockCamera:
        """Return what is ordered."""
        return LockCamera(is_locked=self.is_locked)


class WaypointOrder(StrictMessage):
    """One waypoint; null `loiter_s` or `gimbal_pitch_deg` means no action."""

    latitude_deg: float
    longitude_deg: float
    height_above_takeoff_m: float
    speed_mps: float
    corner_radius_m: float = 0.2
    loiter_s: float | None = None
    gimbal_pitch_deg: float | None = None


class MissionOrder(StrictMessage):
    """Fly waypoints, replacing any mission being flown."""

    kind: Literal["mission"]
    waypoints: list[WaypointOrder] = Field(
        max_length=2000,
        description="a mission longer than the vehicle's app accepts is flown in parts",
    )
    land_at_end: bool = False
    curved: bool = False

    def body(self) -> FlyMission:
        """Return what is ordered."""
        waypoints = tuple(Waypoint(**waypoint.model_dump()) for waypoint in self.waypoints)
        return FlyMission(Mission(waypoints, self.land_at_end, self.curved))


class StickOrder(StrictMessage):
    """One virtual stick packet (ground: x north, y east; body: x forward, y right)."""

    kind: Literal["stick"]
    frame: Literal["ground", "body"] = "ground"
    yaw_deg: float
    velocity_x_mps: float
    velocity_y_mps: float
    height_above_takeoff_m: float
    timeout_s: float = 1.0

    def body(self) -> VirtualStick:
        """Return what is ordered."""
        fields = self.model_dump(exclude={"kind", "frame"})
        return VirtualStick(frame=StickFrame(self.frame), **fields)


class GoToOrder(StrictMessage):
    """Fly straight to a position and hold there; `yaw_deg` null keeps the heading."""

    kind: Literal["goto"]
    latitude_deg: float
    longitude_deg: float
    height_above_takeoff_m: float
    speed_mps: float = 5.0
    yaw_deg: float | None = None

    def body(self) -> GoTo:
        """Return what is ordered."""
        target = LatLon(self.latitude_deg, self.longitude_deg)
        return GoTo(target, self.height_above_takeoff_m, self.speed_mps, self.yaw_deg)


class NudgeOrder(StrictMessage):
    """Move by an offset and hold there; `turn_deg` is clockwise."""

    kind: Literal["nudge"]
    north_m: float = 0.0
    east_m: float = 0.0
    up_m: float = 0.0
    turn_deg: float = 0.0
    speed_mps: float = 2.0

    def body(self) -> Nudge:
        """Return what is ordered."""
        return Nudge(**self.model_dump(exclude={"kind"}))


class HoldPositionOrder(StrictMessage):
    """Hold the present position against wind and drift, steered by the station."""

    kind: Literal["hold_position"]

    def body(self) -> HoldPosition:
        """Return what is ordered."""
        return HoldPosition()


AnyOrder = Annotated[
    HoverOrder
    | LandOrder
    | ReturnHomeOrder
    | CameraStartOrder
    | CameraStopOrder
    | CameraLockOrder
    | MissionOrder
    | StickOrder
    | GoToOrder
    | NudgeOrder
    | HoldPositionOrder,
    Field(discriminator="kind"),
]


class AdmitAppRequest(StrictMessage):
    """The app that waits on a link, with the serial that its person saw."""

    link_id: int
    serial: str = Field(min_length=1, max_length=256)
    lasting: Literal["always", "session"] = Field(
        default="always", description="always: on the list; session: until the station stops"
    )
    any_address: bool = Field(
        default=False, description="admit this serial from any address, not the present one only"
    )


class RefuseAppRequest(StrictMessage):
    """The app that waits on a link."""

    link_id: int


class OrderRequest(GivenRequest):
    """An order to named vehicles. `takeoff` explicitly allows them to leave the ground.

    `goto`, `nudge` and `hold_position` need an `owner`: the name of an open state stream
    (`/api/stream?owner=NAME`). When that stream closes or is silent for 2 s, the vehicle stops and
    holds.
    """

    serials: list[Annotated[str, Field(max_length=2048)]] = Field(min_length=1, max_length=256)
    order: AnyOrder
    takeoff: bool = False
    owner: Annotated[str, Field(max_length=64)] | None = None

    @model_validator(mode="after")
    def _takes_off_with_what_can(self) -> Self:
        if self.takeoff and self.order.kind not in TAKEOFF_KINDS:
            raise ValueError(
                f"takeoff is not possible with {self.order.kind}, only with hover, mission and "
                "stick: send the order without it"
            )
        return self

    @model_validator(mode="after")
    def _names_its_owner(self) -> Self:
        if self.order.kind in STEERED_KINDS and not self.owner:
            raise ValueError(
                f"{self.order.kind} needs an owner, the name of an open stream "
                "(/api/stream?owner=NAME) whose end stops the vehicle"
            )
        return self


class FleetReturnRequest(GivenRequest):
    """Vehicles to return home in layers; null: every vehicle that is or may be in flight."""

    serials: list[Annotated[str, Field(max_length=2048)]] | None = Field(
        default=None, min_length=1, max_length=256
    )


class SideStepRequest(GivenRequest):
    """An imaging drone is to fly a little aside and back."""

    serial: str | None = Field(
        None,
        max_length=256,
        description="null: the one whose light is unknown, or the site's first",
    )


class ReliefRequest(GivenRequest):
    """An imaging drone is to take the place of another, or to return to its own.

    `takeoff` explicitly allows it to leave the ground, for this relief.
    """

    serial: str = Field(max_length=256, description="whose place is taken")
    spare: str | None = Field(
        None,
        max_length=256,
        description="the imaging drone that takes it; null: the same one returns to its place",
    )
    takeoff: bool = False


class StopReleaseRequest(StrictMessage):
    """Vehicles to release from an all stop; null: all, also those that connect later."""

    serials: list[Annotated[str, Field(max_length=2048)]] | None = Field(
        min_length=1, max_length=256
    )


class AuthorityRequest(StrictMessage):
    """The new holder of control authority."""

    holder: HolderName
    take_over: bool = Field(
        default=False, description="also from another person who operates the vehicle"
    )


class PreflightOverrideRequest(StrictMessage):
    """The reason for allowing missions although the checklist is not passed."""

    reason: str = Field(max_length=2048)
