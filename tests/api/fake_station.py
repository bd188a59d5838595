"""A station that the API can be put around, and its application under test."""

from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from recon.api.app import create_app
from recon.api.port import (
    CalibrationPort,
    SiteFolder,
    SiteVehiclesPort,
    SurveyPort,
    TimelineSubject,
)
from recon.api.schema import (
    ActionResponse,
    AuditPage,
    OrderResponse,
    PreflightView,
    StationState,
    SunAtView,
    TemporaryZoneResponse,
    TimelineView,
    UpwindView,
)
from recon.api.security import Access, AccessCheck
from recon.model.command import Body
from recon.model.control import AuthorityHolder
from recon.model.imagery import Frame, GroundImage
from recon.model.person import Person
from recon.model.shade import MaskMap, ShadeMap, SunForecast
from recon.model.temporary_zone import DrawnZone
from recon.site import Site, default_site
from recon.station.api_views.service import Service
from recon.station.kernel.build import first_state
from recon.station.kernel.driver import AsyncioDriver
from recon.station.kernel.worker import AnyJob, JobRunner


@dataclass
class WorkerAtOnce:
    """Runs each job at once, on the caller's thread."""

    jobs: JobRunner
    driver: AsyncioDriver

    def submit(self, job: AnyJob) -> None:
        self.driver.handle(self.jobs.run(job))


@dataclass
class FakeStation:
    """The real service around a station without sockets; pictures are put in by hand."""

    site: Site = field(default_factory=default_site)
    frames: dict[str, Frame] = field(default_factory=dict)
    image: GroundImage | None = None
    asked: list[tuple[list[str], Body, bool]] = field(default_factory=list)
    states_made: int = 0
    now_ns: int = 1_000_000_000

    def __post_init__(self) -> None:
        self.driver = AsyncioDriver(first_state(self.site), lambda: self.now_ns)
        self.driver.worker = WorkerAtOnce(JobRunner(self.site), self.driver)
        self.service = Service.around(self.driver, self.site, None)

    def state(self) -> StationState:
        self.states_made += 1
        return self.service.state()

    def order(
        self,
        serials: list[str],
        body: Body,
        *,
        takeoff: bool,
        by: Person,
        owner: str | None = None,
        given_at_ns: int | None = None,
    ) -> OrderResponse:
        self.asked.append((serials, body, takeoff))
        return self.service.order(
            serials,
            body,
            takeoff=takeoff,
            by=by,
            owner=owner,
            given_at_ns=given_at_ns,
        )

    def check(
        self,
        serials: list[str],
        body: Body,
        *,
        takeoff: bool,
        by: Person,
        owner: str | None = None,
        given_at_ns: int | None = None,
    ) -> OrderResponse:
        return self.service.check(
            serials,
            body,
            takeoff=takeoff,
            by=by,
            owner=owner,
            given_at_ns=given_at_ns,
        )

    def timeline(
        self, serial: str | None, about: TimelineSubject | None, before_n: int | None, at_most: int
    ) -> TimelineView:
        return self.service.timeline(serial, about, before_n, at_most)

    def audit(self, after: int, at_most: int) -> AuditPage:
        return self.service.audit(after, at_most)

    def owner_connected(self, owner: str) -> None:
        self.service.owner_connected(owner)

    def owner_disconnected(self, owner: str) -> None:
        self.service.owner_disconnected(owner)

    def all_stop(self, by: Person) -> OrderResponse:
        return self.service.all_stop(by)

    def draw_zone(self, drawn: DrawnZone, by: Person) -> TemporaryZoneResponse:
        return self.service.draw_zone(drawn, by)

    def end_zone(self, zone_id: int, by: Person) -> ActionResponse:
        return self.service.end_zone(zone_id, by)

    def release_stop(self, serials: list[str] | None, by: Person) -> ActionResponse:
        return self.service.release_stop(serials, by)

    def admit_app(
        self, link_id: int, serial: str, *, is_for_good: bool, any_address: bool, by: Person
    ) -> ActionResponse:
        return self.service.admit_app(
            link_id, serial, is_for_good=is_for_good, any_address=any_address, by=by
        )

    def refuse_app(self, link_id: int, by: Person) -> ActionResponse:
        return self.service.refuse_app(link_id, by)

    def fleet_return(
        self, serials: list[str] | None, by: Person, given_at_ns: int | None = None
    ) -> OrderResponse:
        return self.service.fleet_return(serials, by, given_at_ns)

    def look_aside(
        self, serial: str | None, by: Person, given_at_ns: int | None = None
    ) -> ActionResponse:
        return self.service.look_aside(serial, by, given_at_ns)

    def relieve(
        self,
        serial: str,
        spare: str,
        *,
        takeoff: bool,
        by: Person,
        given_at_ns: int | None = None,
    ) -> ActionResponse:
        return self.service.relieve(serial, spare, takeoff=takeoff, by=by, given_at_ns=given_at_ns)

    def dismiss_hazard(self, name: str, by: Person) -> bool:
        return self.service.dismiss_hazard(name, by)

    def switch_separation_hold(self, is_on: bool, by: Person) -> None:
        self.service.switch_separation_hold(is_on, by)

    def take_authority(
        self, serial: str, holder: AuthorityHolder, by: Person, *, takes_over: bool = False
    ) -> ActionResponse:
        return self.service.take_authority(serial, holder, by, takes_over=takes_over)

    def person_connected(self, by: Person) -> None:
        self.service.person_connected(by)

    def person_disconnected(self, by: Person) -> None:
        self.service.person_disconnected(by)

    def preflight(self, serial: str) -> PreflightView | None:
        return self.service.preflight(serial)

    def override_preflight(self, serial: str, reason: str, by: Person) -> ActionResponse:
        return self.service.override_preflight(serial, reason, by)

    def acknowledge(self, alarm_id: int, by: Person) -> bool:
        return self.service.acknowledge(alarm_id, by)

    def frame(self, serial: str) -> Frame | None:
        return self.frames.get(serial)

    def ground_image(self) -> GroundImage | None:
        return self.image

    def shade(self) -> tuple[int, ShadeMap, MaskMap] | None:
        return self.service.shade()

    def forecast(self) -> tuple[int, SunForecast] | None:
        return self.service.forecast()

    def sun_at(self, latitude_deg: float, longitude_deg: float) -> SunAtView | None:
        return self.service.sun_at(latitude_deg, longitude_deg)

    def upwind_place(self, serial: str | None, region: str | None) -> UpwindView:
        return self.service.upwind_place(serial, region)

    def surveys(self) -> SurveyPort:
        return self.service.surveys()

    def site_folder(self) -> SiteFolder:
        return self.service.site_folder()

    def site_vehicles(self) -> SiteVehiclesPort:
        return self.service.site_vehicles()

    def calibration(self) -> CalibrationPort:
        return self.service.calibration()

    def geotiff(self, image: GroundImage) -> bytes:
        return self.service.geotiff(image)


def application(
    station: FakeStation, *, access: Access | None = None, console: Path | None = None
) -> AccessCheck:
    return AccessCheck(create_app(station, console, "1.2.3"), access or Access())


def rgb_frame(serial: str) -> Frame:
    """Return a frame whose left half is red and right half blue."""
    rgb = np.zeros((32, 64, 3), np.uint8)
    rgb[:, :32, 0] = 255
    rgb[:, 32:, 2] = 255
    return Frame(7, serial, 0, 0, 0.25, rgb=rgb)
