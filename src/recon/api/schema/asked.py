"""What the station is asked."""

from typing import Annotated, Literal, Self

from pydantic import ConfigDict, Field, model_validator

from recon.api.schema.message import Message
from recon.api.schema.vehicles import AuthorityWord


class Asked(Message):
    """Base of what is asked: nothing is guessed from another type ("yes" is not true)."""

    model_config = ConfigDict(frozen=True, extra="forbid", strict=True)


class HoverOrder(Asked):
    """Stop and hold."""

    kind: Literal["hover"]


class LandOrder(Asked):
    """Land where the vehicle is."""

    kind: Literal["land"]


class ReturnHomeOrder(Asked):
    """Return at the aircraft's own go-home height and land."""

    kind: Literal["return_home"]


class CameraStartOrder(Asked):
    """Send images."""

    kind: Literal["camera_start"]
    fps_hz: float


class CameraStopOrder(Asked):
    """Stop sending images."""

    kind: Literal["camera_stop"]


class WaypointOrder(Asked):
    """One waypoint; null loiter and gimbal mean no action."""

    latitude_deg: float
    longitude_deg: float
    height_above_takeoff_m: float
    speed_mps: float
    corner_radius_m: float = 0.2
    loiter_s: float | None = None
    gimbal_pitch_deg: float | None = None


class MissionOrder(Asked):
    """Fly waypoints, replacing any mission being flown."""

    kind: Literal["mission"]
    waypoints: list[WaypointOrder] = Field(
        max_length=2000, description="more than the vehicle's app takes are flown in parts"
    )
    land_at_end: bool = False
    curved: bool = False


class StickOrder(Asked):
    """One virtual stick packet (ground: x north, y east; body: x forward, y right)."""

    kind: Literal["stick"]
    frame: Literal["ground", "body"] = "ground"
    yaw_deg: float
    velocity_x_mps: float
    velocity_y_mps: float
    height_above_takeoff_m: float
    timeout_s: float = 1.0


class GoToOrder(Asked):
    """Fly straight to a place and hold there; `yaw_deg` null keeps the heading."""

    kind: Literal["goto"]
    latitude_deg: float
    longitude_deg: float
    height_above_takeoff_m: float
    speed_mps: float = 5.0
    yaw_deg: float | None = None


class NudgeOrder(Asked):
    """Move by this much from here and hold there; `turn_deg` clockwise."""

    kind: Literal["nudge"]
    north_m: float = 0.0
    east_m: float = 0.0
    up_m: float = 0.0
    turn_deg: float = 0.0
    speed_mps: float = 2.0


class HoldPositionOrder(Asked):
    """Hold this place against wind and drift, steered by the station."""

    kind: Literal["hold_position"]


AnyOrder = Annotated[
    HoverOrder
    | LandOrder
    | ReturnHomeOrder
    | CameraStartOrder
    | CameraStopOrder
    | MissionOrder
    | StickOrder
    | GoToOrder
    | NudgeOrder
    | HoldPositionOrder,
    Field(discriminator="kind"),
]


class OrderRequest(Asked):
    """An order to named vehicles. `takeoff` is the explicit word that they may leave the ground.

    `goto`, `nudge` and `hold_position` need a `owner`: the name of an open stream of states
    (`/api/stream?owner=NAME`). When that stream ends, the vehicle is stopped and holds.
    """

    serials: list[Annotated[str, Field(max_length=2048)]] = Field(min_length=1, max_length=256)
    order: AnyOrder
    takeoff: bool = False
    owner: Annotated[str, Field(max_length=64)] | None = None

    @model_validator(mode="after")
    def _takes_off_with_what_can(self) -> Self:
        if self.takeoff and not isinstance(self.order, HoverOrder | MissionOrder | StickOrder):
            raise ValueError(
                f"takeoff was said with {self.order.kind}, which never takes off; it goes with "
                "hover, mission and stick only: give the order again without it"
            )
        return self

    @model_validator(mode="after")
    def _names_its_owner(self) -> Self:
        if isinstance(self.order, GoToOrder | NudgeOrder | HoldPositionOrder) and not self.owner:
            raise ValueError(
                f"{self.order.kind} needs a owner, the name of an open stream "
                "(/api/stream?owner=NAME) whose end stops the vehicle"
            )
        return self


class FleetReturnRequest(Asked):
    """Vehicles to call home in layers; null calls every one that flies or may."""

    serials: list[Annotated[str, Field(max_length=2048)]] | None = Field(
        default=None, min_length=1, max_length=256
    )


class AuthorityRequest(Asked):
    """Who is to lead a vehicle from now on."""

    holder: AuthorityWord


class PreflightOverrideRequest(Asked):
    """Why a vehicle may fly missions although its checklist is not passed."""

    reason: str = Field(max_length=2048)
