"""The API's port on a running station: requests become events, states become views."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from datetime import UTC, datetime
from itertools import count
from pathlib import Path

from recon import version
from recon.api import schema
from recon.api.port import TimelineSubject
from recon.fleet import pairing
from recon.model.command import Body, Refusal
from recon.model.control import AuthorityHolder
from recon.model.event import (
    AlarmAcknowledged,
    AppAdmitted,
    AppRefused,
    AuthorityTaken,
    HazardDismissed,
    LookAsideOrdered,
    OwnerConnected,
    OwnerDisconnected,
    PersonConnected,
    PersonDisconnected,
    PreflightOverridden,
    ReliefOrdered,
    SeparationHoldSwitched,
    StopReleased,
    ZoneDrawn,
    ZoneEnded,
)
from recon.model.imagery import Frame, GroundImage
from recon.model.person import Person
from recon.model.shade import MaskMap, ShadeMap, SunForecast
from recon.model.temporary_zone import DrawnZone
from recon.model.units import ns_to_seconds
from recon.record.raster.geotiff import geotiff_bytes
from recon.site import Site
from recon.station.api_views import RunningStation, outcome_of
from recon.station.api_views.audit_service import KeptEntries, audit_page, timeline
from recon.station.api_views.calibration_service import CalibrationService
from recon.station.api_views.edited_site import EditedSite
from recon.station.api_views.imaging_views import sun_at_view, upwind_view
from recon.station.api_views.order_service import OrderService, order_of
from recon.station.api_views.site_service import SiteService
from recon.station.api_views.site_vehicles import SiteVehiclesService
from recon.station.api_views.site_view import site_view
from recon.station.api_views.state_view import DriverState, state_view
from recon.station.api_views.survey_service import SurveyService
from recon.station.api_views.vehicle_numbers import VehicleNumbers
from recon.station.api_views.vehicle_views import preflight_view
from recon.station.api_views.zone_views import zone_views
from recon.station.control import handover, preflight, stop_latch, temporary_zones
from recon.station.imaging.mosaic import mosaic, newest_images
from recon.station.operations.imager_relief.commands import refusal as relief_refusal
from recon.station.operations.look_aside.commands import refusal as look_aside_refusal
from recon.station.traffic.known_traffic import is_dismissible


@dataclass(slots=True)
class Service:
    """Implements `recon.api.port.StationPort` on a driver."""

    driver: RunningStation
    _edited: EditedSite
    link_addresses: list[str]
    capture_folder: str | None
    audit_log: KeptEntries | None
    _ids: Callable[[], int]
    app_url: str | None = None
    """The first address for apps on other devices; None on loopback."""
    guard_stop_url: str | None = None
    lost_bytes: Callable[[], int] = lambda: 0
    """How many bytes of links the record has lost so far."""
    recording: Callable[[], Path | None] = lambda: None
    """This run's record, once there is one."""
    replay: Callable[[], schema.ReplayView | None] = lambda: None
    """Where a replay stands; None on a live station."""
    numbers: VehicleNumbers = field(default_factory=VehicleNumbers)
    _drawing: SiteService = field(init=False)
    _vehicles: SiteVehiclesService = field(init=False)
    _calibration: CalibrationService = field(init=False)

    def __post_init__(self) -> None:
        self._drawing = SiteService(self._edited)
        self._vehicles = SiteVehiclesService(self._edited, self._vehicle_numbers)
        # A replay's frames come from its record.
        self._calibration = CalibrationService(self._edited, lambda serial: self.frame(serial))

    @property
    def site(self) -> Site:
        """The site that is in force."""
        return self._edited.site

    def edit(self, folder: Path | None) -> None:
        """Let the site be edited and saved in this folder, which it was read from."""
        self._edited = EditedSite(self.driver, self.site, folder)
        self.__post_init__()

    def _vehicle_numbers(self) -> Mapping[str, int]:
        return self.numbers.of(self.driver.station.fleet)

    @classmethod
    def around(
        cls,
        driver: RunningStation,
        site: Site,
        capture_folder: str | None,
        audit_log: KeptEntries | None = None,
        first_id: int = 1,
    ) -> "Service":
        """Return the service of a driver that is about to run; order ids start at `first_id`."""
        edited = EditedSite(driver, site, None)
        return cls(driver, edited, [], capture_folder, audit_log, count(first_id).__next__)

    def state(self) -> schema.StationState:
        """Return everything a console shows, as of now."""
        now_ns = self.driver.now_ns()
        return state_view(self.driver.station, self._driver_state(now_ns), now_ns)

    def order(
        self,
        serials: list[str],
        body: Body,
        *,
        takeoff: bool,
        by: Person,
        owner: str | None = None,
        given_at_ns: int | None = None,
    ) -> schema.OrderResponse:
        """Give one order to each named vehicle, once each."""
        order = order_of(body, by, takeoff=takeoff, owner=owner, given_at_ns=given_at_ns)
        return self._orders.give(serials, order)

    def check(
        self,
        serials: list[str],
        body: Body,
        *,
        takeoff: bool,
        by: Person,
        owner: str | None = None,
        given_at_ns: int | None = None,
    ) -> schema.OrderResponse:
        """Return what `order` would answer now; nothing is given and nothing changes."""
        order = order_of(body, by, takeoff=takeoff, owner=owner, given_at_ns=given_at_ns)
        return self._orders.check(serials, order)

    def all_stop(self, by: Person) -> schema.OrderResponse:
        """Latch every vehicle, then hold every link that may be in flight, identified or not."""
        return self._orders.all_stop(by)

    def fleet_return(
        self, serials: list[str] | None, by: Person, given_at_ns: int | None = None
    ) -> schema.OrderResponse:
        """Return vehicles home in layers; None: every vehicle that is or may be in flight."""
        return self._orders.fleet_return(serials, by, given_at_ns)

    @property
    def _orders(self) -> OrderService:
        return OrderService(self.driver, self._ids)

    def owner_connected(self, owner: str) -> None:
        """Add an owner."""
        self.driver.handle(OwnerConnected(owner))

    def owner_disconnected(self, owner: str) -> None:
        """Remove an owner; its steered orders end."""
        self.driver.handle(OwnerDisconnected(owner))

    def release_stop(self, serials: list[str] | None, by: Person) -> schema.ActionResponse:
        """Release vehicles from the all stop in force; None: all."""
        named = None if serials is None else tuple(dict.fromkeys(serials))
        event = StopReleased(named, by.label)
        return self._command(event, stop_latch.refusal(self.driver.station, event))

    def draw_zone(self, drawn: DrawnZone, by: Person) -> schema.TemporaryZoneResponse:
        """Draw a temporary zone; return it as it is in force."""
        event = ZoneDrawn(drawn, by.label)
        refusal = temporary_zones.draw_refusal(self.driver.station, event)
        answer = self._command(event, refusal)
        zone = (
            None
            if refusal is not None
            else zone_views(self.driver.station, self.driver.now_ns())[-1]
        )
        return schema.TemporaryZoneResponse(**answer.model_dump(), zone=zone)

    def end_zone(self, zone_id: int, by: Person) -> schema.ActionResponse:
        """End a temporary zone."""
        event = ZoneEnded(zone_id, by.label)
        return self._command(event, temporary_zones.end_refusal(self.driver.station, event))

    def admit_app(
        self, link_id: int, serial: str, *, is_for_good: bool, any_address: bool, by: Person
    ) -> schema.ActionResponse:
        """Admit the app that waits on a link; the audit has a refusal too."""
        event = AppAdmitted(link_id, serial, by.label, is_for_good, any_address)
        return self._decided(event, pairing.refusal_to_admit(self.driver.station.fleet, event))

    def refuse_app(self, link_id: int, by: Person) -> schema.ActionResponse:
        """Refuse the app that waits on a link."""
        event = AppRefused(link_id, by.label)
        return self._decided(event, pairing.refusal_to_refuse(self.driver.station.fleet, event))

    def look_aside(
        self, serial: str | None, by: Person, given_at_ns: int | None = None
    ) -> schema.ActionResponse:
        """Have an imaging drone look aside; the audit has a refusal too."""
        event = LookAsideOrdered(by.label, given_at_ns, by.name, serial=serial)
        refused = look_aside_refusal(self.driver.station, event, self.driver.now_ns())
        self.driver.handle(event)
        return _action(refused)

    def relieve(
        self,
        serial: str,
        spare: str,
        *,
        takeoff: bool,
        by: Person,
        given_at_ns: int | None = None,
    ) -> schema.ActionResponse:
        """Have an imaging drone take another's place; the audit has a refusal too."""
        event = ReliefOrdered(serial, spare, by.label, takeoff, given_at_ns, by.name)
        refused = relief_refusal(self.driver.station, event, self.driver.now_ns())
        self.driver.handle(event)
        return _action(refused)

    def dismiss_hazard(self, name: str, by: Person) -> bool:
        """Dismiss the hazard area of a lost vehicle."""
        if not is_dismissible(self.driver.station, name, self.driver.now_ns()):
            return False
        self.driver.handle(HazardDismissed(name, by.label))
        return True

    def switch_separation_hold(self, is_on: bool, by: Person) -> None:
        """Switch the separation holds of the watchdogs on or off."""
        self.driver.handle(SeparationHoldSwitched(is_on, by.label))

    def take_authority(
        self, serial: str, holder: AuthorityHolder, by: Person, *, takes_over: bool = False
    ) -> schema.ActionResponse:
        """Transfer control authority, and the operator lease with it."""
        event = AuthorityTaken(serial, holder, by.label, by.name, takes_over)
        refused = handover.refusal(self.driver.station, event, self.driver.now_ns())
        return self._command(event, refused)

    def person_connected(self, by: Person) -> None:
        """Count a stream of a person."""
        self.driver.handle(PersonConnected(by.name))

    def person_disconnected(self, by: Person) -> None:
        """Count a stream of a person that closed."""
        self.driver.handle(PersonDisconnected(by.name))

    def preflight(self, serial: str) -> schema.PreflightView | None:
        """Return a vehicle's checklist as of now."""
        return preflight_view(self.driver.station, serial, self.driver.now_ns())

    def override_preflight(self, serial: str, reason: str, by: Person) -> schema.ActionResponse:
        """Allow missions although the checklist is not passed."""
        event = PreflightOverridden(serial, by.label, reason)
        return self._command(event, preflight.refusal(self.driver.station, event))

    def acknowledge(self, alarm_id: int, by: Person) -> bool:
        """Acknowledge an alarm."""
        if alarm_id not in self.driver.station.alarms.alarms:
            return False
        self.driver.handle(AlarmAcknowledged(alarm_id, by.label))
        return True

    def timeline(
        self, serial: str | None, about: TimelineSubject | None, before_n: int | None, at_most: int
    ) -> schema.TimelineView:
        """Return what happened in this run, the newest first."""
        return timeline(self.audit_log, serial, about, before_n, at_most)

    def audit(self, after: int, at_most: int) -> schema.AuditPage:
        """Return the audit's entries after a number, as far as they are in memory."""
        return audit_page(self.audit_log, after, at_most)

    def frame(self, serial: str) -> Frame | None:
        """Return a vehicle's newest frame."""
        return self.driver.station.frames.get(serial)

    def ground_image(self) -> GroundImage | None:
        """Return the newest ground image of all imaging drones; safe in another thread."""
        return mosaic(newest_images(self.driver.station.imaging))

    def shade(self) -> tuple[int, ShadeMap, MaskMap] | None:
        """Return the number of the newest shade map, the map, and its cells in view."""
        line = self.driver.station.shade
        if line.shade is None:
            return None
        return line.number, line.shade, line.shade.valid if line.seen is None else line.seen

    def forecast(self) -> tuple[int, SunForecast] | None:
        """Return the newest forecast and its number."""
        line = self.driver.station.shade
        return None if line.sun is None else (line.number, line.sun)

    def sun_at(self, latitude_deg: float, longitude_deg: float) -> schema.SunAtView | None:
        """Return the light at a place and its next change."""
        station, now_ns = self.driver.station, self.driver.now_ns()
        return sun_at_view(station, (latitude_deg, longitude_deg), now_ns)

    def upwind_place(self, serial: str | None, region: str | None) -> schema.UpwindView:
        """Return where an imaging drone sees most of a region's shade; else why none is known."""
        station, now_ns = self.driver.station, self.driver.now_ns()
        return upwind_view(station, self.site, serial, region, now_ns)

    def surveys(self) -> SurveyService:
        """Return the surveys."""
        return SurveyService(self.driver, self.site, self._ids)

    def site_folder(self) -> SiteService:
        """Return the site's folder."""
        return self._drawing

    def site_vehicles(self) -> SiteVehiclesService:
        """Return the table of the site's vehicles."""
        return self._vehicles

    def calibration(self) -> CalibrationService:
        """Return what places the imaging drones' cameras by marked points."""
        return self._calibration

    def geotiff(self, image: GroundImage) -> bytes:
        """Return a ground image as a GeoTIFF file."""
        imager = self.site.imagers.get(image.serial)
        solution = None if imager is None else imager.solution
        rms_px = None if solution is None else solution.rms_px
        captured = datetime.fromtimestamp(ns_to_seconds(image.captured_at_ns), UTC)
        return geotiff_bytes(image, captured_utc=captured.isoformat(), rms_px=rms_px)

    def _command(
        self,
        event: AuthorityTaken | PreflightOverridden | StopReleased | ZoneDrawn | ZoneEnded,
        refusal: Refusal | None,
    ) -> schema.ActionResponse:
        """Handle an operator command, unless it is refused."""
        if refusal is None:
            self.driver.handle(event)
        return _action(refusal)

    def _decided(
        self, event: AppAdmitted | AppRefused, refusal: Refusal | None
    ) -> schema.ActionResponse:
        """Handle a decision about a waiting app; a refused one changes nothing but the audit."""
        self.driver.handle(event)
        return _action(refusal)

    def _driver_state(self, now_ns: int) -> DriverState:
        links = self.driver.links
        sessions = {} if links is None else links.sessions()
        numbers = self.numbers.of(self.driver.station.fleet)
        return DriverState(
            sessions, self._station_view(now_ns), site_view(self.site), numbers, self.replay()
        )

    def _station_view(self, now_ns: int) -> schema.StationView:
        links = self.driver.links
        listed = self.driver.station.fleet.admission.listed
        return schema.StationView(
            version=version(),
            link_addresses=self.link_addresses,
            app_url=self.app_url,
            uptime_s=ns_to_seconds(now_ns - self.driver.started_at_ns),
            frames_dropped=sum(
                each.frames_dropped for each in self.driver.station.imaging.imagers.values()
            ),
            capture_folder=self.capture_folder,
            capture_dropped_bytes=self.lost_bytes(),
            guard_stop_url=self.guard_stop_url,
            separation_hold_on=self.driver.station.watchdog_state.is_hold_on,
            connections_refused=0 if links is None else links.refused_connections,
            apps_listed=None if listed is None else len(listed),
        )


def _action(refusal: Refusal | None) -> schema.ActionResponse:
    return schema.ActionResponse(**outcome_of(refusal))
