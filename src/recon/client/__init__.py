"""The async Python client of a running station.

async with Station("http://127.0.0.1:8080") as station:
    vehicle = await station.vehicle("SIM-1")
    order = await vehicle.hold()
"""

from recon.client.errors import (
    AddressError,
    BadAnswerError,
    CertificateError,
    ClientError,
    ConnectionLostError,
    MaybeSentError,
    RequestRefusedError,
    StationUnreachableError,
    WaitTimeoutError,
)
from recon.client.messages import (
    AlarmStatus,
    AuditLogPage,
    AuditRecord,
    ImagerReliefStatus,
    LinkStatus,
    MoveUpwindStatus,
    OrderStatus,
    PhaseReport,
    Preflight,
    PreflightOverride,
    PreflightPoint,
    ResultMessage,
    SideStepStatus,
    StopLatchStatus,
    TemporaryZoneStatus,
    VehicleReturn,
    WaitingAppStatus,
)
from recon.client.order import Order, VehicleAnswer
from recon.client.site import SiteCommands, SiteDrawing, SiteFeature, SiteVehicle, SiteVehicles
from recon.client.station import FleetCommands, Station
from recon.client.surveys import (
    DronePreview,
    FlownDayStatus,
    FlownRegionList,
    FlownRegionStatus,
    SurveyCommands,
    SurveyLight,
    SurveyPreview,
    SurveyProgress,
    SurveyStatus,
    SurveyVehicle,
)
from recon.client.telemetry import (
    Aged,
    AuthorityStatus,
    EulerAngles,
    LeaseStatus,
    Position,
    Telemetry,
    Velocity,
)
from recon.client.vehicle import Vehicle
from recon.client.zones import ZoneCommands
from recon.model.command import Phase, Refusal, StickFrame
from recon.model.mission import Mission, Waypoint
from recon.model.vehicle import Staleness
