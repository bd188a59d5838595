"""The log and the missions, from the station's audit. Pure."""

from collections.abc import Iterator
from datetime import UTC, datetime, timedelta

import msgspec

from recon.client.messages import AuditRecord
from recon.gateway.foxglove.live_message import GEOJSON, LOG, LiveMessage
from recon.model.command import FlyMission, Phase
from recon.model.mission import Mission
from recon.record.mcap import foxglove

_EPOCH = datetime(1970, 1, 1, tzinfo=UTC)
_QUEUED = f"order.{Phase.QUEUED.value}"


def audit_messages(entry: AuditRecord) -> Iterator[LiveMessage]:
    """Yield an entry as a line of the log, and the mission that it orders."""
    at_ns = _utc_ns(entry.utc)
    line = foxglove.audit_log(entry.kind, entry.text, entry.vehicle, at_ns)
    yield LiveMessage(foxglove.LOG_TOPIC, LOG, at_ns, line.SerializeToString())
    mission = _mission(entry)
    if mission is not None and entry.serial is not None:
        path = foxglove.mission_path(mission, entry.serial)
        topic = foxglove.vehicle_topic(entry.serial, "mission")
        yield LiveMessage(topic, GEOJSON, at_ns, path.SerializeToString())


def gateway_line(text: str, level: str, at_ns: int) -> LiveMessage:
    """Return a line of the log that is the gateway's own."""
    line = foxglove.log(text, level, "gateway", at_ns)
    return LiveMessage(foxglove.LOG_TOPIC, LOG, at_ns, line.SerializeToString())


def _mission(entry: AuditRecord) -> Mission | None:
    """Return the mission of an accepted order: its first entry has it, and it is sent at once."""
    details = entry.details
    if entry.kind != _QUEUED or details.get("order") != FlyMission.name or "body" not in details:
        return None
    try:
        return msgspec.convert(details["body"], FlyMission).mission
    except msgspec.ValidationError:
        return None


def _utc_ns(utc: str) -> int:
    """Return the audit's time, which has microseconds; 0 for anything else."""
    try:
        return (datetime.fromisoformat(utc) - _EPOCH) // timedelta(microseconds=1) * 1000
    except (ValueError, TypeError, OverflowError):
        return 0
