"""What apps say, built by construction."""

from dataclasses import replace

from recon.fleet.state import Fleet
from recon.fleet.step import CloseLink, step
from recon.model.event import Event, LinkClosed, LinkOpened, PacketReceived, Tick
from recon.model.geo import LatLon
from recon.model.report import CoreReport, ExtendedReport, Report
from recon.model.vehicle import (
    Attitude,
    BatteryWarning,
    CameraState,
    FlightMode,
    VehicleState,
    VelocityNed,
)

S = 1_000_000_000
PLACE = LatLon(42.0, -93.6)


def core(
    *,
    flying: bool | None = True,
    position: LatLon | None = PLACE,
    altitude_m: float | None = 300.0,
    height_m: float | None = 40.0,
    velocity: tuple[float, float, float] | None = (0.0, 0.0, 0.0),
) -> CoreReport:
    return CoreReport(
        is_flying=flying,
        position=position,
        reported_altitude_m=altitude_m,
        height_above_takeoff_m=height_m,
        velocity_ned=None if velocity is None else VelocityNed(*velocity),
        attitude=Attitude(0.0, 0.0, 0.0),
    )


def extended(
    serial: str | None = "A",
    *,
    mode: FlightMode | None = FlightMode.GPS_ATTI,
    battery: float | None = 0.8,
    warning: BatteryWarning | None = BatteryWarning.NONE,
    gnss_level: int | None = 4,
    mission_id: int = 0,
) -> ExtendedReport:
    return ExtendedReport(
        serial=serial,
        gnss_satellite_count=14,
        gnss_signal_level=gnss_level,
        max_height_reached=False,
        max_distance_reached=False,
        battery_fraction=battery,
        battery_warning=warning,
        wind_level=0,
        camera_state=CameraState.FEED_OFF,
        flight_mode=mode,
        mission_id=mission_id,
    )


def jittered(report: Report, number: int) -> Report:
    """The report with the last digits of a measured attitude: no two packets are the same."""
    if not isinstance(report, CoreReport) or report.attitude is None:
        return report
    attitude = replace(report.attitude, roll_deg=report.attitude.roll_deg + number % 7 / 1000)
    return replace(report, attitude=attitude)


class Story:
    """A fleet and its events, with times in seconds."""

    def __init__(self, fleet: Fleet | None = None) -> None:
        self.fleet = fleet or Fleet()
        self.closing: list[CloseLink] = []
        self.now_s = 0.0

    def at(self, now_s: float) -> "Story":
        self.now_s = now_s
        return self

    def happens(self, event: Event) -> "Story":
        self.fleet, closing = step(self.fleet, event, round(self.now_s * S))
        self.closing += closing
        return self

    def opens(self, link_id: int) -> "Story":
        return self.happens(LinkOpened(link_id, f"10.0.0.{link_id}:5000"))

    def closes(self, link_id: int) -> "Story":
        return self.happens(LinkClosed(link_id, "gone"))

    def receives(self, link_id: int, *reports: Report) -> "Story":
        for report in reports:
            self.happens(PacketReceived(link_id, report))
        return self

    def ticks(self) -> "Story":
        return self.happens(Tick())

    def vehicle(self, serial: str = "A") -> VehicleState:
        return self.fleet.vehicles[serial]
