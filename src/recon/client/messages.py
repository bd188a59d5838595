"""The station's messages, as far as the client reads them. Keys it does not know are left alone."""

from collections.abc import Mapping
from typing import Any, TypeVar

import msgspec

from recon.client.errors import BadAnswerError
from recon.client.life import Life
from recon.client.returning import FleetReturnMessage
from recon.client.telemetry import Telemetry
from recon.client.watched import Alarm
from recon.model.command import Refusal
from recon.model.units import seconds_to_ns

M = TypeVar("M")

SHOWN_CHARACTERS = 60


class StationMessage(msgspec.Struct, frozen=True):
    """The station itself."""

    uptime_s: float


class StateMessage(msgspec.Struct, frozen=True):
    """Everything a console shows, as of `time_ns` (station time)."""

    time_ns: int
    station: StationMessage
    vehicles: tuple[Telemetry, ...]
    commands: tuple[Life, ...]
    alarms: tuple[Alarm, ...]
    fleet_return: FleetReturnMessage | None = None

    @property
    def run_started_ns(self) -> int:
        """Station time at which this run of the station began."""
        return self.time_ns - seconds_to_ns(self.station.uptime_s)


class ResultMessage(msgspec.Struct, frozen=True):
    """What became of an order for one vehicle."""

    serial: str | None
    link_id: int | None
    vehicle_name: str
    accepted: bool
    command_id: int
    rule: str | None
    reason: str | None
    parameters: Mapping[str, float | int | str] = {}
    repairs: tuple[str, ...] = ()
    parts: int = 0

    @property
    def refusal(self) -> Refusal:
        """The refusal, of a result that was not accepted."""
        rule, reason = self.rule or "unnamed", self.reason or "no reason was given"
        return Refusal(rule, reason, parameters=self.parameters)


class OrderMessage(msgspec.Struct, frozen=True):
    """One result for each vehicle."""

    results: tuple[ResultMessage, ...]


class ProblemMessage(msgspec.Struct, frozen=True):
    """Why a request was not carried out."""

    error: str


def decode(data: bytes | str, kind: type[M], what: str) -> M:
    """Return a message of a kind; raises `BadAnswerError` that names `what` was expected."""
    try:
        return msgspec.json.decode(data, type=kind)
    except (msgspec.DecodeError, UnicodeError, RecursionError, OverflowError) as problem:
        raise BadAnswerError(
            f"expected {what} as JSON, got {shown(data)}: {problem}; is this a Recon station of "
            "the same version?"
        ) from problem


def shown(data: Any) -> str:
    """Return the beginning of foreign data, safe to print."""
    start = data[:SHOWN_CHARACTERS]
    return repr(start) + ("..." if len(data) > SHOWN_CHARACTERS else "")
