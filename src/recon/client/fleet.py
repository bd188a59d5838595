"""All vehicles at once."""

from recon.client.desk import OrderDesk
from recon.client.messages import StateMessage
from recon.client.order import VehicleAnswer
from recon.model.command import Body, Hover, LandNow, ReturnHome


class Fleet:
    """Every vehicle with a serial that the station knows at the moment of the order.

    For whatever flies, with a serial or without, there is `Station.all_stop`.
    """

    def __init__(self, desk: OrderDesk) -> None:
        self._desk = desk

    async def hold(self) -> tuple[VehicleAnswer, ...]:
        """Stop and hold every vehicle."""
        return await self._give(Hover())

    async def land(self) -> tuple[VehicleAnswer, ...]:
        """Land every vehicle where it is."""
        return await self._give(LandNow())

    async def return_home(self) -> tuple[VehicleAnswer, ...]:
        """Fly every vehicle home."""
        return await self._give(ReturnHome())

    async def _give(self, body: Body) -> tuple[VehicleAnswer, ...]:
        # Asked anew: the stream's list may be old, and a vehicle left out is a vehicle that flies.
        state = await self._desk.http.get("/api/state", StateMessage, "a state")
        serials = [v.serial for v in state.vehicles if v.serial is not None]
        return await self._desk.give(serials, body) if serials else ()
