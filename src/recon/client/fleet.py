"""All vehicles at once."""

from collections.abc import Sequence

from recon.client.messages import StateMessage
from recon.client.order import VehicleAnswer
from recon.client.order_api import OrderDesk
from recon.client.returning import Returning
from recon.model.command import Body, Hover, LandNow, ReturnHome


class Fleet:
    """Every vehicle with a serial that the station knows at the moment of the order.

    For whatever flies, with a serial or without, there is `Station.all_stop`.
    """

    def __init__(self, desk: OrderDesk) -> None:
        self._desk = desk

    async def hold(self, serials: Sequence[str] | None = None) -> tuple[VehicleAnswer, ...]:
        """Stop and hold every vehicle, or those named."""
        return await self._give(Hover(), serials)

    async def land(self, serials: Sequence[str] | None = None) -> tuple[VehicleAnswer, ...]:
        """Land every vehicle where it is, or those named."""
        return await self._give(LandNow(), serials)

    async def return_home(self, serials: Sequence[str] | None = None) -> tuple[VehicleAnswer, ...]:
        """Fly every vehicle home at once, or those named, each at the aircraft's own height."""
        return await self._give(ReturnHome(), serials)

    async def return_in_layers(
        self, serials: Sequence[str] | None = None
    ) -> tuple[VehicleAnswer, ...]:
        """Call vehicles home, each at a height of its own, one at a time at each pad.

        None calls every one that flies or may. Each answer is the hold that it begins with; what
        follows is told by `returning`.
        """
        return await self._desk.fleet_return(serials)

    async def returning(self) -> tuple[Returning, ...]:
        """Return how far each vehicle of the newest return in layers has come."""
        state = await self._desk.http.get("/api/state", StateMessage, "a state")
        return () if state.fleet_return is None else state.fleet_return.vehicles

    async def _give(self, body: Body, serials: Sequence[str] | None) -> tuple[VehicleAnswer, ...]:
        if serials is not None:
            return await self._desk.give(tuple(dict.fromkeys(serials)), body)
        # Asked anew: the stream's list may be old, and a vehicle left out is a vehicle that flies.
        state = await self._desk.http.get("/api/state", StateMessage, "a state")
        known = [v.serial for v in state.vehicles if v.serial is not None]
        return await self._desk.give(known, body) if known else ()
