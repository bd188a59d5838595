"""One vehicle in the verbs of a pilot. Every verb is one order: an `Order`, or a `Refusal`."""

from collections.abc import AsyncIterator
from typing import TYPE_CHECKING
from urllib.parse import quote

from recon.client.errors import ConnectionLostError
from recon.client.order import Order
from recon.client.order_api import OrderDesk
from recon.client.readiness import Preflight, ask_preflight, say_holder, say_override
from recon.client.telemetry import Telemetry
from recon.model.authority import AuthorityHolder
from recon.model.command import (
    FlyMission,
    GoTo,
    HoldPosition,
    Hover,
    LandNow,
    Nudge,
    Refusal,
    ReturnHome,
    StartCamera,
    StickFrame,
    StopCamera,
    VirtualStick,
)
from recon.model.geo import LatLon
from recon.model.mission import Mission
from recon.model.units import ns_to_seconds

if TYPE_CHECKING:
    from recon.client.stream import Heard

QUIET_S = 1.0
"""Ten states come each second; after this without one the old one is told again, as old."""


class Vehicle:
    """A vehicle the station knows by its serial.

    Verbs raise `ClientError`s of the way to the station; what the station will not do is a
    `Refusal`, a value. Nothing is ever sent twice.
    """

    def __init__(self, serial: str, desk: OrderDesk) -> None:
        self.serial = serial
        self._desk = desk
        self._path = f"/api/vehicles/{quote(serial, safe='')}"

    async def hold(self) -> Order | Refusal:
        """Stop and hold the position."""
        return await self._desk.give_one(self.serial, Hover())

    async def land(self) -> Order | Refusal:
        """Land where the vehicle is."""
        return await self._desk.give_one(self.serial, LandNow())

    async def return_home(self) -> Order | Refusal:
        """Fly home at the aircraft's own go-home height and land."""
        return await self._desk.give_one(self.serial, ReturnHome())

    async def fly(self, mission: Mission, takeoff: bool = False) -> Order | Refusal:
        """Fly waypoints, replacing any mission being flown.

        `takeoff` is the explicit word that the vehicle may leave the ground. The mission's
        `purpose` stays here: the station does not take it.
        """
        return await self._desk.give_one(self.serial, FlyMission(mission), takeoff)

    async def would_fly(self, mission: Mission, takeoff: bool = False) -> Refusal | None:
        """Return why `fly` would be refused now, None when it would not. Nothing is sent."""
        return await self._desk.refusal_of(self.serial, FlyMission(mission), takeoff)

    async def goto(
        self,
        latitude_deg: float,
        longitude_deg: float,
        *,
        height_above_takeoff_m: float,
        speed_mps: float = 5.0,
        yaw_deg: float | None = None,
    ) -> Order | Refusal:
        """Fly straight to a place and hold there, steered by the station; yaw None keeps it.

        Held by this program: when its connection to the station ends, or it hangs for two
        seconds, the vehicle stops and holds where it is. So it is with `nudge` and
        `hold_position`. Raises `ConnectionLostError` while the stream is broken.
        """
        target = LatLon(latitude_deg, longitude_deg)
        body = GoTo(target, height_above_takeoff_m, speed_mps, yaw_deg)
        return await self._desk.give_one(self.serial, body)

    async def nudge(
        self,
        *,
        north_m: float = 0.0,
        east_m: float = 0.0,
        up_m: float = 0.0,
        turn_deg: float = 0.0,
        speed_mps: float = 2.0,
    ) -> Order | Refusal:
        """Move by this much from here (and turn, clockwise), and hold there; see `goto`."""
        body = Nudge(north_m, east_m, up_m, speed_mps, turn_deg)
        return await self._desk.give_one(self.serial, body)

    async def hold_position(self) -> Order | Refusal:
        """Hold this place, steered by the station until told otherwise; see `goto`.

        To simply stop, `hold` is the surer way: it needs no stream of sticks.
        """
        return await self._desk.give_one(self.serial, HoldPosition())

    async def stick(
        self,
        *,
        yaw_deg: float,
        velocity_x_mps: float,
        velocity_y_mps: float,
        height_above_takeoff_m: float,
        frame: StickFrame = StickFrame.GROUND,
        timeout_s: float = 1.0,
    ) -> Order | Refusal:
        """Send one virtual stick packet (ground: x north, y east; body: x forward, y right)."""
        body = VirtualStick(
            frame, yaw_deg, velocity_x_mps, velocity_y_mps, height_above_takeoff_m, timeout_s
        )
        return await self._desk.give_one(self.serial, body)

    async def start_camera(self, fps_hz: float) -> Order | Refusal:
        """Have images sent at about this rate."""
        return await self._desk.give_one(self.serial, StartCamera(fps_hz))

    async def stop_camera(self) -> Order | Refusal:
        """Have no more images sent."""
        return await self._desk.give_one(self.serial, StopCamera())

    async def take(self) -> Refusal | None:
        """Take the vehicle over, from guidance or from a pilot who has agreed; None when done.

        Nobody else sets it in motion from now on. What it was told before goes on.
        """
        return await say_holder(self._desk.http, self._path, AuthorityHolder.OPERATOR)

    async def give_to_pilot(self) -> Refusal | None:
        """Leave the vehicle to its pilot: the station moves it no more; None when done."""
        return await say_holder(self._desk.http, self._path, AuthorityHolder.PILOT)

    async def give_to_guidance(self) -> Refusal | None:
        """Leave the vehicle to the station's own planning; None when done."""
        return await say_holder(self._desk.http, self._path, AuthorityHolder.GUIDANCE)

    async def preflight(self) -> Preflight:
        """Return the checklist as of now: what holds missions back, and what to do about it."""
        return await ask_preflight(self._desk.http, self._path)

    async def override_preflight(self, reason: str) -> Refusal | None:
        """Let it fly missions although its checklist is not passed; None when done.

        The reason is kept in the audit; the override ends with the landing.
        """
        return await say_override(self._desk.http, self._path, reason)

    async def dismiss_hazard(self) -> None:
        """Say that somebody knows where the vehicle is, though it is not heard.

        Until then others keep clear of where it may be. Raises `RequestRefusedError` when it is
        no hazard area.
        """
        await self._desk.http.tell(f"{self._path}/hazard/dismiss")

    def now(self) -> Telemetry:
        """Return what is known now, with ages as of now; raises `ConnectionLostError`."""
        heard = self._desk.stream.newest
        told = None if heard is None else heard.vehicle(self.serial)
        if heard is None or told is None:
            raise ConnectionLostError(f"expected a state of {self.serial}, the station tells none")
        return told.older_by(self._desk.stream.age_s(heard))

    async def telemetry(self, lost_after_s: float = 10.0) -> AsyncIterator[Telemetry]:
        """Yield the newest state each time there is a newer one; states between are left out.

        When no new one comes for a second, the last one is yielded again with its ages grown, so
        marked late, lost or silent: an old state is never told as new. After `lost_after_s`
        without a new one raises `ConnectionLostError`.
        """
        stream = self._desk.stream
        since_ns, seen = stream.now_ns(), 0
        last: tuple[Heard, Telemetry] | None = None
        while True:
            heard = await stream.after(seen, QUIET_S)
            if heard is not None:
                seen = heard.number
                told = heard.vehicle(self.serial)
                if told is not None:
                    last, since_ns = (heard, told), heard.made_at_ns
            if ns_to_seconds(stream.now_ns() - since_ns) > lost_after_s:
                raise ConnectionLostError(
                    f"expected states of {self.serial}, got none for {lost_after_s:g} s "
                    f"({stream.trouble}); it flies on by its last order: reach it by its own "
                    "controller, or open the station anew"
                )
            if last is not None:
                yield last[1].older_by(stream.age_s(last[0]))
