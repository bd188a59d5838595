"""Orders in the audit: every change of phase; a stream of stick commands as one.

Of a stick stream the audit has its first packet, its end with a count, and each kind of problem
once, instead of ten lines a second.
"""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, replace
from typing import Any

import msgspec

from recon.model.command import Command, Phase, VirtualStick
from recon.model.units import ns_to_seconds, seconds_to_ns
from recon.record.audit.audit import AuditEntry
from recon.station.state.orders import OrderBook, OrderRecord, PhaseChange

STREAM_ENDS_AFTER_S = 2.0
"""A stick stream without a packet for this long has ended: its last packet has timed out."""

_TROUBLE = frozenset(
    {
        Phase.REFUSED_BY_STATION,
        Phase.REFUSED_BY_APP,
        Phase.TIMED_OUT,
        Phase.EXPIRED,
        Phase.FAILED,
    }
)


@dataclass(frozen=True, slots=True)
class StickStream:
    """Consecutive stick commands of one issuer for one vehicle."""

    by: str
    serial: str | None
    vehicle: str
    first_id: int
    began_ns: int
    last_ns: int
    count: int = 0
    refused: int = 0
    problems: frozenset[str] = frozenset()


StickStreams = Mapping[tuple[str | None, str], StickStream]


@dataclass(frozen=True, slots=True)
class OrdersLogged:
    """The open streams."""

    streams: StickStreams = field(default_factory=dict)


def order_entries(
    memory: OrdersLogged, before: OrderBook, after: OrderBook, now_ns: int
) -> tuple[OrdersLogged, tuple[AuditEntry, ...]]:
    """Return an entry for each change between two books."""
    entries: list[AuditEntry] = []
    for number, record in after.records.items():
        old = before.records.get(number)
        if old is record:
            continue
        changes = record.history[0 if old is None else len(old.history) :]
        if isinstance(record.command.body, VirtualStick):
            memory, new = _stick(memory, record, changes, old is None, now_ns)
            entries += new
        else:
            entries += [_entry(record, change) for change in changes]
    return memory, tuple(entries)


def ended_streams(memory: OrdersLogged, now_ns: int) -> tuple[OrdersLogged, tuple[AuditEntry, ...]]:
    """Return an entry for each stick stream that has ended."""
    limit_ns = seconds_to_ns(STREAM_ENDS_AFTER_S)
    ended = [s for s in memory.streams.values() if now_ns - s.last_ns > limit_ns]
    if not ended:
        return memory, ()
    keys = {(stream.serial, stream.by) for stream in ended}
    left = {key: stream for key, stream in memory.streams.items() if key not in keys}
    return replace(memory, streams=left), tuple(_end(stream) for stream in ended)


def body_details(command: Command) -> dict[str, Any]:
    """Return an order's body as JSON values."""
    body = msgspec.to_builtins(command.body)
    assert isinstance(body, dict)
    return body


def _entry(record: OrderRecord, change: PhaseChange) -> AuditEntry:
    command, phase = record.command, change.phase.value
    details: dict[str, Any] = {
        "id": command.id,
        "order": command.name,
        "phase": phase,
        "note": change.note,
    }
    if record.refusal is not None and change is record.history[-1]:
        details["rule"] = record.refusal.rule
        details["parameters"] = dict(record.refusal.parameters)
    if command.link_id is not None:
        details["link_id"] = command.link_id
    if change is record.history[0]:
        details["body"] = body_details(command)
        details["takeoff"] = command.takeoff
        details["role"] = command.role.value
        details["sent_altitudes"] = record.altitudes
        if record.plan is not None:
            details["parts"] = len(record.plan.parts)
            details["repairs"] = list(record.plan.repairs)
    words = f"{record.vehicle_name}: {command.name.replace('_', ' ')}: {phase.replace('_', ' ')}"
    text = f"{words} ({change.note})" if change.note else words
    return AuditEntry(
        f"order.{phase}", text, command.issued_by, command.serial, record.vehicle_name, details
    )


def _stick(
    memory: OrdersLogged,
    record: OrderRecord,
    changes: tuple[PhaseChange, ...],
    is_new: bool,
    now_ns: int,
) -> tuple[OrdersLogged, list[AuditEntry]]:
    command, entries = record.command, list[AuditEntry]()
    key = (command.serial, command.issued_by)
    stream = memory.streams.get(key)
    if is_new:
        if stream is None:
            stream = StickStream(
                command.issued_by, command.serial, record.vehicle_name, command.id, now_ns, now_ns
            )
            entries.append(_begin(record))
        stream = replace(stream, count=stream.count + 1, last_ns=now_ns)
    for change in changes:
        if change.phase in _TROUBLE and stream is not None:
            stream, new = _trouble(stream, record, change)
            entries += new
    if stream is None:
        return memory, entries
    return replace(memory, streams={**memory.streams, key: stream}), entries


def _trouble(
    stream: StickStream, record: OrderRecord, change: PhaseChange
) -> tuple[StickStream, Iterator[AuditEntry] | tuple[AuditEntry, ...]]:
    """Write each kind of problem once a stream."""
    refused = stream.refused + (change.phase is Phase.REFUSED_BY_STATION)
    cause = change.note if record.refusal is None else record.refusal.rule
    kind = f"{change.phase.value}:{cause}"
    is_known = kind in stream.problems
    stream = replace(stream, refused=refused, problems=stream.problems | {kind})
    return stream, () if is_known else (_entry(record, change),)


def _begin(record: OrderRecord) -> AuditEntry:
    command = record.command
    text = f"{record.vehicle_name}: stick stream started"
    details = {"id": command.id, "body": body_details(command), "role": command.role.value}
    return AuditEntry(
        "sticks.began", text, command.issued_by, command.serial, record.vehicle_name, details
    )


def _end(stream: StickStream) -> AuditEntry:
    seconds = ns_to_seconds(stream.last_ns - stream.began_ns)
    text = f"{stream.vehicle}: stick stream of {stream.count} packets ended after {seconds:.1f} s"
    details = {
        "first_id": stream.first_id,
        "count": stream.count,
        "refused": stream.refused,
        "seconds": seconds,
    }
    return AuditEntry("sticks.ended", text, stream.by, stream.serial, stream.vehicle, details)
