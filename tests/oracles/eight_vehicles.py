"""Eight vehicles over the demonstration's field in virtual time, flown by orders through the gate.

The scene for measuring how fast virtual time runs and for showing that it runs the same again:
seven survey drones and the imaging drone, with a station, its sessions and every byte between them.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace

from recon.geo import point_from_enu
from recon.model.command import Body, FlyMission, GoTo, Hover
from recon.model.event import OperatorOrder, OwnerConnected
from recon.model.geo import LatLon
from recon.model.mission import Mission, Waypoint
from recon.model.units import NS_PER_S, seconds_to_ns
from recon.sim.app.app import SimulatedApp
from recon.sim.app.camera_feed import FeedSettings, ImageFormat
from recon.sim.app.faults import parse_fault
from recon.sim.camera.field import FieldRenderer
from recon.sim.camera.rig import CameraRig
from recon.sim.camera.settings import CameraSettings
from recon.sim.connected_apps import ConnectedApps
from recon.sim.fake_link import FakeLink
from recon.sim.fleet import IMAGER_SERIAL, Airborne, ImagerSetup, SimulationConfig, build_fleet
from recon.sim.flight.estimate import FIELD_DRIFT
from recon.sim.world import LayerSettings, Sky, SkySettings, SunSettings
from recon.site import Site, demo_site_folder, load_site
from recon.station.kernel.build import first_state
from recon.station.kernel.virtual import VirtualDriver
from recon.station.kernel.worker import JobRunner

VEHICLES = 8
OWNER = "the study"
MISSION_EVERY_S = 60.0
HOVER_AFTER_S, GOTO_AFTER_S = 40.0, 48.0
"""Of each minute: first a mission, then a hover breaks it off, then a stream of sticks."""
APART_S = 3.0
"""From one vehicle's orders to the next one's."""
SPEED_MPS = 6.0
PICTURES_HZ = 1.0

PLACES_M: dict[str, tuple[float, float]] = {
    "SIM-1": (-150.0, 20.0),
    "SIM-2": (-20.0, -190.0),
    "SIM-3": (60.0, 150.0),
    "SIM-4": (-180.0, -60.0),
    "SIM-5": (-150.0, -180.0),
    "SIM-6": (90.0, -180.0),
    "SIM-7": (190.0, -60.0),
}
"""East and north of the origin: the middle of what each drone flies over, away from the others'
routes home."""
HALF_ROW_M = 20.0
ROWS_NORTH_M = (-20.0, 0.0, 20.0)
LOWEST_M, LAYERS_APART_M = 40.0, 8.0

WATCHED_EVERY_S = 0.2
"""So often it is asked what faults want of connections."""


@dataclass(slots=True)
class EightVehicles:
    """The station and its apps, and an operator with a word for each drone now and then."""

    connected: ConnectedApps
    site: Site
    steers: bool = True
    orders: list[int] = field(default_factory=list)
    _later: list[tuple[int, Callable[[], object]]] = field(default_factory=list)

    def __post_init__(self) -> None:
        for number, serial in enumerate(PLACES_M):
            self._after(3.0 + APART_S * number, lambda serial=serial: self._fly(serial))

    @property
    def driver(self) -> VirtualDriver:
        """What lets time pass."""
        return self.connected.driver

    @property
    def apps(self) -> Sequence[SimulatedApp]:
        """All apps, the imaging drone's first."""
        return self.connected.apps

    def run_for(self, seconds: float) -> None:
        """Let virtual time pass."""
        end_ns = self.driver.now_ns + seconds_to_ns(seconds)
        while self.driver.now_ns < end_ns:
            next_ns = min([end_ns, *(at_ns for at_ns, _ in self._later)])
            until_then_s = (next_ns - self.driver.now_ns) / NS_PER_S
            self.connected.advance(min(WATCHED_EVERY_S, until_then_s))
            self._do_what_is_due()

    def order(self, serial: str, body: Body, owner: str | None = None) -> None:
        """Say a word to the station as an operator does."""
        number = len(self.orders) + 1
        self.orders.append(number)
        self.driver.handle(OperatorOrder(number, body, "study", serial, owner=owner))

    def _fly(self, serial: str) -> None:
        """A minute of one vehicle, and then the next."""
        self.order(serial, self.mission(serial))
        self._after(HOVER_AFTER_S, lambda: self.order(serial, Hover()))
        if self.steers:
            self._after(GOTO_AFTER_S, lambda: self._steer(serial))
        self._after(MISSION_EVERY_S, lambda: self._fly(serial))

    def _steer(self, serial: str) -> None:
        self.driver.handle(OwnerConnected(OWNER))
        place, height_m = self._place(PLACES_M[serial]), self._height_m(serial)
        self.order(serial, GoTo(place, height_m, SPEED_MPS), OWNER)

    def mission(self, serial: str) -> FlyMission:
        """Return the rows that a drone flies again and again."""
        east_m, north_m = PLACES_M[serial]
        corners = []
        for row, offset_m in enumerate(ROWS_NORTH_M):
            ends = [
                (east_m - HALF_ROW_M, north_m + offset_m),
                (east_m + HALF_ROW_M, north_m + offset_m),
            ]
            corners += ends if row % 2 == 0 else ends[::-1]
        places = [self._place(corner) for corner in corners]
        height_m = self._height_m(serial)
        return FlyMission(
            Mission(
                tuple(
                    Waypoint(p.latitude_deg, p.longitude_deg, height_m, SPEED_MPS) for p in places
                )
            )
        )

    def _height_m(self, serial: str) -> float:
        return LOWEST_M + LAYERS_APART_M * list(PLACES_M).index(serial)

    def _place(self, east_north_m: tuple[float, float]) -> LatLon:
        assert self.site.frame is not None
        point = point_from_enu(self.site.frame, (*east_north_m, 0.0))
        return LatLon(point.latitude_deg, point.longitude_deg)

    def _do_what_is_due(self) -> None:
        due = [action for at_ns, action in self._later if at_ns <= self.driver.now_ns]
        self._later = [item for item in self._later if item[0] > self.driver.now_ns]
        for action in due:
            action()

    def _after(self, seconds: float, action: Callable[[], object]) -> None:
        self._later.append((self.driver.now_ns + seconds_to_ns(seconds), action))


