"""The simulated fleet: its vehicles, their start positions and settings."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from enum import Enum
from random import Random

from recon.geo import enu_from_point, point_from_enu
from recon.model.geo import GeoPoint, LocalFrame
from recon.model.vehicle import AltitudeReference
from recon.sim.app.app import AppSettings, SimulatedApp
from recon.sim.app.camera_feed import CameraFeed, FeedSettings
from recon.sim.app.commands import AppBehaviour, HoverOnGround
from recon.sim.app.faults import InjectedFault, RandomFault, draw_faults
from recon.sim.app.telemetry import TelemetrySensorSettings
from recon.sim.camera.frames import FrameSource
from recon.sim.camera.rig import CameraRig
from recon.sim.errors import FaultError
from recon.sim.flight.air import Air
from recon.sim.flight.aircraft import Aircraft, AircraftSettings
from recon.sim.flight.battery import Battery
from recon.sim.flight.estimate import DriftSettings, EstimateErrors
from recon.sim.flight.flight_modes import ActiveMode, BackAndForth, Grounded, PositionHold, TakeOff
from recon.sim.flight.kinematics import AircraftMotion
from recon.sim.world import Wind, WindSettings

IMAGER_SERIAL = "SIM-IMAGER"
IMAGER_HEIGHT_M = 130.0
PADS_TO_A_ROW, PAD_SPACING_M = 8, 25.0
LARGEST_BIAS_M = 40.0
"""Error of DJI's absolute altitude: tens of metres."""


class Airborne(Enum):
    """Which vehicles are in the air at the start."""

    NONE = "none"
    IMAGER = "imager"
    ALL = "all"


@dataclass(frozen=True, slots=True)
class ImagerSetup:
    """An imaging drone's frames; with a rig it starts where the rig's marked frame was taken."""

    source: FrameSource
    feed: FeedSettings = field(default_factory=FeedSettings)
    rig: CameraRig | None = None
    hover_m: float | None = None
    """With it, it starts this high above the origin of the rig's frame, from a pad of its own."""


@dataclass(frozen=True, slots=True, kw_only=True)
class SimulationConfig:
    """A fleet, and the station it reports to."""

    home: GeoPoint
    station_host: str = "127.0.0.1"
    station_port: int = 3001
    vehicle_count: int = 4
    imagers: Mapping[str, ImagerSetup] = field(default_factory=dict)
    """The imaging drones by serial."""
    altitude_reference: AltitudeReference = AltitudeReference.TAKEOFF
    hover_on_ground: HoverOnGround = HoverOnGround.NOTHING
    takes_missions: bool = True
    """False: the survey drones do not, and take off with a hover."""
    airborne: Airborne = Airborne.IMAGER
    wanders: bool = False
    """Survey vehicles fly back and forth automatically until commanded otherwise."""
    altitude_bias_m: float | None = None
    """None draws one per vehicle, up to plus or minus 40 m."""
    endurance_s: float = 1500.0
    endurances_s: Mapping[str, float] = field(default_factory=dict)
    """Endurance by serial, where it differs from `endurance_s`."""
    battery_swap_s: float | None = None
    """Time from landing to a full battery; None: batteries are not changed."""
    battery_kept_share: float = 1.0
    """A battery that is this full at landing stays in."""
    sensors: TelemetrySensorSettings = field(default_factory=TelemetrySensorSettings)
    drift: DriftSettings = field(default_factory=DriftSettings)
    wind: WindSettings | None = None
    """None: calm."""
    reports_mission_id: bool = True
    """False: the apps always report MissionID 0."""
    photo_interval_s: float | None = None
    """The interval of the cameras' timers, in apps that report facts and photos; None: plain apps,
    which report neither."""
    seed: int = 0
    faults: tuple[InjectedFault, ...] = ()
    chances: tuple[RandomFault, ...] = ()
    """Faults at random times, drawn from the seed for each vehicle."""
    pads: Mapping[str, GeoPoint] = field(default_factory=dict)
    """Start positions by serial; the others start in rows beside home."""
    go_home_heights_m: Mapping[str, float] = field(default_factory=dict)
    """Go-home heights by serial; the others are set 8 m apart."""


def fleet_serials(config: SimulationConfig) -> tuple[str, ...]:
    """Return the serials: the imaging drones first, then SIM-1, SIM-2, ..."""
    survey_count = config.vehicle_count - len(config.imagers)
    return tuple(config.imagers) + tuple(f"SIM-{number}" for number in range(1, survey_count + 1))


def build_fleet(
    config: SimulationConfig, start_ns: int, *, renders_inline: bool = True
) -> list[SimulatedApp]:
    """Return the apps, ready to be connected; raises `FaultError` for a fault without a vehicle."""
    serials = fleet_serials(config)
    asked: list[InjectedFault | RandomFault] = [*config.faults, *config.chances]
    for fault in asked:
        if not any(fault.is_for(serial, n) for n, serial in enumerate(serials, 1)):
            raise FaultError(
                f"{fault.source}fault {fault.kind.value}: expected a vehicle of "
                f"{', '.join(serials)} or its number, got {fault.vehicle!r}"
            )
    return [
        _build_app(config, serial, number, start_ns, renders_inline)
        for number, serial in enumerate(serials, 1)
    ]


