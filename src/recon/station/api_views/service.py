"""A running station behind the API: its state as a view, and the services of its requests."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from itertools import count
from pathlib import Path

from recon import version
from recon.api import schema
from recon.model.command import Refusal
from recon.model.event import Event
from recon.model.imagery import Frame, GroundImage
from recon.model.units import ns_to_seconds
from recon.site import Site
from recon.station.api_views import RunningStation, outcome_of
from recon.station.api_views.audit_service import KeptEntries
from recon.station.api_views.calibration_service import CalibrationService
from recon.station.api_views.edited_site import EditedSite
from recon.station.api_views.order_service import OrderService
from recon.station.api_views.site_service import SiteService
from recon.station.api_views.site_vehicles import SiteVehiclesService
from recon.station.api_views.site_view import site_view
from recon.station.api_views.state_view import DriverState, TrackViews, state_view
from recon.station.api_views.survey_service import SurveyService
from recon.station.api_views.vehicle_numbers import VehicleNumbers
from recon.station.imaging.mosaic import mosaic, newest_images
from recon.station.recovery.flown_regions import FlownRegions


@dataclass(slots=True)
class Service:
    """What the routes of the API share."""

    driver: RunningStation
    _edited: EditedSite
    link_addresses: list[str]
    capture_folder: str | None
    audit_log: KeptEntries | None
    _ids: Callable[[], int]
    app_url: str | None = None
    """The first address for apps on other devices; None on loopback."""
    guard_stop_url: str | None = None
    repeats_surveys: bool = False
    """Whether this is a demonstration, which begins one survey after another."""
    lost_bytes: Callable[[], int] = lambda: 0
    """How many bytes of links the record has lost so far."""
    recording: Callable[[], Path | None] = lambda: None
    """This run's record, once there is one."""
    replay: Callable[[], schema.ReplayView | None] = lambda: None
    """Position of a replay; None on a live station."""
    numbers: VehicleNumbers = field(default_factory=VehicleNumbers)
    flown: FlownRegions = field(default_factory=FlownRegions)
    gaps_file: Callable[[], Path | None] = lambda: None
    """The gaps that the newest photos show."""
    _tracks: TrackViews = field(default_factory=TrackViews)
    drawing: SiteService = field(init=False)
    """The layers in the site's folder."""
    site_vehicles: SiteVehiclesService = field(init=False)
    """The table of the site's vehicles, in its folder."""
    calibration: CalibrationService = field(init=False)
    """What places the imaging drones' cameras by marked points."""

    def __post_init__(self) -> None:
        self.drawing = SiteService(self._edited)
        self.site_vehicles = SiteVehiclesService(self._edited, self._vehicle_numbers)
        # A replay's frames come from its record.
        self.calibration = CalibrationService(self._edited, lambda serial: self.frame(serial))

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

    @property
    def orders(self) -> OrderService:
        """The orders to this station's vehicles."""
        return OrderService(self.driver, self._ids)

    @property
    def surveys(self) -> SurveyService:
        """The surveys of this run."""
        return SurveyService(self.driver, self.site, self._ids, self.flown, self.gaps_file)

    def commanded(self, event: Event, refusal: Refusal | None) -> schema.ActionResponse:
        """Handle an operator command, unless it is refused."""
        if refusal is None:
            self.driver.handle(event)
        return schema.ActionResponse(**outcome_of(refusal))

    def decided(self, event: Event, refusal: Refusal | None) -> schema.ActionResponse:
        """Handle a command that the station judges itself: the audit has a refusal too."""
        self.driver.handle(event)
        return schema.ActionResponse(**outcome_of(refusal))

    def frame(self, serial: str) -> Frame | None:
        """Return a vehicle's newest frame."""
        return self.driver.station.frames.get(serial)

    def ground_image(self) -> GroundImage | None:
        """Return the newest ground image of all imaging drones; safe in another thread."""
        return mosaic(newest_images(self.driver.station.imaging))

    def _driver_state(self, now_ns: int) -> DriverState:
        links = self.driver.links
        sessions = {} if links is None else links.sessions()
        numbers = self.numbers.of(self.driver.station.fleet)
        return DriverState(
            sessions,
            self._station_view(now_ns),
            site_view(self.site),
            numbers,
            self._tracks,
            self.replay(),
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
            repeats_surveys=self.repeats_surveys,
            separation_hold_on=self.driver.station.watchdog_state.is_hold_on,
            connections_refused=0 if links is None else links.refused_connections,
            apps_listed=None if listed is None else len(listed),
        )
