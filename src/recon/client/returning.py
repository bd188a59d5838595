"""How far the vehicles of a return in layers have come, as the station tells it."""

from typing import Literal

import msgspec

Stage = Literal["stopping", "waiting", "ordered", "flying", "landed", "released", "left_out"]


class Returning(msgspec.Struct, frozen=True):
    """One vehicle called home. `reason` says why it waits, was released or is left out.

    Without a flight (yet) `wave` and the heights are None. `layer_height_m` is above the site's
    ground altitude.
    """

    serial: str
    vehicle_name: str
    stage: Stage
    reason: str | None
    wave: int | None
    layer_height_m: float | None
    layer_height_above_takeoff_m: float | None
    pad: str | None

    @property
    def is_done(self) -> bool:
        """Whether the return does nothing more with it: landed, released, or left out."""
        return self.stage in ("landed", "released", "left_out")


class FleetReturnMessage(msgspec.Struct, frozen=True):
    """The newest return in layers."""

    vehicles: tuple[Returning, ...]
