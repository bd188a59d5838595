"""The async Python client of a running station.

async with Station("http://127.0.0.1:8080") as station:
    vehicle = await station.vehicle("SIM-1")
    order = await vehicle.hold()
"""

from recon.client.errors import (
    AddressError,
    BadAnswerError,
    ClientError,
    ConnectionLostError,
    MaybeSentError,
    RequestRefusedError,
    StationUnreachableError,
    TookTooLongError,
)
from recon.client.fleet import Fleet
from recon.client.life import Life, PhaseChange
from recon.client.order import Order, VehicleAnswer
from recon.client.readiness import Preflight, PreflightOverride, PreflightPoint
from recon.client.returning import Returning
from recon.client.station import Station
from recon.client.surveys import Survey, SurveyFigures, Surveying, Surveys
from recon.client.telemetry import Aged, ControlAuthority, Heading, Position, Telemetry, Velocity
from recon.client.vehicle import Vehicle
from recon.client.watched import Alarm, AuditEntry, AuditPage, StopAnswer
from recon.model.command import Phase, Refusal, StickFrame
from recon.model.mission import Mission, Waypoint
from recon.model.vehicle import Staleness

__all__ = [
    "AddressError",
    "Aged",
    "Alarm",
    "AuditEntry",
    "AuditPage",
    "BadAnswerError",
    "ClientError",
    "ConnectionLostError",
    "ControlAuthority",
    "Fleet",
    "Heading",
    "Life",
    "MaybeSentError",
    "Mission",
    "Order",
    "Phase",
    "PhaseChange",
    "Position",
    "Preflight",
    "PreflightOverride",
    "PreflightPoint",
    "Refusal",
    "RequestRefusedError",
    "Returning",
    "Staleness",
    "Station",
    "StationUnreachableError",
    "StickFrame",
    "StopAnswer",
    "Survey",
    "SurveyFigures",
    "Surveying",
    "Surveys",
    "Telemetry",
    "TookTooLongError",
    "Vehicle",
    "VehicleAnswer",
    "Velocity",
    "Waypoint",
]
