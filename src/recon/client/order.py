"""An order that the station has accepted, and how to wait for its execution."""

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from recon.client.errors import ConnectionLostError, WaitTimeoutError
from recon.client.messages import OrderStatus, ReceivedState
from recon.model.command import Phase, Refusal

if TYPE_CHECKING:
    from recon.client.stream import Stream

SAME_RUN_NS = 1_000_000
"""Tolerance of a run's start, which is the difference of two rounded numbers, nanoseconds."""


@dataclass(frozen=True, slots=True)
class Order:
    """An accepted order. Accepted does not mean flown: only telemetry confirms, see `wait`."""

    command_id: int
    serial: str | None
    link_id: int | None
    vehicle_name: str
    _run_started_ns: int = field(repr=False)
    _stream: "Stream" = field(repr=False, compare=False)
    repairs: tuple[str, ...] = ()
    """Changes the station made to a mission so that the aircraft accepts it, as sentences."""
    parts: int = 0
    """Number of parts a mission is flown in; 0 for other orders."""

    async def wait(self, until: Phase = Phase.CONFIRMED, timeout_s: float = 30.0) -> OrderStatus:
        """Return the order's status once it has reached a phase or ended otherwise.

        The default is what telemetry shows: confirmed, or a mission's start. `Phase.DONE` waits
        for the end. Check `status.phase`: an order that timed out or was superseded is returned
        too. Raises `WaitTimeoutError`, and `ConnectionLostError` if the station has restarted and
        no longer has this order.
        """
        return await self._wait(
            lambda status: status.has_reached(until) or status.phase.is_final,
            until.value,
            timeout_s,
        )

    async def wait_for_effect(self, timeout_s: float = 30.0) -> OrderStatus:
        """Return the order's status once telemetry shows its execution, or it has ended.

        Check `status.has_taken_effect`. Raises as `wait` does.
        """
        return await self._wait(
            lambda status: status.has_taken_effect or status.phase.is_final,
            "an effect in telemetry",
            timeout_s,
        )

    async def wait_for_arrival(self, timeout_s: float = 600.0) -> OrderStatus:
        """Return a steered order's status once the vehicle is at the target, or it has ended.

        Check `status.has_arrived`. Raises as `wait` does.
        """

        def is_over(status: OrderStatus) -> bool:
            return status.has_arrived or (
                status.phase.is_final and status.phase is not Phase.CONFIRMED
            )

        return await self._wait(is_over, "arrival", timeout_s)

    async def _wait(
        self, is_over: Callable[[OrderStatus], bool], expected: str, timeout_s: float
    ) -> OrderStatus:
        deadline_ns = self._stream.now_ns() + round(timeout_s * 1e9)
        number, status = 0, None
        while (left_ns := deadline_ns - self._stream.now_ns()) > 0:
            state = await self._stream.after(number, left_ns / 1e9)
            if state is None:
                break
            number = state.number
            status = self._status(state) or status
            if status is not None and is_over(status):
                return status
        phase = "unknown" if status is None else f"{status.phase.value} ({status.note})"
        raise WaitTimeoutError(
            f"order {self.command_id} to {self.vehicle_name}: expected {expected} within "
            f"{timeout_s:g} s, its phase is {phase}; the order continues: hold the vehicle to stop "
            "it"
        )

    def _status(self, state: ReceivedState) -> OrderStatus | None:
        if abs(state.message.run_started_ns - self._run_started_ns) > SAME_RUN_NS:
            raise ConnectionLostError(
                f"order {self.command_id} to {self.vehicle_name}: the station has restarted and no "
                "longer has this order; check the vehicle"
            )
        return next((c for c in state.message.commands if c.id == self.command_id), None)


@dataclass(frozen=True, slots=True)
class VehicleAnswer:
    """The station's answer for one vehicle of an order to several.

    `serial` is None for a link that has not reported a serial number; an all stop holds it too.
    """

    serial: str | None
    link_id: int | None
    vehicle_name: str
    answer: Order | Refusal