def _build_app(
    config: SimulationConfig, serial: str, number: int, start_ns: int, renders_inline: bool
) -> SimulatedApp:
    random = Random(f"{config.seed}/{serial}/setup")
    # Drawn even when configured, so that later draws do not depend on the configuration.
    drawn_bias_m = random.uniform(-LARGEST_BIAS_M, LARGEST_BIAS_M)
    endurance_s = config.endurances_s.get(serial, config.endurance_s)
    battery = Battery(random.uniform(0.9, 1.0), endurance_s)
    home = _home_of(config, serial, number)
    takes_missions = config.takes_missions or serial in config.imagers
    app = AppSettings(
        serial=serial,
        home=home,
        seed=config.seed,
        behaviour=AppBehaviour(
            config.altitude_reference,
            config.hover_on_ground if takes_missions else HoverOnGround.TAKEOFF,
            drawn_bias_m if config.altitude_bias_m is None else config.altitude_bias_m,
            config.reports_mission_id,
            photo_interval_s=config.photo_interval_s,
            takes_missions=takes_missions,
        ),
        sensors=config.sensors,
        faults=(
            *(f for f in config.faults if f.is_for(serial, number)),
            *draw_faults(config.chances, config.seed, serial, number),
        ),
        renders_inline=renders_inline,
    )
    imager = config.imagers.get(serial)
    settings = AircraftSettings(
        go_home_height_m=config.go_home_heights_m.get(serial, _go_home_height_m(number)),
        endurance_s=endurance_s,
        battery_swap_s=config.battery_swap_s,
        battery_kept_share=config.battery_kept_share,
    )
    motion = _imager_start(config, imager, home) if imager else _survey_start(config, number)
    active_mode: ActiveMode = Grounded() if motion.height_m == 0.0 else PositionHold()
    east_m, north_m = (float(v) for v in enu_from_point(LocalFrame(config.home), home)[:2])
    if config.wanders and imager is None:
        active_mode = _wandering(settings, motion, number, random, (north_m, east_m))
    wind = None if config.wind is None else Wind(config.wind)
    air = Air(wind, north_m, east_m, start_ns)
    errors = EstimateErrors(random=Random(f"{config.seed}/{serial}/drift"), settings=config.drift)
    aircraft = Aircraft(
        start_ns, settings, motion, active_mode, battery=battery, air=air, errors=errors
    )
    if imager is None:
        return SimulatedApp(app, aircraft)
    # A generator of its own: adding a camera must not change the aircraft.
    feed_random = Random(f"{config.seed}/{serial}/feed")
    feed = CameraFeed(imager.source, imager.feed, feed_random, start_ns)
    return SimulatedApp(app, aircraft, feed, imager.rig)


def _home_of(config: SimulationConfig, serial: str, number: int) -> GeoPoint:
    """Return the takeoff point: an imaging drone's below its marked position, others on pads."""
    imager = config.imagers.get(serial)
    rig = None if imager is None else imager.rig
    has_pad = imager is not None and imager.hover_m is not None and serial in config.pads
    if rig is not None and not has_pad:
        ground_m = rig.frame.origin.ellipsoid_height_m
        beneath = GeoPoint(rig.marked.latitude_deg, rig.marked.longitude_deg, ground_m)
        up_m = float(enu_from_point(rig.frame, beneath)[2])
        return GeoPoint(beneath.latitude_deg, beneath.longitude_deg, ground_m - up_m)
    if serial in config.pads:
        return config.pads[serial]
    row, place = divmod(number - 1, PADS_TO_A_ROW)
    away_m = (PAD_SPACING_M * (place - 4), -PAD_SPACING_M * (row + 2.5), 0.0)
    return point_from_enu(LocalFrame(config.home), away_m)


def _go_home_height_m(number: int) -> float:
    """Return a go-home height: 8 m apart, repeating from 40 m before 120 m is reached."""
    return 40.0 + 8.0 * ((number - 1) % 10)


def _imager_start(config: SimulationConfig, imager: ImagerSetup, home: GeoPoint) -> AircraftMotion:
    rig = imager.rig
    yaw_deg = 0.0 if rig is None else rig.marked.yaw_deg
    if config.airborne is Airborne.NONE:
        return AircraftMotion(yaw_deg=yaw_deg)
    if rig is not None and imager.hover_m is not None:
        east_m, north_m = enu_from_point(LocalFrame(home), rig.frame.origin)[:2].tolist()
        return AircraftMotion(north_m, east_m, imager.hover_m, yaw_deg=yaw_deg)
    height_m = IMAGER_HEIGHT_M if rig is None else rig.marked.height_above_takeoff_m
    return AircraftMotion(height_m=height_m, yaw_deg=yaw_deg)


def _survey_start(config: SimulationConfig, number: int) -> AircraftMotion:
    if config.airborne is not Airborne.ALL:
        return AircraftMotion()
    return AircraftMotion(height_m=_survey_height_m(number))


def _survey_height_m(number: int) -> float:
    # Ten metres apart, because nothing separates vehicles that wander; but always below the
    # permitted ceiling, so that from the ninth vehicle on heights repeat.
    return 40.0 + 10.0 * ((number - 1) % 8)


def _wandering(
    settings: AircraftSettings,
    motion: AircraftMotion,
    number: int,
    random: Random,
    home_m: tuple[float, float],
) -> ActiveMode:
    """Return a back-and-forth pattern over a random rectangle.

    The rectangle lies inside the demonstration site's boundary and beside its farmyard. `home_m`
    is the vehicle's home, metres north and east of the fleet's home.
    """
    north_m = random.uniform(-180.0, 40.0) - home_m[0]
    east_m = random.uniform(-200.0, -40.0) - home_m[1]
    length_m, spacing_m, rows = random.uniform(100.0, 160.0), 25.0, 6
    corners = []
    for row in range(rows):
        ends = [(north_m + row * spacing_m, east_m), (north_m + row * spacing_m, east_m + length_m)]
        corners += ends if row % 2 == 0 else ends[::-1]
    wander = BackAndForth(tuple(corners), _survey_height_m(number), 6.0, settings.limits)
    return wander if motion.height_m > 0.0 else TakeOff(settings.limits, wander)