def eight_vehicles(
    seed: int = 1,
    *,
    steers: bool = True,
    sees: bool = False,
    jpeg_quality: int | None = None,
    faults: Sequence[str] = (),
    make_link: Callable[[], FakeLink] = FakeLink,
    keeps_log: bool = False,
) -> EightVehicles:
    """Return the scene: with `steers` each drone is also led by sticks for a fifth of the time;
    with `sees` the imaging drone sends rendered frames, which the station reads, raw or as JPEG."""
    site = load_site(demo_site_folder())
    driver = VirtualDriver(first_state(site), jobs=JobRunner(site), keeps_log=keeps_log)
    fleet = build_fleet(_config(site, seed, sees, faults, jpeg_quality), driver.now_ns)
    connected = ConnectedApps(driver, make_link)
    connected.connect_all(fleet)
    return EightVehicles(connected, site, steers)


def _config(
    site: Site, seed: int, sees: bool, faults: Sequence[str], jpeg_quality: int | None
) -> SimulationConfig:
    assert site.frame is not None
    assert site.imager is not None
    assert site.imager.marked_frame is not None
    marked = site.imager.marked_frame
    rig = CameraRig(site.imager.camera, site.frame, site.imager.marked_pose, marked)
    origin = site.frame.origin
    sun = SunSettings(LatLon(origin.latitude_deg, origin.longitude_deg))
    clouds = LayerSettings(cover=0.35, outer_scale_m=2_500.0, softness=0.15)
    source = FieldRenderer(
        rig.camera,
        site.imager.image_circle,
        seed,
        Sky(SkySettings(seed, sun, (clouds,))),
        CameraSettings(seed),
    )
    pads = {s: profile.pad for s, profile in site.profiles.items() if profile.pad is not None}
    feed = FeedSettings(PICTURES_HZ, starts_on=sees)
    if jpeg_quality is not None:
        feed = replace(feed, image_format=ImageFormat.JPEG, jpeg_quality=jpeg_quality)
    setup = ImagerSetup(source, feed, rig)
    return SimulationConfig(
        home=origin,
        vehicle_count=VEHICLES,
        imagers={IMAGER_SERIAL: setup},
        airborne=Airborne.ALL,
        drift=FIELD_DRIFT,
        seed=seed,
        faults=tuple(parse_fault(text) for text in faults),
        pads=pads,
        go_home_heights_m={
            s: p.go_home_height_m for s, p in site.profiles.items() if p.go_home_height_m
        },
    )
