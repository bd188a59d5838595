"""One vehicle and its commands; each returns an `Order` or a `Refusal`."""

from collections.abc import AsyncIterator
from typing import TYPE_CHECKING
from urllib.parse import quote

from recon.client.errors import ConnectionLostError
from recon.client.messages import AnswerMessage, Preflight, ReceivedState
from recon.client.order import Order, OrderApi
from recon.client.telemetry import Telemetry
from recon.model.command import (
    FlyMission,
    GoTo,
    HoldPosition,
    Hover,
    LandNow,
    LockCamera,
    Nudge,
    Refusal,
    ReturnHome,
    StartCamera,
    StickFrame,
    StopCamera,
    VirtualStick,
)
from recon.model.control import AuthorityHolder
from recon.model.geo import LatLon
from recon.model.mission import Mission
from recon.model.units import ns_to_seconds

if TYPE_CHECKING:
    pass

REPEAT_S = 1.0
"""Time without a new state (ten a second) after which the last is yielded again, older."""


class Vehicle:
    """A vehicle, identified by its serial number.

    Commands return a `Refusal` if the station refuses, and raise a `ClientError` if the connection
    to the station fails. No command is sent twice. Heights are above the vehicle's takeoff point.
    """

    def __init__(self, serial: str, order_api: OrderApi) -> None:
        self.serial = serial
        self._order_api = order_api

    async def hold(self) -> Order | Refusal:
        """Stop and hold the position."""
        return await self._order_api.send_one(self.serial, Hover())

    async def land(self) -> Order | Refusal:
        """Land at the current position."""
        return await self._order_api.send_one(self.serial, LandNow())

    async def return_home(self) -> Order | Refusal:
        """Fly home at the aircraft's go-home height and land."""
        return await self._order_api.send_one(self.serial, ReturnHome())

    async def fly(self, mission: Mission, takeoff: bool = False) -> Order | Refusal:
        """Fly waypoints, replacing any current mission.

        `takeoff` allows the vehicle to take off. The mission's `purpose` is not sent.
        """
        return await self._order_api.send_one(self.serial, FlyMission(mission), takeoff)

    async def would_fly(self, mission: Mission, takeoff: bool = False) -> Refusal | None:
        """Return the refusal `fly` would get now, None if it would pass. Sends no order."""
        return await self._order_api.check(self.serial, FlyMission(mission), takeoff)

    async def goto(
        self,
        latitude_deg: float,
        longitude_deg: float,
        *,
        height_above_takeoff_m: float,
        speed_mps: float = 5.0,
        yaw_deg: float | None = None,
    ) -> Order | Refusal:
        """Fly straight to a position and hold there, by virtual stick; None keeps the yaw.

        The order depends on this program's stream: when the connection ends, or the program hangs
        for 2 s, the vehicle stops and holds. The same applies to `nudge` and `hold_position`.
        Raises `ConnectionLostError` while the stream is closed.
        """
        target = LatLon(latitude_deg, longitude_deg)
        body = GoTo(target, height_above_takeoff_m, speed_mps, yaw_deg)
        return await self._order_api.send_one(self.serial, body)

    async def nudge(
        self,
        *,
        north_m: float = 0.0,
        east_m: float = 0.0,
        up_m: float = 0.0,
        turn_deg: float = 0.0,
        speed_mps: float = 2.0,
    ) -> Order | Refusal:
        """Move by a distance in metres, turn clockwise in degrees, and hold there; see `goto`."""
        body = Nudge(north_m, east_m, up_m, speed_mps, turn_deg)
        return await self._order_api.send_one(self.serial, body)

    async def hold_position(self) -> Order | Refusal:
        """Hold the current position by virtual stick until commanded otherwise; see `goto`.

        To stop a vehicle use `hold`, which needs no stream.
        """
        return await self._order_api.send_one(self.serial, HoldPosition())

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
        return await self._order_api.send_one(self.serial, body)

    async def start_camera(self, fps_hz: float) -> Order | Refusal:
        """Start sending images, at about `fps_hz` per second."""
        return await self._order_api.send_one(self.serial, StartCamera(fps_hz))

    async def stop_camera(self) -> Order | Refusal:
        """Stop sending images."""
        return await self._order_api.send_one(self.serial, StopCamera())

    async def lock_camera(self, is_locked: bool = True) -> Order | Refusal:
        """Lock exposure and white balance at what they are, or unlock both.

        Refused for an app that does not report that it takes this order.
        """
        return await self._order_api.send_one(self.serial, LockCamera(is_locked))

    async def take(self, *, take_over: bool = False) -> Refusal | None:
        """Take operator control, from guidance or a pilot who agrees; None on success.

        Guidance can no longer move the vehicle. Its current order continues. `take_over`: also from
        another person who operates the vehicle; what that person steers stops and holds.
        """
        return await self._set_authority(AuthorityHolder.OPERATOR, take_over=take_over)

    async def give_to_pilot(self) -> Refusal | None:
        """Hand over to the pilot: the station no longer moves the vehicle; None on success."""
        return await self._set_authority(AuthorityHolder.PILOT)

    async def give_to_guidance(self) -> Refusal | None:
        """Hand over to the station's guidance; None on success."""
        return await self._set_authority(AuthorityHolder.GUIDANCE)

    async def preflight(self) -> Preflight:
        """Return the preflight checklist as of now, with instructions for unmet items."""
        path = self._path("preflight")
        return await self._order_api.http.get(path, Preflight, "a preflight checklist")

    async def override_preflight(self, reason: str) -> Refusal | None:
        """Allow missions although the checklist has not passed; None on success.

        The reason is recorded in the audit log; the override ends at landing.
        """
        return await self._post("preflight/override", {"reason": reason})

    async def dismiss_hazard(self) -> None:
        """Clear the lost vehicle's hazard area, which other vehicles avoid.

        Raises `RequestRefusedError` if the vehicle has none.
        """
        await self._order_api.http.post_without_result(self._path("hazard/dismiss"))

    def now(self) -> Telemetry:
        """Return the newest telemetry with ages as of now; raises `ConnectionLostError`."""
        state = self._order_api.stream.newest
        telemetry = None if state is None else state.vehicle(self.serial)
        if state is None or telemetry is None:
            raise ConnectionLostError(f"expected telemetry of {self.serial}, the station has none")
        return telemetry.older_by(self._order_api.stream.age_s(state))

    async def telemetry(self, lost_after_s: float = 10.0) -> AsyncIterator[Telemetry]:
        """Yield the newest telemetry whenever there is a newer one; skips those between.

        Without a new state for 1 s, yields the last one again with its ages increased, and so
        marked late, lost or silent. Raises `ConnectionLostError` after `lost_after_s` without one.
        """
        stream = self._order_api.stream
        received_ns, number = stream.now_ns(), 0
        last: tuple[ReceivedState, Telemetry] | None = None
        while True:
            state = await stream.after(number, REPEAT_S)
            if state is not None:
                number = state.number
                telemetry = state.vehicle(self.serial)
                if telemetry is not None:
                    last, received_ns = (state, telemetry), state.created_at_ns
            if ns_to_seconds(stream.now_ns() - received_ns) > lost_after_s:
                raise ConnectionLostError(
                    f"expected telemetry of {self.serial}, got none for {lost_after_s:g} s "
                    f"({stream.trouble}); the vehicle continues its last order: use the remote "
                    "controller, or reopen the station"
                )
            if last is not None:
                yield last[1].older_by(stream.age_s(last[0]))

    async def _set_authority(
        self, holder: AuthorityHolder, *, take_over: bool = False
    ) -> Refusal | None:
        return await self._post("authority", {"holder": holder.value, "take_over": take_over})

    async def _post(self, path: str, request: dict[str, str | bool]) -> Refusal | None:
        answer = await self._order_api.http.post(
            self._path(path), request, AnswerMessage, "an answer"
        )
        return answer.refusal

    def _path(self, path: str) -> str:
        # In the query: a serial such as `..` or `A/B` does not survive in a path.
        return f"/api/vehicle/{path}?serial={quote(self.serial, safe='')}"
