"""An order the station accepted, and what becomes of it."""

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from recon.client.errors import ConnectionLostError, TookTooLongError
from recon.client.life import Life
from recon.model.command import Phase, Refusal

if TYPE_CHECKING:
    from recon.client.stream import Heard, Stream

SAME_RUN_NS = 1_000_000
"""The run's beginning is told as a difference of two numbers; rounding is far below this."""


@dataclass(frozen=True, slots=True)
class Order:
    """An accepted order. Accepted is not flown: only telemetry confirms, see `wait`."""

    command_id: int
    serial: str | None
    link_id: int | None
    vehicle_name: str
    _run_started_ns: int = field(repr=False)
    _stream: "Stream" = field(repr=False, compare=False)
    repairs: tuple[str, ...] = ()
    """What the station changed in a mission so that the aircraft accepts it, in sentences."""
    parts: int = 0
    """In how many parts a mission is flown; 0 for other orders."""

    async def wait(self, until: Phase = Phase.CONFIRMED, timeout_s: float = 30.0) -> Life:
        """Return the order's life once it came as far as a phase, or ended in another way.

        By default that is what telemetry shows: confirmed, or a mission's start. `Phase.DONE` waits
        for its end. So look at `life.phase`: an order that timed out or was superseded is returned
        as well.
        Raises `TookTooLongError`, and `ConnectionLostError` when the station was started anew and
        knows nothing of this order.
        """
        return await self._wait(
            lambda life: life.has_reached(until) or life.phase.is_final, until.value, timeout_s
        )

    async def effect(self, timeout_s: float = 30.0) -> Life:
        """Return the order's life once telemetry shows that it is carried out, or it ended.

        So look at `life.is_seen`. Raises as `wait` does.
        """
        return await self._wait(
            lambda life: life.is_seen or life.phase.is_final, "to be seen in telemetry", timeout_s
        )

    async def arrival(self, timeout_s: float = 600.0) -> Life:
        """Return the life of a steered order once the vehicle is there, or it ended otherwise.

        So look at `life.is_there`. Raises as `wait` does.
        """

        def is_over(life: Life) -> bool:
            return life.is_there or (life.phase.is_final and life.phase is not Phase.CONFIRMED)

        return await self._wait(is_over, "to be there", timeout_s)

    async def _wait(self, is_over: Callable[[Life], bool], what: str, timeout_s: float) -> Life:
        deadline_ns = self._stream.now_ns() + round(timeout_s * 1e9)
        seen, life = 0, None
        while (left_ns := deadline_ns - self._stream.now_ns()) > 0:
            heard = await self._stream.after(seen, left_ns / 1e9)
            if heard is None:
                break
            seen = heard.number
            life = self._life(heard) or life
            if life is not None and is_over(life):
                return life
        state = "unknown" if life is None else f"{life.phase.value} ({life.note})"
        raise TookTooLongError(
            f"order {self.command_id} to {self.vehicle_name}: expected {what} within "
            f"{timeout_s:g} s, its state is {state}; it goes on all the same: hold the vehicle if "
            "it must not"
        )

    def _life(self, heard: "Heard") -> Life | None:
        if abs(heard.message.run_started_ns - self._run_started_ns) > SAME_RUN_NS:
            raise ConnectionLostError(
                f"order {self.command_id} to {self.vehicle_name}: expected the station that took "
                "it, got one started anew, which does not know it; see what the vehicle does"
            )
        return next((c for c in heard.message.commands if c.id == self.command_id), None)


@dataclass(frozen=True, slots=True)
class VehicleAnswer:
    """What the station said to an order for one vehicle of many.

    `serial` is None for a link that has told no serial; it is held by an all stop as well.
    """

    serial: str | None
    link_id: int | None
    vehicle_name: str
    answer: Order | Refusal
